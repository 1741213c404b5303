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
#include "umbra/bench/sweep/metrics.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

constexpr double kInfinite     = std::numeric_limits<double>::infinity();
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

/// Nothing where the setting failed or does not serve there, or leaves too much undefined.
std::optional<double> error_in_view(const Metric& metric, const Json& cell) {
    return why_unfit({&cell, 1}).empty() ? possible_error(metric, cell) : std::nullopt;
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
        Candidate c{choice, {}, {}, {}, {}, {}, {}};
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

    /// The next setting of its family, where bisection has left that out. Whether there is one.
    bool look_behind(std::size_t candidate) {
        const MethodChoice& dropped = result_.candidates[candidate].choice;
        for (const Family& family : families(options_.choices)) {
            const auto is = [](const MethodChoice& a, const MethodChoice& b) {
                return a.info == b.info && a.settings == b.settings;
            };
            const auto here = std::ranges::find_if(family.settings, [&](const auto& c) { return is(c, dropped); });
            if (here == family.settings.end() || here + 1 == family.settings.end()) continue;
            const MethodChoice& next = *(here + 1);
            if (std::ranges::any_of(result_.passed_over, [&](const PassedOver& p) { return is(p.choice, next); }))
                return false;
            static_cast<void>(look(next));
            const bool is_new = result_.candidates.size() > result_.looked_at;
            result_.looked_at = result_.candidates.size();
            return is_new;
        }
        return false;
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
    /// median of rounds in turns: the fewer take turns, the more rounds fit into the budget. Turns may find another
    /// answer than prices do; what its price does not outdo takes turns with it, too.
    void time_candidates() {
        std::vector<std::size_t> fit, who;
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            Candidate& c = result_.candidates[k];
            if (!c.unfit.empty()) continue;
            c.costs.clear();
            c.cost = c.price = price(c.choice);
            if (c.cost) fit.push_back(k);
        }
        for (const std::size_t k : fit)
            if (result_.candidates[k].choice.info->reference || std::ranges::none_of(fit, [&](std::size_t o) {
                    return outdoes(result_.candidates[o], result_.candidates[k]);
                }))
                who.push_back(k);
        while (!who.empty()) {
            time_in_turns_with_one_another(who);
            const auto cheapest     = std::ranges::min_element(who, {}, [&](std::size_t k) {
                const Candidate& c = result_.candidates[k];
                return c.within(options_.limits) ? c.cost.value_or(kInfinite) : kInfinite;
            });
            const Candidate& answer = result_.candidates[*cheapest];
            const std::size_t timed = who.size();
            for (const std::size_t k : fit) {
                const Candidate& c = result_.candidates[k];
                const bool rivals  = answer.within(options_.limits) && c.within(options_.limits);
                if (rivals && *c.price <= kTooExpensive * *answer.price && std::ranges::find(who, k) == who.end())
                    who.push_back(k);
            }
            if (who.size() == timed) return;
        }
    }

    void time_in_turns_with_one_another(const std::vector<std::size_t>& who) {
        std::vector<MethodChoice> choices;
        TurnOptions turns = options_.turns;
        for (const std::size_t k : who) {
            choices.push_back(result_.candidates[k].choice);
            turns.first.push_back(lab_.price(result_.candidates[k].choice));
        }
        const TimedTogether together = lab_.times(choices, turns, options_.most_noise);
        result_.noise_bar            = together.noise_bar();
        for (std::size_t t = 0; t < who.size(); ++t) {
            const Json& times = together.settings[t];
            Candidate& c      = result_.candidates[who[t]];
            c.cost.reset();
            if (times.is_null()) continue;
            c.costs = costs_a_round(times, options_.workload);
            c.cost  = cost_of(times, options_.workload);
        }
    }

    /// Up to the first view that is beyond a limit. Its cells are kept where all are within.
    [[nodiscard]] std::optional<Dropped> try_on_further_views(std::size_t k) {
        result_.held_out.clear();
        for (int view = options_.views, left = options_.held_out; left > 0; ++view, --left) {
            const Json cell = lab_.cell(result_.candidates[k].choice, view);
            lab_.release(view);
            for (const Limit& limit : options_.limits) {
                const std::optional<double> error = error_in_view(*limit.metric, cell);
                if (error && *error <= limit.most) continue;
                result_.held_out.clear();
                return Dropped{k, view, limit.metric, error};
            }
            result_.held_out.push_back(cell);
        }
        return std::nullopt;
    }

    /// The cost of `k` over that of `base`.
    [[nodiscard]] Rival rival(std::size_t k, std::size_t base) const {
        const Candidate &x = result_.candidates[k], &y = result_.candidates[base];
        Ratio ratio = paired_ratio(x.costs, y.costs);
        if (ratio.has_interval()) return {k, ratio, umbra::differs(ratio, result_.noise_bar)};
        if (ratio.pairs == 0) ratio.median = *x.price / *y.price;
        return {k, ratio, std::max(ratio.median, 1 / ratio.median) > kTooExpensive};
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
        if (!bounds[k]) return kInfinite;
        if (*bounds[k] > 0) worst = std::max(worst, limits[k].most > 0 ? *bounds[k] / limits[k].most : kInfinite);
    }
    return worst;
}

