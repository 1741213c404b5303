// Climbing a ladder: every method on every rung, compared with the reference, and the rung at which each one breaks.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/ladders/interior_points.h"
#include "umbra/bench/ladders/ladder.h"

namespace umbra {

/// The ladder ends where the eye no longer sees at least this fraction of the points that it sees on the first rung:
/// below it, the scene itself has come apart in its float coordinates, or the eye rays have.
inline constexpr double kLeastPoints = 0.1;

/// A method that leaves undefined more than this fraction of the points that it is asked for no longer answers.
inline constexpr double kMostUndefined = 0.5;

/// What one method made of one rung, over all lights. Counts are points.
struct RungOutcome {
    Service service;
    std::string stopped;               ///< the message of the exception that ended it; empty where it ran to its end
    std::optional<std::string> light;  ///< at which it stopped; none: before any
    bool cut             = false;      ///< it took more than its budget, and does not serve
    std::uint64_t points = 0, undefined = 0;
    VisibilityError::Kind false_shadow, false_light;
    InteriorPoints can_show;  ///< of the points that the method answers
    double mae = 0;
    std::string kind;  ///< of most of the interior errors; empty where there are none

    [[nodiscard]] std::uint64_t interior() const { return false_shadow.interior + false_light.interior; }
    [[nodiscard]] double interior_share() const { return points == 0 ? 0 : double(interior()) / double(points); }
    [[nodiscard]] double coverage() const { return points == 0 ? 0 : double(points) / double(points + undefined); }
    [[nodiscard]] bool ran() const { return service && stopped.empty(); }
    [[nodiscard]] bool broken() const;
    /// Not broken, and its answers hold too few interior points of a kind to conclude anything from that.
    [[nodiscard]] bool unjudged() const { return ran() && !broken() && !can_show.enough(); }
    [[nodiscard]] bool silent() const {
        return ran() && double(undefined) > kMostUndefined * double(points + undefined);
    }
};

/// One rung: the scene's truth, and each method's outcome in the order of LadderRun::methods.
struct Rung {
    double value = 0;
    std::string unjudged;  ///< why no method is judged on it; empty where they are
    std::string failed;    ///< the message of the exception that the reference threw; empty where it did not
    std::string truth;     ///< the reference, as typed
    std::uint64_t surface_points = 0, lit = 0, umbra = 0, penumbra = 0, on_boundary = 0;
    InteriorPoints can_show;
    std::vector<RungOutcome> outcomes;  ///< none where it is not judged
};
/// Outcomes stand with their methods.
DESCRIBE(Rung) {
    of.name("rung");
    of.must(MEMBER(value));
    of(MEMBER(truth), "the reference, as typed");
    MEMBERS(surface_points, lit, umbra, penumbra, on_boundary);
    of.all(&R::can_show);
    of.may(MEMBER(unjudged), "why no method is compared on this rung");
}

struct LadderRun {
    const Ladder* ladder = nullptr;
    std::vector<MethodChoice> methods;                 ///< empty for ladders over the sum
    std::vector<Rung> rungs;                           ///< up to the first without points or truth, which is included
    std::vector<std::vector<double>> first_rung_ms{};  ///< time_first_rung; empty where nobody measured
};

/// How one method fared on one ladder. Rungs are indices into LadderRun::rungs.
struct Climb {
    std::optional<std::size_t> breaks_at;        ///< the first rung where it ran and is broken, or where it stopped
    std::optional<std::size_t> silent_from;      ///< the first from which on it leaves most points undefined
    std::optional<std::size_t> not_served_from;  ///< the first from which on it says that it does not serve
    std::optional<std::size_t> not_judged_from;  ///< the first from which on no rung is judged, for this method
    std::string why;                             ///< of not serving, of having stopped, or of not being judged
    std::size_t judged    = 0;                   ///< rungs on which something can be concluded from its answers
    double least_coverage = 1;                   ///< of these, the least share of the points that it answers
};
[[nodiscard]] Climb climb(const LadderRun& run, std::size_t method);

/// Everything about one rung that the methods share. It stays where it was made: methods point into it.
struct RungStage {
    Scene scene;
    SceneFacts facts;
    PointBatch points;
    MethodRun truth;
};
/// Facts, points and truth of a scene. Throws what the methods throw.
[[nodiscard]] std::unique_ptr<RungStage> set_stage(Scene scene);

/// A method on a stage; `explained`, if given, gets each light's errors point by point where the method ran.
[[nodiscard]] RungOutcome outcome(const RungStage& stage, const MethodChoice& method,
                                  std::vector<Explained>* explained = nullptr, MethodRun* run = nullptr,
                                  const Budget& budget = {});

/// Climbs one ladder with each of the methods. `progress` is called with each step's description; may be empty. A
/// method that took longer than `patience_s`, seconds of the calling thread's processor time, on a rung is asked on no
/// later one: it does not serve these, and says why. So does one on the rung on which it took more than the budget.
[[nodiscard]] LadderRun climb_ladder(const Ladder& ladder, const std::vector<MethodChoice>& methods,
                                     const std::function<void(const std::string&)>& progress = {},
                                     double patience_s = double(kInfinity), const Budget& budget = {});

/// Times on the first rung, of all methods in turns, so that their ratios mean something: [method][round],
/// milliseconds of build, aim and visibility over all lights, as time_in_turns measures them: samples with one index
/// are of one round. Empty for a method that does not serve the scene, that throws there, or that takes longer than the
/// budget.
[[nodiscard]] std::vector<std::vector<double>> time_first_rung(const Ladder& ladder,
                                                               const std::vector<MethodChoice>& methods,
                                                               const Budget& budget = {});

}  // namespace umbra
