#include "umbra/bench/recommend/recommend.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "umbra/bench/statistics/statistics.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/limit_text.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

std::vector<double> costs_a_round(const Json& times, const Workload& workload) {
    const auto samples = [&](const char* phase) { return times.at(phase).at("samples").get<std::vector<double>>(); };
    const auto build = samples("build_ms"), aim = samples("aim_ms"), visibility = samples("visibility_ms");
    std::vector<double> costs;
    if (times.at("order").empty()) return costs;  // its one sample is of no round
    for (std::size_t r = 0; r < build.size(); ++r)
        costs.push_back(frame_cost_ms(workload, build[r], aim[r], visibility[r]));
    return costs;
}

/// Looks at settings of one scene, each once.
class Search {
public:
    Search(SceneLab& lab, const RecommendOptions& options, Recommendation& result)
        : lab_(lab), options_(options), result_(result) {}

    std::size_t look(const MethodChoice& choice) {
        for (std::size_t k = 0; k < result_.candidates.size(); ++k)
            if (result_.candidates[k].choice.info == choice.info &&
                result_.candidates[k].choice.settings == choice.settings)
                return k;
        if (options_.progress) options_.progress(choice.text());
        Candidate c{choice, {}, {}, {}, {}, {}};
        for (int view = 0; view < options_.views; ++view) {
            c.views.push_back(lab_.cell(choice, view));
            c.unfit = why_unfit(c.views);
            if (!c.unfit.empty()) break;
        }
        for (const Limit& limit : options_.limits)
            c.bounds.push_back(c.unfit.empty() ? upper_bound(*limit.metric, c.views) : std::nullopt);
        result_.candidates.push_back(std::move(c));
        return result_.candidates.size() - 1;
    }

    /// The settings that may be the answer: of each family the first within the limits; and those that the answer is
    /// compared with: of each family the first and the last.
    void look_at_families() {
        for (const Family& family : families(options_.choices)) {
            result_.settings += family.settings.size();
            const auto good = first_good(family.settings.size(), [&](std::size_t k) {
                return result_.candidates[look(family.settings[k])].within(options_.limits);
            });
            if (good) static_cast<void>(look(family.settings[*good]));
            static_cast<void>(look(family.settings.front()));
        }
        result_.looked_at = result_.candidates.size();
    }

    void time_candidates() {
        std::vector<std::size_t> who;
        std::vector<MethodChoice> choices;
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            if (!result_.candidates[k].unfit.empty()) continue;
            who.push_back(k);
            choices.push_back(result_.candidates[k].choice);
        }
        const TimedTogether together = lab_.times(choices, options_.turns);
        if (who.empty()) return;
        const Json& bar   = together.turns.at("noise_bar");
        result_.noise_bar = bar.is_number() ? bar.get<double>() : kUnknown;
        for (std::size_t t = 0; t < who.size(); ++t) {
            const Json& times = together.settings[t];
            if (times.is_null()) continue;
            Candidate& c = result_.candidates[who[t]];
            c.costs      = costs_a_round(times, options_.workload);
            c.cost       = cost_of(times, options_.workload);
        }
    }

    /// Cost of `a` over cost of `b`; without an interval where one of them took part in no round.
    [[nodiscard]] Ratio ratio(std::size_t a, std::size_t b) const {
        const Candidate &x = result_.candidates[a], &y = result_.candidates[b];
        if (!x.costs.empty() && !y.costs.empty()) return paired_ratio(x.costs, y.costs);
        const double r = *x.cost / *y.cost;
        return {r, {r, r}, 0};
    }

private:
    SceneLab& lab_;
    const RecommendOptions& options_;
    Recommendation& result_;
};

/// By descending error: each step is cheaper than every setting of a smaller bound.
std::vector<Step> staircase_of(const std::vector<Candidate>& candidates) {
    std::vector<std::size_t> by_cost;
    for (std::size_t k = 0; k < candidates.size(); ++k)
        if (candidates[k].cost && candidates[k].bounds[0]) by_cost.push_back(k);
    std::ranges::stable_sort(by_cost, {}, [&](std::size_t k) { return *candidates[k].cost; });
    std::vector<Step> steps;
    for (const std::size_t k : by_cost)
        if (steps.empty() || *candidates[k].bounds[0] < steps.back().error)
            steps.push_back({k, *candidates[k].bounds[0]});
    return steps;
}

}  // namespace

