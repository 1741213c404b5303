// What `umbra recommend --json` prints, as a value.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/recommend/first_answer.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// A metric of a setting, in the views that were chosen on.
struct LimitedRecord {
    double limit = 0;
    std::optional<double> largest{}, bound{};
};
template <class Fields>
void describe(Fields& of, Is<LimitedRecord>) {
    of.name("limited", "a metric of a setting");
    of("limit", &LimitedRecord::limit, "what --max allows", at_least(0));
    of("largest", &LimitedRecord::largest, "of the views that it was looked at in; null where one was not judged");
    of("bound", &LimitedRecord::bound, "what a further view exceeds in one case of twenty; null where it is not known");
}

struct BeyondRecord {
    int view = 0;
    std::string metric{};
    std::optional<double> error{};
};
template <class Fields>
void describe(Fields& of, Is<BeyondRecord>) {
    of.name("beyond", "a view in which a setting is beyond a limit");
    of("view", &BeyondRecord::view, "");
    of("metric", &BeyondRecord::metric, "");
    of("error", &BeyondRecord::error, "the largest that it may be there; null where it was not judged");
}

struct CandidateRecord {
    std::string method{};
    std::optional<double> cost{};
    std::uint64_t views = 0;
    Members<LimitedRecord> errors{};
    std::optional<BeyondRecord> beyond{};
    double undefined = 0;
};
template <class Fields>
void describe(Fields& of, Is<CandidateRecord>) {
    of("method", &CandidateRecord::method, "the setting as typed: METHOD:k=v,...");
    of("cost", &CandidateRecord::cost, "ms a frame of the workload; null where it was not timed", at_least(0));
    of("views", &CandidateRecord::views, "in which it was looked at");
    of("errors", &CandidateRecord::errors, "by the names of the limited metrics");
    of("beyond", &CandidateRecord::beyond, "the first view that is beyond a limit");
    of("undefined", &CandidateRecord::undefined, "the largest fraction of a view's points that it does not answer",
       kFraction);
}

/// Views that the answer was not chosen on.
struct HeldOutRecord {
    std::uint64_t views = 0;
    Members<std::uint64_t> holds{};
    Members<std::optional<double>> largest{};
    std::uint64_t beyond = 0;
    double share_beyond = 1, confidence = 0;
    std::uint64_t tried = 1;
};
template <class Fields>
void describe(Fields& of, Is<HeldOutRecord>) {
    of("views", &HeldOutRecord::views, "");
    of("holds", &HeldOutRecord::holds, "by metrics, in how many of them the error is at most the bound");
    of("largest", &HeldOutRecord::largest, "by metrics, the largest error in them");
    of("beyond", &HeldOutRecord::beyond, "how many of them are beyond a limit: none, or it would not be the answer");
    of("share_beyond", &HeldOutRecord::share_beyond, "at most this fraction of such views is beyond a limit",
       kFraction);
    of("confidence", &HeldOutRecord::confidence, "of share_beyond", kFraction);
    of("tried", &HeldOutRecord::tried, "settings that were tried on them, which share_beyond allows for");
}

struct ChosenRecord {
    CandidateRecord candidate{};
    HeldOutRecord held_out{};
};
template <class Fields>
void describe(Fields& of, Is<ChosenRecord>) {
    of.all(&ChosenRecord::candidate);
    of("held_out", &ChosenRecord::held_out, "");
}

struct CostRatioRecord {
    double median = kUnknown;
    std::optional<double> low{}, high{};
    std::uint64_t rounds = 0;
    double coverage      = 0;
    bool differs         = false;
};
template <class Fields>
void describe(Fields& of, Is<CostRatioRecord>) {
    of.name("cost_ratio", "the cost over that of the recommendation");
    of("median", &CostRatioRecord::median, "of the rounds, or of one run each");
    of("low", &CostRatioRecord::low, "of the interval of the median; null where rounds are too few");
    of("high", &CostRatioRecord::high, "");
    of("rounds", &CostRatioRecord::rounds, "in turns; 0: one run each");
    of("coverage", &CostRatioRecord::coverage, "of the interval", kFraction);
    of("differs", &CostRatioRecord::differs, "from 1 by more than noise, as far as can be told");
}

struct RivalRecord {
    CandidateRecord candidate{};
    CostRatioRecord cost_ratio{};
};
template <class Fields>
void describe(Fields& of, Is<RivalRecord>) {
    of.name("rival", "another setting within the limits, or to compare with");
    of.all(&RivalRecord::candidate);
    of("cost_ratio", &RivalRecord::cost_ratio, "");
}

struct NearestRecord {
    CandidateRecord candidate{};
    double factor = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<NearestRecord>) {
    of.all(&NearestRecord::candidate);
    of("factor", &NearestRecord::factor, "the largest bound over its limit");
}

struct TriedMethodRecord {
    std::string method{};
    std::uint64_t settings = 0, looked_at = 0, passed_over = 0;
    bool within = false;
    std::optional<CandidateRecord> best{};
    std::optional<double> factor{};
    std::optional<std::string> unfit{};
};
template <class Fields>
void describe(Fields& of, Is<TriedMethodRecord>) {
    of("method", &TriedMethodRecord::method, "");
    of("settings", &TriedMethodRecord::settings, "among the candidates");
    of("looked_at", &TriedMethodRecord::looked_at, "");
    of("passed_over", &TriedMethodRecord::passed_over, "since they cost far more than one within the limits");
    of("within", &TriedMethodRecord::within, "whether one of them is within the limits");
    of("best", &TriedMethodRecord::best, "the cheapest within the limits, or else the nearest");
    of("factor", &TriedMethodRecord::factor, "the largest bound of that one over its limit");
    of("unfit", &TriedMethodRecord::unfit, "why none of them is a candidate");
}

