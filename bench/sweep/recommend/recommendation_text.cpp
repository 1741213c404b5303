// A recommendation in words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/recommend/recommend.h"

namespace umbra {
namespace {

std::string counted_views(std::integral auto n) { return counted(static_cast<double>(n), "view"); }

/// "1 view that was chosen on", "5 views that were chosen on", and what follows.
std::string chosen_on(std::size_t views, std::string_view one, std::string_view more) {
    return fmt::format("{} that {} chosen on{}", counted_views(views), views == 1 ? "was" : "were",
                       views == 1 ? one : more);
}

std::string with_unit(double value, std::string_view unit) {
    return unit.empty() || unit == "share of points" ? fmt::format("{:.3g}", value)
                                                     : fmt::format("{:.3g} {}", value, unit);
}

/// " from 2 views that were chosen on, their largest 0.02"; nothing where the metric of some view is unknown.
std::string largest_in_words(const Metric& metric, const LimitedRecord& error, const Candidate& c) {
    if (!error.largest) return {};
    const bool or_more = std::ranges::any_of(c.cells, [&](const Cell& cell) { return is_at_least(metric, cell); });
    return fmt::format(" from {} {}{}", chosen_on(c.views, ", its largest", ", their largest"),
                       or_more ? "at least " : "", with_unit(*error.largest, metric.unit));
}

std::string open_in_words(const Candidate& c) {
    return c.undefined > 0
               ? fmt::format("    errors are of the points that it answers: all but {:.3g} %\n", 100 * c.undefined)
               : "";
}

std::string errors_in_words(const Candidate& c) {
    std::string text;
    for (const auto& [name, error] : c.errors) {
        const Metric& metric = find_metric(name);
        text += fmt::format("    {}: {}{}; limit {}\n", name,
                            error.bound ? "bound " + with_unit(*error.bound, metric.unit) : "no bound is known",
                            largest_in_words(metric, error, c), with_unit(error.limit, metric.unit));
    }
    return text + open_in_words(c);
}

std::string rival_in_words(const Rival& rival, const Recommendation& r) {
    const Candidate& c           = r.candidates[rival.candidate];
    const CostRatioRecord& ratio = rival.ratio;
    const std::string how        = ratio.low ? fmt::format(", {:.2f} to {:.2f} with {:.1f} %, in {} rounds", *ratio.low,
                                                           *ratio.high, 100 * ratio.coverage, ratio.rounds)
                                   : ratio.rounds > 1 ? fmt::format(" in {} rounds", ratio.rounds)
                                                      : " by one run";
    return fmt::format("{} ({:.3f} ms, {:.2f} times{})", c.method, *c.cost, ratio.median, how);
}

/// "rmse up to 0.05 in view 3".
std::string beyond_in_words(const BeyondRecord& beyond) {
    const std::string_view unit = find_metric(beyond.metric).unit;
    return fmt::format("{} {} in view {}", beyond.metric,
                       beyond.error ? "up to " + with_unit(*beyond.error, unit) : "unknown", beyond.view);
}

/// The bounds of a candidate in one line: "rmse at most 0.012, flip at most 0.02: 1.2 times a limit".
std::string bounds_in_words(const Candidate& c) {
    if (c.beyond && !c.is_whole) return beyond_in_words(*c.beyond) + ": beyond the limit";
    std::string text;
    for (const auto& [name, error] : c.errors)
        text +=
            fmt::format("{}{} {}", text.empty() ? "" : ", ", name,
                        error.bound ? "at most " + with_unit(*error.bound, find_metric(name).unit) : "without a bound");
    const double factor = c.worst_ratio();
    if (factor > 1 && std::isfinite(factor)) text += fmt::format(": {:.3g} times a limit", factor);
    return text;
}

/// What the answer says of views that it was not chosen on: from those alone.
std::string held_out_in_words(const Recommendation& r, const RecommendOptions& options) {
    const std::size_t views = r.held_out.size();
    const Candidate& c      = r.candidates[*r.chosen];
    if (views == 0)
        return errors_in_words(c) +
               (is_the_reference(c.choice, c.cells)
                    ? "  It is the reference: further views would compare it with itself.\n"
                    : "  It was tried on no view that it was not chosen on: how many are beyond a limit is not known.\n");
    std::string text;
    for (const Limit& limit : options.limits) {
        double most = 0;
        for (const Cell& cell : r.held_out) most = std::max(most, possible_error(*limit.metric, cell).value_or(0));
        text += fmt::format("    {}: at most {} in {} that it was not chosen on; limit {}\n", limit.metric->name,
                            with_unit(most, limit.metric->unit), counted_views(views),
                            with_unit(limit.most, limit.metric->unit));
    }
    text += open_in_words(c);
    const std::size_t tried = r.dropped.size() + 1;
    return text +
           fmt::format("  {} beyond a limit: with {:.0f} % confidence at most {:.1f} % of such views are{}.\n",
                       views == 1 ? "This view is not" : fmt::format("None of these {} views is", views),
                       100 * kConfidence, std::ceil(1000 * share_beyond(static_cast<int>(views), tried)) / 10,
                       tried > 1 ? fmt::format(", as it is number {} of the settings tried on them", tried) : "");
}

std::string dropped_in_words(const Recommendation& r, const RecommendOptions& options) {
    std::string text;
    for (const Dropped& d : r.dropped) {
        const Candidate& c = r.candidates[d.candidate];
        text += fmt::format("  Dropped: {} ({:.3f} ms), within the limits in the {}: {}\n", c.method, *c.cost,
                            options.views == 1 ? "view that was chosen on" : "views that were chosen on",
                            beyond_in_words(d.beyond));
    }
    return text;
}

std::string methods_in_words(const Recommendation& r, const RecommendOptions& options) {
    std::vector<std::pair<std::string, std::string>> lines;
    std::size_t widest = 0;
    for (const TriedMethod& m : tried_methods(r, options)) {
        std::string name = m.method, what = "no setting was needed";
        if (m.candidate) {
            const Candidate& c = r.candidates[*m.candidate];
            const bool dropped = std::ranges::find(r.dropped, *m.candidate, &Dropped::candidate) != r.dropped.end();
            name               = c.method;
            if (!c.unfit.empty())
                what = "left out: " + c.unfit;
            else if (!c.cost)
                what = "could not be timed";
            else
                what = fmt::format("{:>9.3f} ms  {}{}", *c.cost, bounds_in_words(c), dropped ? ", dropped" : "");
        } else if (m.outdone_by) {
            const PassedOver& p = r.passed_over[*m.outdone_by];
            name                = p.choice.text();
            what = fmt::format("not looked at: one run costs {:.2g} times as much as one of {}, or more", p.ratio,
                               r.candidates[p.candidate].method);
        } else if (std::ranges::any_of(r.unasked, [&](const MethodChoice& c) { return c.info->name == m.method; })) {
            what = "not looked at in time";
        }
        widest = std::max(widest, name.size());
        lines.emplace_back(std::move(name), std::move(what));
    }
    std::string text = fmt::format(
        "  Every method, by its cheapest setting within the limits, or else its nearest, with bounds from {}:\n",
        counted_views(options.views));
    for (const auto& [name, what] : lines) text += fmt::format("    {:<{}}  {}\n", name, widest, what);
    return text;
}

std::string noise_in_words(const Recommendation& r, const RecommendOptions& options) {
    if (!std::isfinite(r.noise_bar))
        return "  Costs are of fewer than six rounds: less than five times is no difference.\n";
    return fmt::format("  Costs that differ by less than {:.0f} % are not told apart on this machine now{}.\n",
                       std::ceil(100 * r.noise_bar),
                       r.noise_bar > options.most_noise ? ", which other programs keep busy" : "");
}

std::string staircase_in_words(const Recommendation& r, const RecommendOptions& options) {
    if (r.staircase.empty()) return {};
    std::string text = fmt::format("  If {} may be at most E, the cheapest that was looked at, by bounds from {}:\n",
                                   options.limits.front().metric->name, counted_views(options.views));
    for (std::size_t k = 0; k < r.staircase.size(); ++k) {
        const Step& step        = r.staircase[k];
        const std::string range = k == 0 ? fmt::format("E from {:.3g}", step.error)
                                         : fmt::format("E from {:.3g} to {:.3g}", step.error, r.staircase[k - 1].error);
        text += fmt::format("    {:<28} {:>9.3f} ms  {}\n", range, *r.candidates[step.candidate].cost,
                            r.candidates[step.candidate].method);
    }
    return text;
}

}  // namespace

std::string recommendation_text(const Recommendation& r, const RecommendOptions& options) {
    std::string text;
    if (!r.undecided.empty()) {
        text = fmt::format(
            "Nothing is chosen: times vary by {:.0f} %, and these are within the limits in {} and as cheap as "
            "one another, as far as can be told:\n",
            std::ceil(100 * r.noise_bar), counted_views(options.views));
        for (const std::size_t k : r.undecided)
            text += fmt::format("  {}: {:.3f} ms a frame with {}\n{}", r.candidates[k].method, *r.candidates[k].cost,
                                to_text(options.workload), errors_in_words(r.candidates[k]));
    } else if (!r.chosen) {
        text = "No setting stays within the limits.\n" + dropped_in_words(r, options);
        if (r.nearest) {
            const Candidate& nearest = r.candidates[*r.nearest];
            const double factor      = nearest.worst_ratio();
            text += fmt::format(
                "  Nearest: {}{}\n{}", nearest.method,
                std::isfinite(factor) ? fmt::format(", whose largest bound is {:.3g} times its limit", factor) : "",
                errors_in_words(nearest));
        }
    } else {
        const Candidate& c = r.candidates[*r.chosen];
        text = fmt::format("{}: {:.3f} ms a frame with {}\n{}", c.method, *c.cost, to_text(options.workload),
                           held_out_in_words(r, options));
        text += dropped_in_words(r, options);
        for (const Rival& rival : r.tied)
            text += fmt::format("  As cheap, within the noise: {}\n", rival_in_words(rival, r));
        for (const Rival& rival : r.untold)
            text += fmt::format("  {}: {}\n",
                                rival.ratio.rounds > 1 ? "Timed in fewer than six turns with it" : "Not timed in turns",
                                rival_in_words(rival, r));
        if (r.runner_up) text += fmt::format("  Next: {}\n", rival_in_words(*r.runner_up, r));
        if (r.cheapest && r.cheapest->candidate != *r.chosen && r.cheapest->ratio.differs)
            text += fmt::format("  Cheapest of all, whatever its errors: {}\n", rival_in_words(*r.cheapest, r));
        if (r.exact && r.exact->candidate != *r.chosen)
            text += fmt::format("  The exact reference: {}\n", rival_in_words(*r.exact, r));
    }
    const std::size_t looked_at = r.candidates.size();
    text += staircase_in_words(r, options);
    text += methods_in_words(r, options) + noise_in_words(r, options);
    text += fmt::format(
        "  {} of {} {} looked at, in up to {} of {} x {} pixels each{}.\n", looked_at,
        counted(static_cast<double>(options.choices.size()), "setting"), looked_at == 1 ? "was" : "were",
        counted_views(options.views), *r.size.width, *r.size.height,
        looked_at + r.unasked.size() < options.choices.size() ? "; others cost more than one within the limits" : "");
    if (!r.unasked.empty())
        text += fmt::format("  {} {} not looked at in time; with --seconds 1000 they are.\n",
                            counted(static_cast<double>(r.unasked.size()), "setting"),
                            r.unasked.size() == 1 ? "was" : "were");
    if (!options.kept_in.empty())
        text += fmt::format("  Errors and times are kept in {}; --fresh measures times anew.\n", options.kept_in);
    return text;
}

}  // namespace umbra