Limit parse_limit(const std::string& text) {
    const LimitText limit = parse_limit_text(text, "METRIC=LIMIT, as rmse=0.01");
    return {&find_metric(limit.metric), limit.most};
}

std::vector<Family> families(std::span<const MethodChoice> choices) {
    std::vector<Family> all;
    for (const MethodChoice& choice : choices) {
        const Parameter* axis = line_of(*choice.info);
        const auto belongs    = [&](const Family& family) {
            const MethodChoice& other = family.settings.front();
            if (axis == nullptr || other.info != choice.info) return false;
            return std::ranges::all_of(choice.settings.parameters(), [&](const Parameter& p) {
                return p.name == axis->name || choice.settings.value(p.name) == other.settings.value(p.name);
            });
        };
        const auto found = std::ranges::find_if(all, belongs);
        if (found == all.end())
            all.push_back({axis != nullptr ? std::string(axis->name) : "", {choice}});
        else
            found->settings.push_back(choice);
    }
    for (Family& family : all) {
        if (family.settings.size() == 1) family.parameter.clear();
        if (!family.parameter.empty())
            std::ranges::stable_sort(family.settings, {},
                                     [&](const MethodChoice& c) { return c.settings.value(family.parameter); });
    }
    return all;
}

std::optional<std::size_t> first_good(std::size_t count, const std::function<bool(std::size_t)>& good) {
    if (count == 0 || !good(count - 1)) return std::nullopt;
    std::size_t low = 0, high = count - 1;  // the first good one is in [low, high], and high is good
    while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        if (good(middle))
            high = middle;
        else
            low = middle + 1;
    }
    return high;
}

bool Candidate::within(std::span<const Limit> limits) const { return worst_ratio(limits) <= 1; }

double Candidate::worst_ratio(std::span<const Limit> limits) const {
    double worst = 0;
    for (std::size_t k = 0; k < limits.size(); ++k) {
        if (!bounds[k]) return kUnknown;
        if (*bounds[k] > 0) worst = std::max(worst, limits[k].most > 0 ? *bounds[k] / limits[k].most : kUnknown);
    }
    return worst;
}

Recommendation recommend(SceneLab& lab, const RecommendOptions& options) {
    Recommendation r;
    Search search(lab, options, r);
    search.look_at_families();
    search.time_candidates();

    const auto cheaper = [&](std::size_t a, std::size_t b) { return *r.candidates[a].cost < *r.candidates[b].cost; };
    std::vector<std::size_t> timed, within;
    for (std::size_t k = 0; k < r.candidates.size(); ++k) {
        if (!r.candidates[k].cost) continue;
        timed.push_back(k);
        if (r.candidates[k].within(options.limits)) within.push_back(k);
    }
    std::ranges::stable_sort(timed, cheaper);
    std::ranges::stable_sort(within, cheaper);
    r.staircase = staircase_of(r.candidates);
    if (within.empty()) {
        for (const std::size_t k : timed)
            if (!r.nearest ||
                r.candidates[k].worst_ratio(options.limits) < r.candidates[*r.nearest].worst_ratio(options.limits))
                r.nearest = k;
        return r;
    }
    r.chosen         = within.front();
    const auto rival = [&](std::size_t k) {
        const Ratio ratio = search.ratio(k, *r.chosen);
        return Rival{k, ratio.median, ratio.interval.low, ratio.interval.high};
    };
    for (std::size_t n = 1; n < within.size(); ++n) {
        const Ratio ratio = search.ratio(within[n], *r.chosen);
        if (!differs(ratio, r.noise_bar))
            r.tied.push_back(rival(within[n]));
        else if (!r.runner_up)
            r.runner_up = rival(within[n]);
    }
    r.cheapest = rival(timed.front());
    for (const std::size_t k : timed)
        if (r.candidates[k].choice.info->reference && !r.exact) r.exact = rival(k);
    for (int view = options.views; view < options.views + options.held_out; ++view) {
        r.held_out.push_back(lab.cell(r.candidates[*r.chosen].choice, view));
        lab.release(view);
    }
    return r;
}

}  // namespace umbra
