// `umbra recommend`: the cheapest setting whose errors stay within limits, with its evidence and its margin.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/workload.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/bench/sweep/recommend/recommendation_record.h"
#include "umbra/bench/sweep/scene_lab.h"

namespace umbra {

/// A metric's upper bound (bench/sweep/bounds.h) must not exceed `most`.
struct Limit {
    const Metric* metric = nullptr;
    double most          = 0;
};
/// "METRIC=E", E at least 0. Throws UsageError.
[[nodiscard]] Limit parse_limit(const std::string& text);

struct RecommendOptions {
    std::vector<Limit> limits;  ///< at least one
    Workload workload;
    std::vector<MethodChoice> choices;  ///< candidates; those that leave points undefined are not taken
    int views      = 5;                 ///< that the choice is made on, from view 0
    int held_out   = 10;                ///< further views that a setting is tried on before it is the answer
    double seconds = 15;                ///< of the search, after which no setting is begun; four times as many where
                                        ///< nothing but the reference is within the limits
    TurnOptions turns{.rounds = 15, .budget_ms = 3000};
    double most_noise = kMostNoise;  ///< above this noise bar times are taken again, and then no choice is made by them
    std::optional<MethodChoice> first{};  ///< looked at before all others: where it is within the limits, none that
                                          ///< costs far more is looked at, and none after `seconds`
    std::string kept_in{};                ///< the folder of cells and times, to be named; empty: it is not
    std::function<void(const std::string&)> progress{};
};

/// Settings of one method that differ in one number alone, as the parameter's sweep has them: from the cheapest on, each
/// of which has lower errors than the one before. Other settings are families of one.
using Family = std::vector<MethodChoice>;
[[nodiscard]] std::vector<Family> families(std::span<const MethodChoice> choices);

/// One setting that was looked at. Its errors are in the order of the limits, without a bound where it is not whole;
/// its cost is by the medians of the phases, or of one run where there are no rounds.
struct Candidate : CandidateRecord {
    MethodChoice choice;
    std::vector<Cell> cells{};      ///< of its views, from view 0 on; behind one that is beyond a limit none was needed
    bool is_whole = false;          ///< its views are all that are chosen on
    std::string unfit{};            ///< why it is no candidate at all; empty where it is one
    std::vector<double> costs{};    ///< ms a frame, one a round; empty where it took part in none
    std::optional<double> price{};  ///< ms a frame by one run, alone
    [[nodiscard]] bool within() const;
    /// [limit]
    [[nodiscard]] const std::optional<double>& bound(std::size_t limit) const { return errors[limit].second.bound; }
    /// A bound, or what it is no less than by the views that are there; nothing where neither is known.
    [[nodiscard]] std::optional<double> least_bound(std::size_t limit) const;
    /// The largest of these over its limit; infinite where one is not known.
    [[nodiscard]] double worst_ratio() const;
};

/// Whether further views would compare it with itself.
[[nodiscard]] bool is_the_reference(const MethodChoice& choice, std::span<const Cell> views);

/// How much dearer: settings are tied where they took turns in the same six rounds or more and the paired ratio of
/// their costs does not differ from 1 by more than noise. Where there is no such ratio, one of over five times differs,
/// and a smaller one says nothing.
struct Rival {
    std::size_t candidate;
    CostRatioRecord ratio;
    [[nodiscard]] bool tied() const { return !ratio.differs && ratio.low.has_value(); }
};

/// A setting within the limits in the views that were chosen on, and not in all others that it was tried on.
struct Dropped {
    std::size_t candidate;
    BeyondRecord beyond;
};

/// A setting that was not looked at: it costs far more, as prices tell, than a candidate within the limits, and so is not
/// the answer whatever its errors.
struct PassedOver {
    MethodChoice choice;
    std::size_t candidate;  ///< the cheaper one
    double ratio;           ///< of the costs, or of those of a setting of its family that costs less, at least
};

/// A method and what was found of its settings.
struct TriedMethod : TriedMethodRecord {
    /// The cheapest within the limits, else the one that misses by the smallest factor, else one that is unfit.
    std::optional<std::size_t> candidate{};
    /// Index into passed_over, where none was looked at: the cheapest of them.
    std::optional<std::size_t> outdone_by{};
};

/// A step of the staircase: down to the bound `error` of the first limit's metric, this one is the cheapest of those that
/// were looked at; of those
/// that the noise bar does not tell apart, the one with the smallest bound.
struct Step {
    std::size_t candidate;
    double error;
};

struct Recommendation {
    std::vector<Candidate> candidates;    ///< settings whose cells were needed
    std::optional<std::size_t> chosen;    ///< none: no setting is within the limits, or `undecided` has some
    std::vector<Dropped> dropped;         ///< tried before the chosen one on further views, by ascending cost
    std::vector<std::size_t> undecided;   ///< within the limits and, at a noise bar above the most, none cheaper than
                                          ///< another; by ascending cost
    std::optional<std::size_t> nearest;   ///< where none is: the one that misses by the smallest factor
    std::vector<Rival> tied;              ///< as cheap as the chosen one, by rounds in turns
    std::vector<Rival> untold;            ///< within the limits, and too few rounds in turns to tell
    std::optional<Rival> runner_up;       ///< the cheapest of the others within the limits
    std::optional<Rival> cheapest;        ///< of all that were timed, whatever their errors
    std::optional<Rival> exact;           ///< the reference method, where it was timed
    std::vector<Step> staircase;          ///< by descending error
    std::vector<PassedOver> passed_over;  ///< in the order in which they were met
    std::vector<MethodChoice> unasked;    ///< those that the time did not suffice for
    std::vector<Cell> held_out;           ///< cells of the chosen one in views that it was not chosen on; all within.
                                          ///< None of the reference, which they would compare with itself
    SizeRecord size{};                    ///< of the pictures that it was chosen on
    double noise_bar = 0;                 ///< as of Turns
};

/// `small` is the scene of `whole` in pictures of as many points as the limits need (first_size), or `whole` itself.
/// Settings are looked at in its pictures; times are of whole ones.
[[nodiscard]] Recommendation recommend(SceneLab& small, SceneLab& whole, const RecommendOptions& options);

/// What a frame costs by one run on a picture, for one of so many times its points: passes over points count as often.
[[nodiscard]] double price_ms(const Workload& workload, const RunTimes& run, double more_points = 1);

/// Points of the whole picture for one of a small one.
[[nodiscard]] double more_points(const SceneLab& small, const SceneLab& whole);

/// A setting that earlier questions have looked at, and what it costs by one run in small pictures; 0 where it does not
/// serve.
struct KeptSetting {
    MethodChoice choice;
    double cost;
};
/// From the cheapest on.
[[nodiscard]] std::vector<KeptSetting> kept_settings(SceneLab& small, const SceneLab& whole,
                                                     std::span<const Family> families, const Workload& workload);

/// Every method of the candidates, in the order in which the options name them.
[[nodiscard]] std::vector<TriedMethod> tried_methods(const Recommendation& r, const RecommendOptions& options);

[[nodiscard]] RecommendationRecord recommendation_record(const Recommendation& r, const RecommendOptions& options);
[[nodiscard]] std::string recommendation_text(const Recommendation& r, const RecommendOptions& options);  ///< in words

}  // namespace umbra
