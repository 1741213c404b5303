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
// More than a busy machine makes of equal settings: by one run each, and by the faster of two, or where the run took so
// long that it had its share of the processors.
constexpr double kFar = 5, kFarTwice = 2, kLongRunMs = 250;

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
        Candidate c{choice, {}, false, {}, {}, {}, {}, {}, {}, {}};
        c.bounds.resize(options_.limits.size());
        look_on(c, true);
        result_.candidates.push_back(std::move(c));
        return result_.candidates.size() - 1;
    }

    /// Its bounds, also where some view is beyond a limit.
    Candidate& looked_at_whole(std::size_t candidate) {
        Candidate& c = result_.candidates[candidate];
        if (c.unfit.empty()) look_on(c, false);
        return c;
    }

    /// The settings that may be the answer: of each family the first within the limits; and those that the answer is
    /// compared with: of each family the first and the last. What serves exactly comes first, the reference before all,
    /// since others are outdone by it; then the last one of each family, so that those that share what was built and
    /// aimed at follow one another.
    void look_at_families() {
        std::vector<Family> all = families(options_.choices);
        std::ranges::stable_sort(all, {}, [&](const Family& f) {
            return std::pair(!f.settings.front().info->reference, !is_by_proof(f.settings.front()));
        });
        for (Family& family : all) {
            result_.settings += family.settings.size();
            drop_what_costs_too_much(family);
            while (!family.settings.empty() && is_outdone(family.settings.back())) family.settings.pop_back();
        }
        for (const Family& family : all) {
            if (family.settings.empty()) continue;
            const auto good = first_good(family.settings.size(), [&](std::size_t k) {
                return result_.candidates[look(family.settings[k])].within(options_.limits);
            });
            if (good) static_cast<void>(look(family.settings[*good]));
            static_cast<void>(look(family.settings.front()));
        }
        result_.looked_at = result_.candidates.size();
    }

    /// Each setting of a family costs more than those before it: from the first that is passed over on, all are.
    void drop_what_costs_too_much(Family& family) {
        const auto first = std::ranges::find_if(family.settings, [&](const MethodChoice& c) { return pass_over(c); });
        if (first == family.settings.end()) return;
        const PassedOver least = result_.passed_over.back();
        for (auto later = first + 1; later != family.settings.end(); ++later)
            result_.passed_over.push_back({*later, least.candidate, least.ratio});
        family.settings.erase(first, family.settings.end());
    }

    /// Settings that were outdone by one that is the answer no longer are looked at further. Whether there are any.
    bool look_at_outdone_by(std::size_t candidate) {
        bool any = false;
        for (Candidate& c : result_.candidates) {
            if (c.outdone_by != candidate) continue;
            c.outdone_by.reset();
            look_on(c, true);
            any = true;
        }
        return any;
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
            if (!mine || !other || !costs_far_more(choice, c.choice)) continue;
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
                if (rivals && !costs_far_more(c.choice, answer.choice) && std::ranges::find(who, k) == who.end())
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
        if (is_the_reference(result_.candidates[k])) return std::nullopt;
        for (int view = options_.views, left = options_.held_out; left > 0; ++view, --left) {
            const Json cell = lab_.cell(result_.candidates[k].choice, view);
            lab_.release(view);
            if (const auto beyond = beyond_in(cell, view)) {
                result_.held_out.clear();
                return Dropped{k, *beyond};
            }
            result_.held_out.push_back(cell);
        }
        return std::nullopt;
    }

    /// The cost of `k` over that of `base`.
    [[nodiscard]] Rival rival(std::size_t k, std::size_t base) {
        const Candidate &x = result_.candidates[k], &y = result_.candidates[base];
        Ratio ratio = paired_ratio(x.costs, y.costs);
        if (ratio.has_interval()) return {k, ratio, umbra::differs(ratio, result_.noise_bar)};
        if (ratio.pairs == 0) {
            ratio.median = *x.price / *y.price;
            return {k, ratio, costs_far_more(x.choice, y.choice) || costs_far_more(y.choice, x.choice)};
        }
        return {k, ratio, std::max(ratio.median, 1 / ratio.median) > kFar};
    }