Recommendation recommend(SceneLab& lab, const RecommendOptions& options) {
    Recommendation r;
    Search search(lab, options, r);
    search.look_at_families();
    search.time_candidates();

    std::vector<std::size_t> timed, within;
    const auto rank = [&] {
        timed.clear(), within.clear();
        for (std::size_t k = 0; k < r.candidates.size(); ++k) {
            if (!r.candidates[k].cost) continue;
            timed.push_back(k);
            if (r.candidates[k].within(options.limits) &&
                std::ranges::find(r.dropped, k, &Dropped::candidate) == r.dropped.end())
                within.push_back(k);
        }
        std::ranges::stable_sort(timed, {}, [&](std::size_t k) { return *r.candidates[k].cost; });
        // One run, alone, is no cost that a median of turns could be ranked by.
        std::ranges::stable_sort(
            within, {}, [&](std::size_t k) { return std::pair(r.candidates[k].costs.empty(), *r.candidates[k].cost); });
        r.staircase = staircase_of(r.candidates, r.noise_bar);
    };
    rank();
    if (within.empty()) {
        for (const std::size_t k : timed)
            if (!r.nearest ||
                r.candidates[k].worst_ratio(options.limits) < r.candidates[*r.nearest].worst_ratio(options.limits))
                r.nearest = k;
        return r;
    }
    const auto compare_others = [&] {
        r.tied.clear(), r.untold.clear(), r.runner_up.reset();
        for (std::size_t n = 1; n < within.size(); ++n) {
            const Rival rival = search.rival(within[n], within.front());
            if (rival.tied())
                r.tied.push_back(rival);
            else if (!rival.differs)
                r.untold.push_back(rival);
            else if (!r.runner_up)
                r.runner_up = rival;
        }
    };
    while (!r.chosen && !within.empty()) {
        compare_others();
        if (!r.tied.empty() && std::isfinite(r.noise_bar) && r.noise_bar > options.most_noise) {
            r.undecided.push_back(within.front());
            for (const Rival& rival : r.tied) r.undecided.push_back(rival.candidate);
            r.tied.clear(), r.untold.clear(), r.runner_up.reset();
            return r;
        }
        if (auto dropped = search.try_on_further_views(within.front())) {
            r.dropped.push_back(*dropped);
            if (search.look_behind(dropped->candidate)) search.time_candidates();
            rank();
        } else {
            r.chosen = within.front();
        }
    }
    if (!r.chosen) return r;
    r.cheapest = search.rival(timed.front(), *r.chosen);
    for (const std::size_t k : timed)
        if (r.candidates[k].choice.info->reference && !r.exact) r.exact = search.rival(k, *r.chosen);
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
        const double cost  = c.cost.value_or(kInfinite);
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