struct StepRecord {
    double error = kUnknown;
    std::string method{};
    std::optional<double> cost{};
};
template <class Fields>
void describe(Fields& of, Is<StepRecord>) {
    of("error", &StepRecord::error, "the first metric's bound");
    of("method", &StepRecord::method, "the cheapest that was looked at, down to this error");
    of("cost", &StepRecord::cost, "");
}

struct UnfitRecord {
    std::string method{}, why{};
};
template <class Fields>
void describe(Fields& of, Is<UnfitRecord>) {
    of("method", &UnfitRecord::method, "");
    of("why", &UnfitRecord::why, "");
}

struct PassedOverRecord {
    std::string method{}, cheaper{};
    double cost_ratio = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<PassedOverRecord>) {
    of("method", &PassedOverRecord::method, "not looked at");
    of("cheaper", &PassedOverRecord::cheaper, "a setting within the limits");
    of("cost_ratio", &PassedOverRecord::cost_ratio,
       "its cost, or that of a cheaper one of its family, over that of `cheaper`");
}

struct CountedSettingsRecord {
    std::uint64_t looked_at = 0, of = 0;
};
template <class Fields>
void describe(Fields& of, Is<CountedSettingsRecord>) {
    of("looked_at", &CountedSettingsRecord::looked_at, "");
    of("of", &CountedSettingsRecord::of, "");
}

/// The answer of the first seconds.
struct FirstAnswerRecord {
    std::string method{};
    double cost = 0;
    Members<double> bounds{};
    SizeRecord size{};
    int views    = 0;
    bool in_time = true;
};
template <class Fields>
void describe(Fields& of, Is<FirstAnswerRecord>) {
    of("method", &FirstAnswerRecord::method, "");
    of("cost", &FirstAnswerRecord::cost, "ms a frame by one run");
    of("bounds", &FirstAnswerRecord::bounds, "by the names of the limited metrics");
    of("size", &FirstAnswerRecord::size, "of the pictures that it is from");
    of("views", &FirstAnswerRecord::views, "that it is from");
    of("in_time", &FirstAnswerRecord::in_time, "every family of settings was looked at, or passed over as dearer");
}

struct RecommendationRecord {
    std::optional<ChosenRecord> recommendation{};
    std::vector<RivalRecord> tied{};
    std::optional<RivalRecord> runner_up{}, cheapest{}, exact{};
    std::optional<NearestRecord> nearest{};
    std::vector<CandidateRecord> undecided{};
    std::vector<StepRecord> staircase{};
    std::vector<TriedMethodRecord> methods{};
    std::vector<CandidateRecord> dropped{};
    std::vector<RivalRecord> not_compared{};
    std::vector<UnfitRecord> unfit{};
    std::vector<CandidateRecord> candidates{};
    std::vector<PassedOverRecord> passed_over{};
    std::vector<std::string> unasked{};
    std::string workload{};
    int views = 0;
    SizeRecord size{};
    CountedSettingsRecord settings{};
    double noise_bar = kUnknown;
    std::optional<std::string> kept_in{};
    std::optional<FirstAnswerRecord> first{};
};
template <class Fields>
void describe(Fields& of, Is<RecommendationRecord>) {
    using R = RecommendationRecord;
    of("recommendation", &R::recommendation,
       "the cheapest within the limits; null where there is none, or `undecided` has some");
    of("tied", &R::tied, "as cheap, by rounds in turns");
    of("runner_up", &R::runner_up, "the cheapest of the others within the limits");
    of("cheapest", &R::cheapest, "of all that were timed, whatever their errors");
    of("exact", &R::exact, "the exact reference, where it was timed");
    of("nearest", &R::nearest, "where nothing is within the limits");
    of("undecided", &R::undecided, "within the limits, and times vary too much to rank them");
    of("staircase", &R::staircase, "by descending error");
    of("methods", &R::methods, "every method of the candidates");
    of("dropped", &R::dropped, "within the limits in the views that were chosen on, and beyond one in a further view");
    of("not_compared", &R::not_compared, "within the limits, and timed in too few rounds in turns to tell");
    of("unfit", &R::unfit, "settings that are no candidates");
    of("candidates", &R::candidates, "all that were looked at");
    of("passed_over", &R::passed_over, "");
    of("unasked", &R::unasked, "settings that the time did not suffice for");
    of("workload", &R::workload, "events a second");
    of("views", &R::views, "to choose on");
    of("size", &R::size, "of the pictures that were chosen on");
    of("settings", &R::settings, "");
    of("noise_bar", &R::noise_bar,
       "how far from 1 the ratio of a setting with itself may lie; null: rounds are too few");
    of("kept_in", &R::kept_in, "the folder of cells and times");
    of("first", &R::first, "the answer that was printed while the search went on");
}

[[nodiscard]] RecommendationRecord recommendation_record(const Recommendation& r, const RecommendOptions& options);
[[nodiscard]] FirstAnswerRecord first_answer_record(const FirstAnswer& answer, const RecommendOptions& options);
[[nodiscard]] Json recommendation_schema();  ///< JSON Schema, draft 4

}  // namespace umbra