private:
    [[nodiscard]] std::optional<Beyond> beyond_in(const Json& cell, int view) const {
        for (const Limit& limit : options_.limits)
            if (const auto error = error_in_view(*limit.metric, cell); !error || *error > limit.most)
                return Beyond{view, limit.metric, error};
        return std::nullopt;
    }

    /// Its views that are missing; `while_needed`: up to one that is beyond a limit, or by which it is outdone.
    void look_on(Candidate& c, bool while_needed) {
        const auto all = static_cast<std::size_t>(options_.views);
        while (c.views.size() < all) {
            const int view = static_cast<int>(c.views.size());
            c.views.push_back(lab_.cell(c.choice, view));
            c.unfit = why_unfit(c.views);
            if (!c.unfit.empty()) return;
            if (!c.beyond) c.beyond = beyond_in(c.views.back(), view);
            if (!while_needed || c.views.size() == all) continue;
            if (!c.beyond) c.outdone_by = outdone_by(c);
            if (c.beyond || c.outdone_by) return;
        }
        c.is_whole = true;
        for (std::size_t k = 0; k < options_.limits.size(); ++k)
            c.bounds[k] = upper_bound(*options_.limits[k].metric, c.views);
    }

    /// Whether only rounding can make it err.
    [[nodiscard]] bool is_by_proof(const MethodChoice& choice) const {
        try {
            const How how = verdict(*choice.make(), lab_.facts()).how;
            return how == How::exactly || how == How::to_rounding;
        } catch (const UsageError&) {  // its settings contradict one another
            return false;
        }
    }

    [[nodiscard]] bool is_outdone(const MethodChoice& choice) {
        return result_.candidates[look(choice)].outdone_by.has_value();
    }

    /// It is then neither the answer nor a step of the staircase.
    [[nodiscard]] std::optional<std::size_t> outdone_by(const Candidate& c) {
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            const Candidate& other = result_.candidates[k];
            const bool is_dropped  = std::ranges::find(result_.dropped, k, &Dropped::candidate) != result_.dropped.end();
            if (!other.unfit.empty() || is_dropped || !outdoes(other, c)) continue;
            if (other.within(options_.limits)) return k;
        }
        return std::nullopt;
    }

    /// Whether `a` is cheaper than `b` by far and no worse: within the limits if `b` is, and its bound no higher.
    [[nodiscard]] bool outdoes(const Candidate& a, const Candidate& b) {
        const bool no_worse = a.within(options_.limits) || !b.within(options_.limits);
        const auto least    = b.least_bound(options_.limits, 0);
        const bool lower    = a.bounds[0] && (!least || *a.bounds[0] <= *least);
        return no_worse && lower && costs_far_more(b.choice, a.choice);
    }

    [[nodiscard]] bool costs_far_more(const MethodChoice& a, const MethodChoice& b) {
        const auto ratio = [&](int runs_of_a, int runs_of_b) {
            const std::optional<double> over = price(a, runs_of_a), under = price(b, runs_of_b);
            return over && under ? *over / *under : 0;
        };
        const double once = ratio(1, 1);
        if (once > kFar || once <= kFarTwice) return once > kFar;
        return ratio(lab_.price(a)->all() > kLongRunMs ? 1 : 2, 2) > kFarTwice;
    }

    /// Milliseconds a frame, alone; nothing where the setting does not serve.
    [[nodiscard]] std::optional<double> price(const MethodChoice& choice, int runs = 1) {
        const std::optional<RunTimes> times = lab_.price(choice, runs);
        if (!times) return std::nullopt;
        const auto sum = [](const std::vector<double>& lights) {
            return std::accumulate(lights.begin(), lights.end(), 0.0);
        };
        return frame_cost_ms(options_.workload, {times->build, sum(times->aim), times->look, sum(times->visibility)});
    }

    SceneLab& lab_;
    const RecommendOptions& options_;
    Recommendation& result_;
};

