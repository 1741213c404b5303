#include "umbra/bench/recommend/recommendation_record.h"

#include <algorithm>

#include "umbra/bench/sweep/bounds.h"

namespace umbra {
namespace {

BeyondRecord beyond_record(const Beyond& beyond) {
    return {.view = beyond.view, .metric = std::string(beyond.metric->name), .error = beyond.error};
}

CandidateRecord candidate_record(const Candidate& c, const RecommendOptions& options) {
    CandidateRecord record{
        .method = c.choice.text(), .cost = c.cost, .views = c.views.size(), .undefined = most_undefined(c.views)};
    for (std::size_t k = 0; k < options.limits.size(); ++k) {
        const Limit& limit                = options.limits[k];
        record.errors(limit.metric->name) = {
            .limit = limit.most, .largest = largest_value(*limit.metric, c.views), .bound = c.bounds[k]};
    }
    if (c.beyond) record.beyond = beyond_record(*c.beyond);
    return record;
}

/// In how many of the cells a metric is at most `bound`. One that is only known to be at least something is not.
std::uint64_t held(const Metric& metric, const std::vector<Cell>& cells, double bound) {
    return static_cast<std::uint64_t>(std::ranges::count_if(cells, [&](const Cell& cell) {
        const auto value = metric_value(metric, cell);
        return value && *value <= bound && !is_at_least(metric, cell);
    }));
}

ChosenRecord chosen_record(const Recommendation& r, const RecommendOptions& options) {
    const Candidate& chosen = r.candidates[*r.chosen];
    ChosenRecord record{.candidate = candidate_record(chosen, options)};
    HeldOutRecord& held_out = record.held_out;
    held_out.views          = r.held_out.size();
    held_out.tried          = r.dropped.size() + 1;
    held_out.confidence     = kConfidence;
    held_out.share_beyond   = share_beyond(static_cast<int>(r.held_out.size()), r.dropped.size() + 1);
    for (std::size_t k = 0; k < options.limits.size(); ++k) {
        const Metric& metric          = *options.limits[k].metric;
        held_out.holds(metric.name)   = held(metric, r.held_out, *chosen.bounds[k]);
        held_out.largest(metric.name) = largest_value(metric, r.held_out);
    }
    return record;
}

TriedMethodRecord method_record(const TriedMethod& m, const Recommendation& r, const RecommendOptions& options) {
    TriedMethodRecord record{.method      = std::string(m.info->name),
                             .settings    = m.settings,
                             .looked_at   = m.looked_at,
                             .passed_over = m.passed_over,
                             .within      = m.within};
    if (!m.candidate) return record;
    const Candidate& c = r.candidates[*m.candidate];
    record.best        = candidate_record(c, options);
    if (c.unfit.empty())
        record.factor = known(c.worst_ratio(options.limits));
    else
        record.unfit = c.unfit;
    return record;
}

RivalRecord rival_record(const Rival& rival, const Recommendation& r, const RecommendOptions& options) {
    const Ratio& ratio = rival.ratio;
    RivalRecord record{.candidate  = candidate_record(r.candidates[rival.candidate], options),
                       .cost_ratio = {.median   = ratio.median,
                                      .rounds   = static_cast<std::uint64_t>(ratio.pairs),
                                      .coverage = ratio.coverage,
                                      .differs  = rival.differs}};
    if (ratio.has_interval()) {
        record.cost_ratio.low  = known(ratio.interval.low);
        record.cost_ratio.high = known(ratio.interval.high);
    }
    return record;
}

}  // namespace

RecommendationRecord recommendation_record(const Recommendation& r, const RecommendOptions& options) {
    const auto candidate = [&](std::size_t k) { return candidate_record(r.candidates[k], options); };
    const auto rival     = [&](const std::optional<Rival>& one) {
        return one ? std::optional(rival_record(*one, r, options)) : std::nullopt;
    };
    RecommendationRecord record;
    if (r.chosen) record.recommendation = chosen_record(r, options);
    for (const Rival& one : r.tied) record.tied.push_back(rival_record(one, r, options));
    for (const Rival& one : r.untold) record.not_compared.push_back(rival_record(one, r, options));
    record.runner_up = rival(r.runner_up);
    record.cheapest  = rival(r.cheapest);
    record.exact     = rival(r.exact);
    if (r.nearest)
        record.nearest = {.candidate = candidate(*r.nearest),
                          .factor    = r.candidates[*r.nearest].worst_ratio(options.limits)};
    for (const std::size_t k : r.undecided) record.undecided.push_back(candidate(k));
    for (const TriedMethod& m : tried_methods(r, options)) record.methods.push_back(method_record(m, r, options));
    for (const Dropped& d : r.dropped) {
        record.dropped.push_back(candidate(d.candidate));
        record.dropped.back().beyond = beyond_record(d.beyond);
    }
    for (const Step& step : r.staircase)
        record.staircase.push_back({.error  = step.error,
                                    .method = r.candidates[step.candidate].choice.text(),
                                    .cost   = r.candidates[step.candidate].cost});
    for (const Candidate& c : r.candidates) {
        if (!c.unfit.empty())
            record.unfit.push_back({.method = c.choice.text(), .why = c.unfit});
        else
            record.candidates.push_back(candidate_record(c, options));
    }
    for (const PassedOver& p : r.passed_over)
        record.passed_over.push_back(
            {.method = p.choice.text(), .cheaper = r.candidates[p.candidate].choice.text(), .cost_ratio = p.ratio});
    for (const MethodChoice& choice : r.unasked) record.unasked.push_back(choice.text());
    record.workload  = to_text(options.workload);
    record.views     = options.views;
    record.size      = size_record(r.size);
    record.settings  = {.looked_at = r.candidates.size(), .of = options.choices.size()};
    record.noise_bar = r.noise_bar;
    if (!options.kept_in.empty()) record.kept_in = options.kept_in;
    return record;
}

FirstAnswerRecord first_answer_record(const FirstAnswer& a, const RecommendOptions& options) {
    FirstAnswerRecord record{
        .method = a.choice.text(), .cost = a.cost, .size = size_record(a.size), .views = a.views, .in_time = a.in_time};
    for (std::size_t k = 0; k < options.limits.size(); ++k) record.bounds(options.limits[k].metric->name) = a.bounds[k];
    return record;
}

}  // namespace umbra
