#include "umbra/bench/sweep/recommend/recommendation_record.h"

#include <algorithm>
#include <iterator>

#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/recommend/recommend.h"

namespace umbra {
namespace {

/// In how many of the cells a metric is at most `bound`. One that is only known to be at least something is not.
std::uint64_t held(const Metric& metric, const std::vector<Cell>& cells, double bound) {
    return static_cast<std::uint64_t>(std::ranges::count_if(cells, [&](const Cell& cell) {
        const auto value = metric_value(metric, cell);
        return value && *value <= bound && !is_at_least(metric, cell);
    }));
}

ChosenRecord chosen_record(const Recommendation& r, const RecommendOptions& options) {
    const Candidate& chosen = r.candidates[*r.chosen];
    ChosenRecord record{.candidate = chosen};
    HeldOutRecord& held_out = record.held_out;
    held_out.views          = r.held_out.size();
    held_out.tried          = r.dropped.size() + 1;
    held_out.confidence     = kConfidence;
    held_out.share_beyond   = share_beyond(static_cast<int>(r.held_out.size()), r.dropped.size() + 1);
    for (std::size_t k = 0; k < options.limits.size(); ++k) {
        const Metric& metric          = *options.limits[k].metric;
        held_out.holds(metric.name)   = held(metric, r.held_out, *chosen.bound(k));
        held_out.largest(metric.name) = largest_value(metric, r.held_out);
    }
    return record;
}

}  // namespace

RecommendationRecord recommendation_record(const Recommendation& r, const RecommendOptions& options) {
    const auto candidate = [&](std::size_t k) -> const CandidateRecord& { return r.candidates[k]; };
    const auto rival     = [&](const Rival& one) { return RivalRecord{candidate(one.candidate), one.ratio}; };
    RecommendationRecord record;
    if (r.chosen) record.recommendation = chosen_record(r, options);
    std::ranges::transform(r.tied, std::back_inserter(record.tied), rival);
    std::ranges::transform(r.untold, std::back_inserter(record.not_compared), rival);
    if (r.runner_up) record.runner_up = rival(*r.runner_up);
    if (r.cheapest) record.cheapest = rival(*r.cheapest);
    if (r.exact) record.exact = rival(*r.exact);
    if (r.nearest)
        record.nearest = {.candidate = candidate(*r.nearest), .factor = r.candidates[*r.nearest].worst_ratio()};
    std::ranges::transform(r.undecided, std::back_inserter(record.undecided), candidate);
    for (const Step& step : r.staircase)
        record.staircase.push_back({step.error, candidate(step.candidate).method, candidate(step.candidate).cost});
    const std::vector<TriedMethod> methods = tried_methods(r, options);
    record.methods.assign(methods.begin(), methods.end());
    for (const Dropped& d : r.dropped) record.dropped.emplace_back(candidate(d.candidate)).beyond = d.beyond;
    for (const Candidate& c : r.candidates) {
        if (!c.unfit.empty())
            record.unfit.push_back({.method = c.method, .why = c.unfit});
        else
            record.candidates.push_back(c);
    }
    for (const PassedOver& p : r.passed_over)
        record.passed_over.push_back({p.choice.text(), candidate(p.candidate).method, p.ratio});
    for (const MethodChoice& choice : r.unasked) record.unasked.push_back(choice.text());
    record.workload  = to_text(options.workload);
    record.views     = options.views;
    record.size      = r.size;
    record.settings  = {.looked_at = r.candidates.size(), .of = options.choices.size()};
    record.noise_bar = r.noise_bar;
    if (!options.kept_in.empty()) record.kept_in = options.kept_in;
    return record;
}

}  // namespace umbra