/// By descending error: each step is cheaper than every setting of a smaller bound, by more than the noise bar. What a
/// view rules out as a step is looked at in no further one.
std::vector<Step> staircase_of(Search& search, const Recommendation& r, const RecommendOptions& options) {
    std::vector<std::size_t> by_cost;
    for (std::size_t k = 0; k < r.candidates.size(); ++k)
        if (r.candidates[k].cost) by_cost.push_back(k);
    std::ranges::stable_sort(by_cost, {}, [&](std::size_t k) { return *r.candidates[k].cost; });
    const double same = std::isfinite(r.noise_bar) ? 1 + r.noise_bar : 1;
    std::vector<Step> steps;
    double cheapest    = 0;  // of those that the last step stands for
    const auto is_step = [&](const std::optional<double>& error) {
        return error && (steps.empty() || *error < steps.back().error);
    };
    for (const std::size_t k : by_cost) {
        if (!is_step(r.candidates[k].least_bound(options.limits, 0))) continue;
        const auto error = search.looked_at_whole(k).bounds[0];
        if (!is_step(error)) continue;
        const double cost = *r.candidates[k].cost;
        if (!steps.empty() && cost <= same * cheapest) {
            steps.back() = {k, *error};
            continue;
        }
        steps.push_back({k, *error});
        cheapest = cost;
    }
    return steps;
}

/// Of those that were timed, the one that misses by the smallest factor.
std::optional<std::size_t> nearest_of(Search& search, std::vector<std::size_t> timed, const Recommendation& r,
                                      const RecommendOptions& options) {
    const auto ratio = [&](std::size_t k) { return r.candidates[k].worst_ratio(options.limits); };
    std::ranges::stable_sort(timed, {}, ratio);  // of some only what it is no less than is known
    std::optional<std::size_t> nearest;
    for (const std::size_t k : timed) {
        if (nearest && ratio(k) >= ratio(*nearest)) continue;
        static_cast<void>(search.looked_at_whole(k));
        if (!nearest || ratio(k) < ratio(*nearest)) nearest = k;
    }
    return nearest;
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

bool Candidate::within(std::span<const Limit> limits) const { return is_whole && !beyond && worst_ratio(limits) <= 1; }

std::optional<double> Candidate::least_bound(std::span<const Limit> limits, std::size_t limit) const {
    if (is_whole || views.empty()) return bounds[limit];
    double least = 0;
    for (const Json& cell : views) {
        const std::optional<double> error = error_in_view(*limits[limit].metric, cell);
        if (!error) return std::nullopt;
        least = std::max(least, *error);
    }
    return least;
}

double Candidate::worst_ratio(std::span<const Limit> limits) const {
    double worst = 0;
    for (std::size_t k = 0; k < limits.size(); ++k) {
        const std::optional<double> least = least_bound(limits, k);
        if (!least) return kInfinite;
        if (*least > 0) worst = std::max(worst, limits[k].most > 0 ? *least / limits[k].most : kInfinite);
    }
    return worst;
}

bool is_the_reference(const Candidate& c) {
    return c.choice.info->reference && std::ranges::all_of(c.views, [](const Json& cell) {
               return cell.at("serves").at("how") == "exactly";
           });
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
    };
    rank();
    if (within.empty()) {
        r.nearest   = nearest_of(search, timed, r, options);
        r.staircase = staircase_of(search, r, options);
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
            r.staircase = staircase_of(search, r, options);
            return r;
        }
        if (auto dropped = search.try_on_further_views(within.front())) {
            r.dropped.push_back(*dropped);
            const bool next = search.look_behind(dropped->candidate);
            if (search.look_at_outdone_by(dropped->candidate) || next) search.time_candidates();
            rank();
        } else {
            r.chosen = within.front();
        }
    }
    r.staircase = staircase_of(search, r, options);
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
