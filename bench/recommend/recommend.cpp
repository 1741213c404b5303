#include "umbra/bench/recommend/recommend.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "umbra/bench/statistics/statistics.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/limit_text.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

constexpr double kUnknown      = std::numeric_limits<double>::infinity();
constexpr double kTooExpensive = 5;  ///< one run each: more than a busy machine makes of equal settings

std::vector<double> costs_a_round(const Json& times, const Workload& workload) {
    const auto samples = [&](const char* phase) { return times.at(phase).at("samples").get<std::vector<double>>(); };
    const auto build = samples("build_ms"), aim = samples("aim_ms"), look = samples("look_ms"),
               visibility = samples("visibility_ms");
    std::vector<double> costs;
    if (times.at("order").empty()) return costs;  // its one sample is of no round
    for (std::size_t r = 0; r < build.size(); ++r)
        costs.push_back(frame_cost_ms(workload, {build[r], aim[r], look[r], visibility[r]}));
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
    /// compared with: of each family the first and the last. The reference comes first, since its price passes over
    /// others.
    void look_at_families() {
        std::vector<Family> all = families(options_.choices);
        std::stable_partition(all.begin(), all.end(),
                              [](const Family& f) { return f.settings.front().info->reference; });
        for (Family& family : all) {
            result_.settings += family.settings.size();
            while (!family.settings.empty() && pass_over(family.settings.back())) family.settings.pop_back();
            if (family.settings.empty()) continue;
            const auto good = first_good(family.settings.size(), [&](std::size_t k) {
                return result_.candidates[look(family.settings[k])].within(options_.limits);
            });
            if (good) static_cast<void>(look(family.settings[*good]));
            static_cast<void>(look(family.settings.front()));
        }
        result_.looked_at = result_.candidates.size();
    }

    /// Whether a setting cannot be the answer nor a step of the staircase, whatever its errors: the reference, or one
    /// without errors, is within the limits and cheaper by far. Memory is no error: others may need less than these.
    bool pass_over(const MethodChoice& choice) {
        if (choice.info->reference || options_.limits.front().metric->name == "memory_mb") return false;
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            const Candidate& c = result_.candidates[k];
            if (!c.unfit.empty() || !c.within(options_.limits)) continue;
            if (!c.choice.info->reference && *c.bounds[0] > 0) continue;
            const std::optional<double> mine = price(choice), other = price(c.choice);
            if (!mine || !other || *mine <= kTooExpensive * *other) continue;
            result_.passed_over.push_back({choice, k, *mine / *other});
            return true;
        }
        return false;
    }

    /// Each candidate gets its price as its cost, and those that may be the answer or a step, and the reference, the
    /// median of rounds in turns: the fewer take turns, the more rounds fit into the budget.
    void time_candidates() {
        std::vector<std::size_t> fit, who;
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            Candidate& c = result_.candidates[k];
            if (!c.unfit.empty()) continue;
            c.cost = price(c.choice);
            if (c.cost) fit.push_back(k);
        }
        std::vector<MethodChoice> choices;
        TurnOptions turns = options_.turns;
        for (const std::size_t k : fit) {
            const Candidate& c = result_.candidates[k];
            if (!c.choice.info->reference &&
                std::ranges::any_of(fit, [&](std::size_t other) { return outdoes(result_.candidates[other], c); }))
                continue;
            who.push_back(k);
            choices.push_back(c.choice);
            turns.first.push_back(lab_.price(c.choice));
        }
        const TimedTogether together = lab_.times(choices, turns);
        if (who.empty()) return;
        const Json& bar   = together.turns.at("noise_bar");
        result_.noise_bar = bar.is_number() ? bar.get<double>() : kUnknown;
        for (std::size_t t = 0; t < who.size(); ++t) {
            const Json& times = together.settings[t];
            Candidate& c      = result_.candidates[who[t]];
            c.cost.reset();
            if (times.is_null()) continue;
            c.costs = costs_a_round(times, options_.workload);
            c.cost  = cost_of(times, options_.workload);
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
    /// Whether `a` is cheaper than `b` by far and no worse: within the limits if `b` is, and its bound no higher.
    [[nodiscard]] bool outdoes(const Candidate& a, const Candidate& b) const {
        const bool no_worse = a.within(options_.limits) || !b.within(options_.limits);
        const bool lower    = a.bounds[0] && (!b.bounds[0] || *a.bounds[0] <= *b.bounds[0]);
        return no_worse && lower && *b.cost > kTooExpensive * *a.cost;
    }

    /// Milliseconds a frame by one run; nothing where the setting does not serve.
    [[nodiscard]] std::optional<double> price(const MethodChoice& choice) {
        const std::optional<RunTimes> run = lab_.price(choice);
        if (!run) return std::nullopt;
        const auto sum = [](const std::vector<double>& lights) {
            return std::accumulate(lights.begin(), lights.end(), 0.0);
        };
        return frame_cost_ms(options_.workload, {run->build, sum(run->aim), run->look, sum(run->visibility)});
    }

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
                return p.name == axis->name || choice.settings.text(p) == other.settings.text(p);
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
        const Ratio ratio   = search.ratio(within[n], *r.chosen);
        const bool by_price = ratio.pairs < 2;  // no rounds, hence no interval and no noise bar
        if (by_price ? ratio.median <= kTooExpensive : !differs(ratio, r.noise_bar))
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
