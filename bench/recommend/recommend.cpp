#include "umbra/bench/recommend/recommend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

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
        const TimedTogether together = lab_.times(choices, turns, options_.most_noise);
        if (who.empty()) return;
        result_.noise_bar = together.noise_bar();
        for (std::size_t t = 0; t < who.size(); ++t) {
            const Json& times = together.settings[t];
            Candidate& c      = result_.candidates[who[t]];
            c.cost.reset();
            if (times.is_null()) continue;
            c.costs = costs_a_round(times, options_.workload);
            c.cost  = cost_of(times, options_.workload);
        }
    }

    /// The cost of `k` over that of `base`.
    [[nodiscard]] Rival rival(std::size_t k, std::size_t base) const {
        const Candidate &x = result_.candidates[k], &y = result_.candidates[base];
        if (!x.costs.empty() && !y.costs.empty())
            if (const Ratio ratio = paired_ratio(x.costs, y.costs); ratio.has_interval())
                return {k, ratio, umbra::differs(ratio, result_.noise_bar)};
        const double ratio = *x.cost / *y.cost;
        return {k, {ratio, {0, kUnknown}, 1}, std::max(ratio, 1 / ratio) > kTooExpensive};
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

/// By descending error: each step is cheaper than every setting of a smaller bound, by more than the noise bar.
std::vector<Step> staircase_of(const std::vector<Candidate>& candidates, double noise_bar) {
    std::vector<std::size_t> by_cost;
    for (std::size_t k = 0; k < candidates.size(); ++k)
        if (candidates[k].cost && candidates[k].bounds[0]) by_cost.push_back(k);
    std::ranges::stable_sort(by_cost, {}, [&](std::size_t k) { return *candidates[k].cost; });
    const double same = std::isfinite(noise_bar) ? 1 + noise_bar : 1;
    std::vector<Step> steps;
    double cheapest = 0;  // of those that the last step stands for
    for (const std::size_t k : by_cost) {
        const double cost = *candidates[k].cost, error = *candidates[k].bounds[0];
        if (!steps.empty() && error >= steps.back().error) continue;
        if (!steps.empty() && cost <= same * cheapest) {
            steps.back() = {k, error};
            continue;
        }
        steps.push_back({k, error});
        cheapest = cost;
    }
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
    r.staircase = staircase_of(r.candidates, r.noise_bar);
    if (within.empty()) {
        for (const std::size_t k : timed)
            if (!r.nearest ||
                r.candidates[k].worst_ratio(options.limits) < r.candidates[*r.nearest].worst_ratio(options.limits))
                r.nearest = k;
        return r;
    }
    const std::size_t first = within.front();
    for (std::size_t n = 1; n < within.size(); ++n) {
        const Rival rival = search.rival(within[n], first);
        if (!rival.differs)
            r.tied.push_back(rival);
        else if (!r.runner_up)
            r.runner_up = rival;
    }
    if (!r.tied.empty() && std::isfinite(r.noise_bar) && r.noise_bar > options.most_noise) {
        r.undecided.push_back(first);
        for (const Rival& rival : r.tied) r.undecided.push_back(rival.candidate);
        r.tied.clear();
        r.runner_up.reset();
        return r;
    }
    r.chosen   = first;
    r.cheapest = search.rival(timed.front(), first);
    for (const std::size_t k : timed)
        if (r.candidates[k].choice.info->reference && !r.exact) r.exact = search.rival(k, first);
    for (int view = options.views; view < options.views + options.held_out; ++view) {
        r.held_out.push_back(lab.cell(r.candidates[*r.chosen].choice, view));
        lab.release(view);
    }
    return r;
}

std::vector<TriedMethod> tried_methods(const Recommendation& r, const RecommendOptions& options) {
    std::vector<TriedMethod> all;
    const auto of = [&](const MethodInfo* info) -> TriedMethod& {
        const auto found = std::ranges::find(all, info, &TriedMethod::info);
        return found != all.end() ? *found
                                  : all.emplace_back(TriedMethod{.info = info, .candidate = {}, .outdone_by = {}});
    };
    for (const MethodChoice& choice : options.choices) ++of(choice.info).settings;
    // The first of these that differs decides: fit, timed, within the limits, then the cost, or how far it misses.
    const auto rank = [&](std::size_t k) {
        const Candidate& c = r.candidates[k];
        const bool within  = c.unfit.empty() && c.within(options.limits);
        const double cost  = c.cost.value_or(kUnknown);
        return std::tuple(!c.unfit.empty(), !c.cost, !within, within ? cost : c.worst_ratio(options.limits), cost);
    };
    for (std::size_t k = 0; k < r.candidates.size(); ++k) {
        const Candidate& c  = r.candidates[k];
        TriedMethod& method = of(c.choice.info);
        ++method.looked_at;
        method.within = method.within || (c.unfit.empty() && c.within(options.limits));
        if (!method.candidate || rank(k) < rank(*method.candidate)) method.candidate = k;
    }
    for (std::size_t p = 0; p < r.passed_over.size(); ++p) {
        TriedMethod& method = of(r.passed_over[p].choice.info);
        ++method.passed_over;
        if (!method.candidate &&
            (!method.outdone_by || r.passed_over[p].ratio < r.passed_over[*method.outdone_by].ratio))
            method.outdone_by = p;
    }
    return all;
}

}  // namespace umbra
