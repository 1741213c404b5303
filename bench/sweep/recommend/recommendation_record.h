// What `umbra recommend --json` prints, as a value.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"

namespace umbra {

/// A metric of a setting, in the views that were chosen on.
struct LimitedRecord {
    double limit = 0;
    std::optional<double> largest{}, bound{};
};
DESCRIBE(LimitedRecord) {
    of.name("limited", "a metric of a setting");
    of(MEMBER(limit), "what --max allows", at_least(0));
    of(MEMBER(largest), "of the views that it was looked at in; null where one was not judged");
    of(MEMBER(bound), "what a further view exceeds in one case of twenty; null where it is not known");
}

/// The first such view: its error is beyond the limit, and so is the bound, which is no less than any view's.
struct BeyondRecord {
    int view = 0;
    std::string metric{};
    std::optional<double> error{};
};
DESCRIBE(BeyondRecord) {
    of.name("beyond", "a view in which a setting is beyond a limit");
    MEMBERS(view, metric);
    of(MEMBER(error), "the largest that it may be there; null where it was not judged");
}

struct CandidateRecord {
    std::string method{};
    std::optional<double> cost{};
    std::uint64_t views = 0;
    Members<LimitedRecord> errors{};
    std::optional<BeyondRecord> beyond{};
    double undefined = 0;
};
DESCRIBE(CandidateRecord) {
    of(MEMBER(method), "the setting as typed: METHOD:k=v,...");
    of(MEMBER(cost), "ms a frame of the workload; null where it was not timed", at_least(0));
    of(MEMBER(views), "in which it was looked at");
    of(MEMBER(errors), "by the names of the limited metrics");
    of(MEMBER(beyond), "the first view that is beyond a limit");
    of(MEMBER(undefined), "the largest fraction of a view's points that it does not answer", kFraction);
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
DESCRIBE(HeldOutRecord) {
    MEMBERS(views);
    of(MEMBER(holds), "by metrics, in how many of them the error is at most the bound");
    of(MEMBER(largest), "by metrics, the largest error in them");
    of(MEMBER(beyond), "how many of them are beyond a limit: none, or it would not be the answer");
    of(MEMBER(share_beyond), "at most this fraction of such views is beyond a limit", kFraction);
    of(MEMBER(confidence), "of share_beyond", kFraction);
    of(MEMBER(tried), "settings that were tried on them, which share_beyond allows for");
}

struct ChosenRecord {
    CandidateRecord candidate{};
    HeldOutRecord held_out{};
};
DESCRIBE(ChosenRecord) {
    of.all(&R::candidate);
    MEMBERS(held_out);
}

struct CostRatioRecord {
    double median = kUnknown;
    std::optional<double> low{}, high{};
    std::uint64_t rounds = 0;
    double coverage      = 0;
    bool differs         = false;
};
DESCRIBE(CostRatioRecord) {
    of.name("cost_ratio", "the cost over that of the recommendation");
    of(MEMBER(median), "of the rounds, or of one run each");
    of(MEMBER(low), "of the interval of the median; null where rounds are too few");
    MEMBERS(high);
    of(MEMBER(rounds), "in turns; 0: one run each");
    of(MEMBER(coverage), "of the interval", kFraction);
    of(MEMBER(differs), "from 1 by more than noise, as far as can be told");
}

struct RivalRecord {
    CandidateRecord candidate{};
    CostRatioRecord cost_ratio{};
};
DESCRIBE(RivalRecord) {
    of.name("rival", "another setting within the limits, or to compare with");
    of.all(&R::candidate);
    MEMBERS(cost_ratio);
}

struct NearestRecord {
    CandidateRecord candidate{};
    double factor = kUnknown;
};
DESCRIBE(NearestRecord) {
    of.all(&R::candidate);
    of(MEMBER(factor), "the largest bound over its limit");
}

struct TriedMethodRecord {
    std::string method{};
    std::uint64_t settings = 0, looked_at = 0, passed_over = 0;
    bool within = false;
    std::optional<CandidateRecord> best{};
    std::optional<double> factor{};
    std::optional<std::string> unfit{};
};
DESCRIBE(TriedMethodRecord) {
    MEMBERS(method);
    of(MEMBER(settings), "among the candidates");
    MEMBERS(looked_at);
    of(MEMBER(passed_over), "since they cost far more than one within the limits");
    of(MEMBER(within), "whether one of them is within the limits");
    of(MEMBER(best), "the cheapest within the limits, or else the nearest");
    of(MEMBER(factor), "the largest bound of that one over its limit");
    of(MEMBER(unfit), "why none of them is a candidate");
}

struct StepRecord {
    double error = kUnknown;
    std::string method{};
    std::optional<double> cost{};
};
DESCRIBE(StepRecord) {
    of(MEMBER(error), "the first metric's bound");
    of(MEMBER(method), "the cheapest that was looked at, down to this error");
    MEMBERS(cost);
}

struct UnfitRecord {
    std::string method{}, why{};
};
DESCRIBE(UnfitRecord) { MEMBERS(method, why); }

struct PassedOverRecord {
    std::string method{}, cheaper{};
    double cost_ratio = kUnknown;
};
DESCRIBE(PassedOverRecord) {
    of(MEMBER(method), "not looked at");
    of(MEMBER(cheaper), "a setting within the limits");
    of(MEMBER(cost_ratio), "its cost, or that of a cheaper one of its family, over that of `cheaper`");
}

struct CountedSettingsRecord {
    std::uint64_t looked_at = 0, of = 0;
};
DESCRIBE(CountedSettingsRecord) { MEMBERS(looked_at, of); }

/// The answer of the first seconds.
struct FirstAnswerRecord {
    std::string method{};
    double cost = 0;
    Members<double> bounds{};
    SizeRecord size{};
    int views    = 0;
    bool in_time = true;
};
DESCRIBE(FirstAnswerRecord) {
    MEMBERS(method);
    of(MEMBER(cost), "ms a frame by one run");
    of(MEMBER(bounds), "by the names of the limited metrics");
    of(MEMBER(size), "of the pictures that it is from");
    of(MEMBER(views), "that it is from");
    of(MEMBER(in_time), "every family of settings was looked at, or passed over as dearer");
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
DESCRIBE(RecommendationRecord) {
    of(MEMBER(recommendation), "the cheapest within the limits; null where there is none, or `undecided` has some");
    of(MEMBER(tied), "as cheap, by rounds in turns");
    of(MEMBER(runner_up), "the cheapest of the others within the limits");
    of(MEMBER(cheapest), "of all that were timed, whatever their errors");
    of(MEMBER(exact), "the exact reference, where it was timed");
    of(MEMBER(nearest), "where nothing is within the limits");
    of(MEMBER(undecided), "within the limits, and times vary too much to rank them");
    of(MEMBER(staircase), "by descending error");
    of(MEMBER(methods), "every method of the candidates");
    of(MEMBER(dropped), "within the limits in the views that were chosen on, and beyond one in a further view");
    of(MEMBER(not_compared), "within the limits, and timed in too few rounds in turns to tell");
    of(MEMBER(unfit), "settings that are no candidates");
    of(MEMBER(candidates), "all that were looked at");
    MEMBERS(passed_over);
    of(MEMBER(unasked), "settings that the time did not suffice for");
    of(MEMBER(workload), "events a second");
    of(MEMBER(views), "to choose on");
    of(MEMBER(size), "of the pictures that were chosen on");
    MEMBERS(settings);
    of(MEMBER(noise_bar), "how far from 1 the ratio of a setting with itself may lie; null: rounds are too few");
    of(MEMBER(kept_in), "the folder of cells and times");
    of(MEMBER(first), "the answer that was printed while the search went on");
}

}  // namespace umbra
