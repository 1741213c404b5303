// Running a method on a scene: its phases, timed apart, and the S_j planes that come out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "umbra/bench/run/at_work.h"
#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/render/points.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Throws std::logic_error, naming the method, where a plane that it wrote holds values outside [0, 1], or an answer
/// for a point that is not asked for.
void check_contract(std::string_view name, const VisibilityPlane& plane, const PointBatch& points, LightId light);

/// Wall-clock times of one phase, milliseconds. One run is a figure; fewer than three say little about spread.
struct Timing {
    double median = 0, min = 0, max = 0;
    int runs = 0;
};

/// How often a phase is repeated: until `max_runs` or `budget_ms` is spent, whichever is first, at least once.
struct Repeats {
    int max_runs     = 6;  // the fewest that a ratio has an interval of
    double budget_ms = 100;
};

inline constexpr Repeats kOnce{1, 0};

/// Of samples in any order, milliseconds. Throws std::logic_error where there is none.
[[nodiscard]] Timing timing_of(std::span<const double> samples);

/// Calls `work` repeatedly and times each call; `before`, if given, runs ahead of each, outside the clock.
[[nodiscard]] Timing time_runs(const Repeats& repeats, const std::function<void()>& work,
                               const std::function<void()>& before = {});

/// What one method made of one scene. Where it does not serve, only `choice` and `service` mean something.
struct MethodRun {
    MethodChoice choice;
    Service service{};
    Timing build{}, look{};                           ///< look: of all batches that it was asked for
    std::vector<Timing> aim{}, visibility{};          ///< [light]
    std::size_t memory_bytes = 0;                     ///< of geometry and of the last light
    std::size_t points_bytes = 0, device_bytes = 0;   ///< of the points; on a device
    std::vector<VisibilityPlane> planes{};            ///< [light]
    bool is_coloured = false;                         ///< planes have three channels
    std::vector<std::vector<std::uint8_t>> judged{};  ///< [light][point] of a reference: 0 where its value only finds
                                                      ///< edges and judges nothing; empty: every point judges
    std::shared_ptr<MethodAtWork> work{};             ///< to be asked further

    /// judged[light], or empty.
    [[nodiscard]] std::span<const std::uint8_t> judged_points(LightId light) const {
        return judged.empty() ? std::span<const std::uint8_t>{} : judged[light];
    }

    /// Share of the points that S_j is asked for (any light in front) that it is given for, [0, 1]; nothing where none
    /// is.
    [[nodiscard]] std::optional<double> coverage(const PointBatch& points) const;
};

/// Runs all phases for all lights. Throws std::logic_error if the method breaks its contract (values outside [0, 1],
/// or an answer for points that it must leave alone): a picture of such values would be worse than none. Throws what
/// the method throws, and CutShort where it takes more than the budget, which stays the limit of `work`; `at`, if given,
/// then says which light it was about, none for the phases before.
[[nodiscard]] MethodRun run_method(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                                   const PointBatch& points, const Repeats& repeats,
                                   std::optional<LightId>* at = nullptr, const Budget& budget = {});

/// The phase of the points, where it does not look at these yet: adds to `run.look`. `points` must outlive the next
/// one.
void look_at(MethodRun& run, const PointBatch& points, const Repeats& repeats);

/// The phases of one light, and of the points where it does not look at these yet: adds to `run`, whose method has been
/// built. `points` must outlive the next call. `answer_light` is that without the aim, which `run.work` has.
void answer_light(MethodRun& run, const PointBatch& points, LightId light, const Repeats& repeats);
void run_light(MethodRun& run, const PointBatch& points, LightId light, const Repeats& repeats);

/// The phases of all lights, and what the values of the run hold then.
void run_lights(MethodRun& run, const PointBatch& points, std::size_t lights, const Repeats& repeats,
                std::optional<LightId>* at = nullptr);

/// What the values of a run hold, into the run.
void note_memory(MethodRun& run);

/// A run of a setting whose phases are still to come: `work` and `service` are there. `work`: one of this setting that
/// may have built already; none: a new one.
[[nodiscard]] MethodRun begin_run(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                                  const Budget& budget = {}, std::shared_ptr<MethodAtWork> work = nullptr);

/// Builds, where `work` has not.
void run_build(MethodRun& run, const Repeats& repeats);
/// All phases of a run that has begun.
void run_phases(MethodRun& run, const PointBatch& points, std::size_t lights, const Repeats& repeats,
                std::optional<LightId>* at = nullptr);

/// Sum of the medians (and of minima and maxima) of several timings: what all lights together cost.
[[nodiscard]] Timing total(const std::vector<Timing>& timings);

}  // namespace umbra
