#include "umbra/bench/sweep/recommend/recommend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/stopwatch.h"

namespace umbra {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// More than a busy machine makes of equal settings: by the faster of two runs each, or one that took so long that it had
// its share of the processors; and by the median of few rounds.
constexpr double kFar = 2, kLongRunMs = 250, kFarByFewRounds = 5;

std::vector<double> costs_a_round(const TurnTimesRecord& times, const Workload& workload) {
    const TimesRecord& of = times.phases;
    std::vector<double> costs;
    if (times.order.empty()) return costs;  // its one sample is of no round
    for (std::size_t r = 0; r < of.build_ms->samples.size(); ++r)
        costs.push_back(frame_cost_ms(workload, {of.build_ms->samples.at(r), of.aim_ms->samples.at(r),
                                                 of.look_ms->samples.at(r), of.visibility_ms->samples.at(r)}));
    return costs;
}

/// Nothing where the setting failed or does not serve there, or leaves too much undefined.
std::optional<double> error_in_view(const Metric& metric, const Cell& cell) {
    return why_unfit({&cell, 1}).empty() ? possible_error(metric, cell) : std::nullopt;
}

// Views of a setting that is beyond a limit are looked at for the sake of the staircase where it would be a step that
// lowers the error by a fifth, until they have taken a fifth of the search, at least and at most so many seconds.
constexpr double kStep = 0.8, kStepsPart = 0.2, kFewestStepsSeconds = 1, kMostStepsSeconds = 3;

// Of the time for rounds, where one setting alone may be the answer, so that nothing is ranked by them.
constexpr double kOfOne = 0.5;

constexpr double kQuickSeconds = 1.5;  ///< of one run: what takes longer comes behind all others

/// So many times as long is looked for a setting that is within the limits at all and is not the reference.
constexpr double kPatience = 4;

/// Looks at settings of one scene, each once. Errors are those of small pictures, whose points are as good a sample of
/// the scene; times are of whole ones.
class Search {
public:
    Search(SceneLab& small, SceneLab& whole, const RecommendOptions& options, Recommendation& result)
        : small_(small), whole_(whole), options_(options), result_(result) {
        result_.size = size_record(small.size());
        families_    = families(options.choices);
        std::ranges::stable_sort(families_, {}, [&](const Family& f) {
            return std::pair(!f.front().info->reference, !is_by_proof(f.front()));
        });
    }

    /// The settings that may be the answer, of each family those up to the first within the limits, and the reference,
    /// which comes first: others are passed over by what is within the limits and costs far less. Always the family
    /// whose setting before ran the shortest, so that what takes long is left where the time is up. What was looked at
    /// for an earlier question comes before all others, and the time that it took is spent.
    void look_at_families() {
        struct Line {
            std::span<const MethodChoice> left;
            bool is_new   = true;   ///< none of its family was looked at
            bool is_long  = false;  ///< a run takes longer than kQuickSeconds
            double ran_ms = 0;  ///< the setting before the first of these, or the fastest of the method where it is new
        };
        std::vector<Line> lines;
        for (const Family& family : families_) lines.push_back({family});
        result_.passed_over.clear();
        result_.unasked.clear();
        const auto method_of = [](const Line& l) { return l.left.front().info; };
        const Stopwatch start;
        const double before = result_.candidates.empty() ? look_at_kept() : 0;  // behind a drop: anew
        if (options_.first && known(*options_.first) == kNone) {
            const Stopwatch begin;
            look(*options_.first);
            small_.spend_on(*options_.first, begin.seconds());  // so that another question knows it
        }
        while (!lines.empty()) {
            const auto line = std::ranges::min_element(
                lines, {}, [&](const Line& l) { return std::tuple(!method_of(l)->reference, l.is_long, l.ran_ms); });
            const std::span<const MethodChoice> left = line->left;
            const Stopwatch begin;
            const std::size_t k    = known(left.front());
            const double time_left = has_cheap_answer() ? options_.seconds - before - start.seconds()
                                                        : kPatience * options_.seconds - start.seconds();
            const bool is_late     = time_left < 0;
            const double most      = line->is_long ? std::max(time_left, kQuickSeconds) : kQuickSeconds;
            const bool is_cut =
                k == kNone && !is_late && !method_of(*line)->reference && small_.takes_longer(left.front(), most);
            bool goes_on = false;
            if (k == kNone && (is_late || (is_cut && line->is_long))) {
                result_.unasked.insert(result_.unasked.end(), left.begin(), left.end());
            } else if (is_cut) {
                for (Line& other : lines) other.is_long = other.is_long || method_of(other) == method_of(*line);
                goes_on = true;
            } else if (const auto by = passed_over_by(left.front())) {
                for (const MethodChoice& choice : left)  // each costs more than those before it
                    result_.passed_over.push_back({choice, by->candidate, by->ratio});
            } else if (!is_answer(k == kNone ? look(left.front()) : k) && left.size() > 1) {
                *line = {left.subspan(1), false, line->is_long, ran_ms(left.front())};
                for (Line& other : lines)
                    if (other.is_new && method_of(other) == method_of(*line))
                        other.ran_ms = other.ran_ms > 0 ? std::min(other.ran_ms, line->ran_ms) : line->ran_ms;
                goes_on = true;
            }
            if (k == kNone && !is_late) small_.spend_on(left.front(), begin.seconds());
            if (!goes_on) lines.erase(line);
        }
        search_took_ += start.seconds();
    }

    /// Each candidate gets its price as its cost. Those that may be the answer get the median of rounds in turns, and so
    /// do the steps by price, where they have such times together with the former, or where all take turns now.
    void time_candidates() {
        std::vector<std::size_t> fit;
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            Candidate& c = result_.candidates[k];
            if (!c.unfit.empty()) continue;
            c.costs.clear();
            c.cost = c.price = price(c.choice);
            if (c.cost) fit.push_back(k);
        }
        const auto is_outdone = [&](std::size_t k) {
            return std::ranges::any_of(fit, [&](std::size_t o) {
                return is_answer(o) && costs_far_more(result_.candidates[k].choice, result_.candidates[o].choice);
            });
        };
        std::vector<std::size_t> who;
        for (const std::size_t k : fit)
            if (is_answer(k) && !is_outdone(k)) who.push_back(k);
        const std::size_t rivals = who.size();
        const bool are_known     = rivals > 0 && whole_.stored_times(choices_of(who), options_.most_noise);
        for (const Step& step : staircase()) {
            const MethodChoice& choice = result_.candidates[step.candidate].choice;
            if (std::ranges::find(who, step.candidate) != who.end() || is_outdone(step.candidate) || is_long(choice))
                continue;
            who.push_back(step.candidate);
            if (are_known && !whole_.stored_times(choices_of(who), options_.most_noise)) who.pop_back();
        }
        if (!who.empty()) time_in_turns_with_one_another(who, rivals);
    }

    /// Up to the first view that is beyond a limit. Its cells are kept where all are within.
    [[nodiscard]] std::optional<Dropped> try_on_further_views(std::size_t k) {
        result_.held_out.clear();
        if (is_the_reference(result_.candidates[k].choice, result_.candidates[k].cells)) return std::nullopt;
        for (int view = options_.views, left = options_.held_out; left > 0; ++view, --left) {
            const Cell cell = small_.cell(result_.candidates[k].choice, view);
            small_.release(view);
            if (const auto beyond = beyond_in(cell, view)) {
                result_.held_out.clear();
                return Dropped{k, *beyond};
            }
            result_.held_out.push_back(cell);
        }
        return std::nullopt;
    }

    /// Whether it is within the limits, and was not dropped.
    [[nodiscard]] bool is_answer(std::size_t k) const {
        return result_.candidates[k].within() &&
               std::ranges::find(result_.dropped, k, &Dropped::candidate) == result_.dropped.end();
    }

    /// Its bounds, also where some view is beyond a limit.
    void look_at_whole(std::size_t candidate) {
        Candidate& c = result_.candidates[candidate];
        if (c.unfit.empty()) look_on(c, options_.views, false);
    }

    /// By descending error: each step is cheaper than every setting of a smaller bound, by more than the noise bar.
    [[nodiscard]] std::vector<Step> staircase() {
        const Recommendation& r = result_;
        const double may_take   = std::clamp(kStepsPart * search_took_, kFewestStepsSeconds, kMostStepsSeconds);
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
            Candidate& c = result_.candidates[k];
            while (!c.is_whole && !is_long(c.choice) && steps_took_ < may_take) {
                const auto least = c.least_bound(0);
                if (!least || (!steps.empty() && *least > kStep * steps.back().error)) break;
                const Stopwatch start;
                look_on(c, static_cast<int>(c.cells.size()) + 1, false);
                steps_took_ += start.seconds();
                if (!c.unfit.empty()) break;
            }
            const auto error = c.bound(0);
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

    /// The cost of `k` over that of `base`.
    [[nodiscard]] Rival rival(std::size_t k, std::size_t base) {
        const Candidate &x = result_.candidates[k], &y = result_.candidates[base];
        const Ratio ratio = paired_ratio(x.costs, y.costs);
        CostRatioRecord record{
            .median = ratio.median, .rounds = static_cast<std::uint64_t>(ratio.pairs), .coverage = ratio.coverage};
        if (ratio.has_interval()) {
            record.low     = ratio.interval.low;
            record.high    = ratio.interval.high;
            record.differs = differs(ratio, result_.noise_bar);
        } else if (ratio.pairs > 0) {
            record.differs = std::max(ratio.median, 1 / ratio.median) > kFarByFewRounds;
        } else {
            record.median  = *x.price / *y.price;
            record.differs = costs_far_more(x.choice, y.choice) || costs_far_more(y.choice, x.choice);
        }
        return {k, record};
    }

private:
    /// Than the reference.
    [[nodiscard]] bool has_cheap_answer() const {
        for (std::size_t k = 0; k < result_.candidates.size(); ++k)
            if (!result_.candidates[k].choice.info->reference && is_answer(k)) return true;
        return false;
    }

    static constexpr std::size_t kNone = ~std::size_t{0};
    [[nodiscard]] std::size_t known(const MethodChoice& choice) const {
        for (std::size_t k = 0; k < result_.candidates.size(); ++k)
            if (result_.candidates[k].choice.info == choice.info &&
                result_.candidates[k].choice.settings == choice.settings)
                return k;
        return kNone;
    }

    /// Of what earlier questions have looked at, all but what costs far more than an answer. The seconds that they have
    /// spent on all settings.
    double look_at_kept() {
        double spent = 0;
        for (const Family& family : families_)
            for (const MethodChoice& choice : family) spent += small_.spent_on(choice);
        for (const KeptSetting& kept : kept_settings(small_, whole_, families_, options_.workload))
            if (!passed_over_by(kept.choice)) look(kept.choice);
        return spent;
    }

    std::size_t look(const MethodChoice& choice) {
        if (options_.progress) options_.progress(choice.text());
        Candidate c{{.method = choice.text()}, choice};
        for (const Limit& limit : options_.limits)
            c.errors.emplace_back(limit.metric->name, LimitedRecord{.limit = limit.most});
        look_on(c, options_.views, true);
        result_.candidates.push_back(std::move(c));
        return result_.candidates.size() - 1;
    }

    /// Its first `count` views, where they are missing; `while_within`: up to one that is beyond a limit. Of the
    /// reference one is enough.
    void look_on(Candidate& c, int count, bool while_within) {
        const auto is_enough = [&] {
            return static_cast<int>(c.cells.size()) == options_.views || is_the_reference(c.choice, c.cells);
        };
        while (!is_enough() && static_cast<int>(c.cells.size()) < count) {
            const int view = static_cast<int>(c.cells.size());
            c.cells.push_back(small_.cell(c.choice, view));
            c.views     = c.cells.size();
            c.undefined = most_undefined(c.cells);
            c.unfit     = why_unfit(c.cells);
            for (std::size_t k = 0; k < options_.limits.size(); ++k)
                c.errors[k].second.largest = largest_value(*options_.limits[k].metric, c.cells);
            if (!c.unfit.empty()) return;
            if (!c.beyond) c.beyond = beyond_in(c.cells.back(), view);
            if (while_within && c.beyond && !is_enough()) return;
        }
        if (!is_enough()) return;
        c.is_whole = true;
        for (std::size_t k = 0; k < options_.limits.size(); ++k)
            c.errors[k].second.bound = upper_bound(*options_.limits[k].metric, c.cells);
    }

    [[nodiscard]] std::optional<BeyondRecord> beyond_in(const Cell& cell, int view) const {
        for (const Limit& limit : options_.limits)
            if (const auto error = error_in_view(*limit.metric, cell); !error || *error > limit.most)
                return BeyondRecord{view, std::string(limit.metric->name), error};
        return std::nullopt;
    }

    /// A setting that costs far more than one that is within the limits cannot be the answer, whatever its errors. A
    /// limit of memory may be there for the sake of those that cost more.
    [[nodiscard]] std::optional<PassedOver> passed_over_by(const MethodChoice& choice) {
        if (choice.info->reference || options_.limits.front().metric->name == "memory_mb") return std::nullopt;
        for (std::size_t k = 0; k < result_.candidates.size(); ++k) {
            const auto ratio = is_answer(k) ? costs_far_more(choice, result_.candidates[k].choice) : std::nullopt;
            if (ratio) return PassedOver{choice, k, *ratio};
        }
        return std::nullopt;
    }

    [[nodiscard]] std::vector<MethodChoice> choices_of(const std::vector<std::size_t>& who) const {
        std::vector<MethodChoice> choices;
        for (const std::size_t k : who) choices.push_back(result_.candidates[k].choice);
        return choices;
    }

    void time_in_turns_with_one_another(const std::vector<std::size_t>& who, std::size_t rivals) {
        const std::vector<MethodChoice> choices = choices_of(who);
        TurnOptions turns                       = options_.turns;
        if (rivals > 0) turns.ranked = rivals;
        if (rivals < 2) turns.budget_ms *= kOfOne;
        for (const MethodChoice& choice : choices) turns.first.push_back(whole_.price(choice));
        const TimedTogether together = whole_.times(choices, turns, options_.most_noise);
        result_.noise_bar            = together.noise_bar();
        for (std::size_t t = 0; t < who.size(); ++t) {
            const auto& times = together.settings[t];
            Candidate& c      = result_.candidates[who[t]];
            c.cost.reset();
            if (!times) continue;
            c.costs = costs_a_round(*times, options_.workload);
            c.cost  = cost_of(times, options_.workload);
        }
    }

    /// How many times the cost of `b` that of `a` is; nothing where that is not far more.
    [[nodiscard]] std::optional<double> costs_far_more(const MethodChoice& a, const MethodChoice& b) {
        const auto ratio_of = [&](const auto& price_of) -> std::optional<double> {
            const std::optional<double> over = price_of(a), under = price_of(b);
            return over && under && *over > kFar * *under ? std::optional(*over / *under) : std::nullopt;
        };
        const auto by_one    = [&](const MethodChoice& choice) { return price(choice); };
        const auto by_two    = [&](const MethodChoice& choice) { return price(choice, is_long(choice) ? 1 : 2); };
        const auto on_wholes = [&](const MethodChoice& choice) { return price_on_whole(choice); };
        return ratio_of(by_one) && ratio_of(by_two) ? ratio_of(on_wholes) : std::nullopt;
    }

    /// By a run on the whole picture where that is short, since work on each triangle does not grow with the points.
    [[nodiscard]] std::optional<double> price_on_whole(const MethodChoice& choice) {
        const std::optional<RunTimes> few = small_.price(choice);
        const double more                 = more_points(small_, whole_);
        if (!few || more <= 1 || few->build + more * (few->all() - few->build) > kLongRunMs) return price(choice);
        const std::optional<RunTimes> all = whole_.price(choice);
        return all ? std::optional(price_ms(options_.workload, *all)) : std::nullopt;
    }

    /// Whether a run that serves takes long, a build that the workload never has included.
    [[nodiscard]] bool is_long(const MethodChoice& choice) { return small_.price(choice)->all() > kLongRunMs; }

    /// How long a run took behind its build, which settings share; where it does not serve, no time.
    [[nodiscard]] double ran_ms(const MethodChoice& choice) {
        const std::optional<RunTimes> run = small_.price(choice);
        return run ? run->all() - run->build : 0;
    }

    /// Milliseconds a frame, by runs alone; nothing where the setting does not serve.
    [[nodiscard]] std::optional<double> price(const MethodChoice& choice, int runs = 1) {
        const std::optional<RunTimes> times = small_.price(choice, runs);
        return times ? std::optional(price_ms(options_.workload, *times, more_points(small_, whole_))) : std::nullopt;
    }

    /// Whether only rounding can make it err.
    [[nodiscard]] bool is_by_proof(const MethodChoice& choice) const {
        try {
            const How how = verdict(*choice.make(), whole_.facts()).how;
            return how == How::exactly || how == How::to_rounding;
        } catch (const UsageError&) {  // its settings contradict one another
            return false;
        }
    }

    SceneLab &small_, &whole_;
    const RecommendOptions& options_;
    Recommendation& result_;
    double search_took_ = 0, steps_took_ = 0;  ///< seconds; of further views for their sake
    std::vector<Family> families_;
};

/// Of those that were timed, the one that misses by the smallest factor.
std::optional<std::size_t> nearest_of(Search& search, std::vector<std::size_t> timed, const Recommendation& r) {
    const auto ratio = [&](std::size_t k) { return r.candidates[k].worst_ratio(); };
    std::ranges::stable_sort(timed, {}, ratio);  // of some only what it is no less than is known
    std::optional<std::size_t> nearest;
    for (const std::size_t k : timed) {
        if (nearest && ratio(k) >= ratio(*nearest)) continue;
        search.look_at_whole(k);
        if (!nearest || ratio(k) < ratio(*nearest)) nearest = k;
    }
    return nearest;
}

/// Whether the parameter's sweep goes from large numbers to small ones, which cost more.
bool falls(const Parameter& swept) {
    const std::string_view sweep = swept.sweep;
    return std::stod(std::string(sweep)) > std::stod(std::string(sweep.substr(sweep.rfind('|') + 1)));
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
            const MethodChoice& other = family.front();
            if (axis == nullptr || other.info != choice.info) return false;
            return std::ranges::all_of(choice.settings.parameters(), [&](const Parameter& p) {
                return p.name == axis->name || choice.settings.text(p) == other.settings.text(p);
            });
        };
        const auto found = std::ranges::find_if(all, belongs);
        if (found == all.end())
            all.push_back({choice});
        else
            found->push_back(choice);
    }
    for (Family& family : all) {
        if (family.size() == 1) continue;
        const Parameter* axis = line_of(*family.front().info);
        const double sign     = falls(*axis) ? -1 : 1;
        std::ranges::stable_sort(family, {},
                                 [&](const MethodChoice& c) { return sign * c.settings.value(axis->name); });
    }
    return all;
}

bool Candidate::within() const { return is_whole && !beyond && worst_ratio() <= 1; }

std::optional<double> Candidate::least_bound(std::size_t limit) const {
    if (is_whole || cells.empty()) return bound(limit);
    const Metric& metric = find_metric(errors[limit].first);
    double least         = 0;
    for (const Cell& cell : cells) {
        const std::optional<double> error = error_in_view(metric, cell);
        if (!error) return std::nullopt;
        least = std::max(least, *error);
    }
    return least;
}

double Candidate::worst_ratio() const {
    double worst = 0;
    for (std::size_t k = 0; k < errors.size(); ++k) {
        const std::optional<double> least = least_bound(k);
        const double limit                = errors[k].second.limit;
        if (!least) return kInfinite;
        if (*least > 0) worst = std::max(worst, limit > 0 ? *least / limit : kInfinite);
    }
    return worst;
}

bool is_the_reference(const MethodChoice& choice, std::span<const Cell> views) {
    return choice.info->reference && !views.empty() &&
           std::ranges::all_of(views, [](const Cell& cell) { return cell.method.serves.how == "exactly"; });
}

double price_ms(const Workload& workload, const RunTimes& run, double more_points) {
    return frame_cost_ms(workload, {run.build, run.aims(), more_points * run.look, more_points * run.visibilities()});
}

double more_points(const SceneLab& small, const SceneLab& whole) {
    const Size few = small.size(), all = whole.size();
    return static_cast<double>(all.width) * all.height / (static_cast<double>(few.width) * few.height);
}

std::vector<KeptSetting> kept_settings(SceneLab& small, const SceneLab& whole, std::span<const Family> families,
                                       const Workload& workload) {
    std::vector<KeptSetting> kept;
    for (const Family& family : families)
        for (const MethodChoice& choice : family) {
            if (!(small.spent_on(choice) > 0) || !small.has_cell(choice, 0)) continue;
            const std::optional<RunTimes> run = small.price(choice);
            kept.push_back({choice, run ? price_ms(workload, *run, more_points(small, whole)) : 0});
        }
    std::ranges::stable_sort(kept, {}, &KeptSetting::cost);
    return kept;
}

Recommendation recommend(SceneLab& small, SceneLab& whole, const RecommendOptions& options) {
    Recommendation r;
    Search search(small, whole, options, r);
    search.look_at_families();
    search.time_candidates();

    std::vector<std::size_t> timed, within;
    const auto rank = [&] {
        timed.clear(), within.clear();
        for (std::size_t k = 0; k < r.candidates.size(); ++k) {
            if (!r.candidates[k].cost) continue;
            timed.push_back(k);
            if (search.is_answer(k)) within.push_back(k);
        }
        std::ranges::stable_sort(timed, {}, [&](std::size_t k) { return *r.candidates[k].cost; });
        // One run, alone, is no cost that a median of turns could be ranked by.
        std::ranges::stable_sort(
            within, {}, [&](std::size_t k) { return std::pair(r.candidates[k].costs.empty(), *r.candidates[k].cost); });
    };
    rank();
    if (within.empty()) {
        r.nearest   = nearest_of(search, timed, r);
        r.staircase = search.staircase();
        return r;
    }
    const auto compare_others = [&] {
        r.tied.clear(), r.untold.clear(), r.runner_up.reset();
        for (std::size_t n = 1; n < within.size(); ++n) {
            const Rival rival = search.rival(within[n], within.front());
            if (rival.tied())
                r.tied.push_back(rival);
            else if (!rival.ratio.differs)
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
            r.staircase = search.staircase();
            return r;
        }
        if (auto dropped = search.try_on_further_views(within.front())) {
            r.dropped.push_back(*dropped);
            const std::size_t before = r.candidates.size();
            search.look_at_families();
            if (r.candidates.size() > before) search.time_candidates();
            rank();
        } else {
            r.chosen = within.front();
        }
    }
    r.staircase = search.staircase();
    if (!r.chosen) return r;
    r.cheapest = search.rival(timed.front(), *r.chosen);
    for (const std::size_t k : timed)
        if (r.candidates[k].choice.info->reference && !r.exact) r.exact = search.rival(k, *r.chosen);
    return r;
}

std::vector<TriedMethod> tried_methods(const Recommendation& r, const RecommendOptions& options) {
    std::vector<TriedMethod> all;
    const auto of = [&](const MethodChoice& choice) -> TriedMethod& {
        const auto found = std::ranges::find(all, choice.info->name, &TriedMethod::method);
        return found != all.end() ? *found : all.emplace_back(TriedMethod{{.method = std::string(choice.info->name)}});
    };
    for (const MethodChoice& choice : options.choices) ++of(choice).settings;
    // The first of these that differs decides: fit, timed, within the limits, then the cost, or how far it misses.
    const auto rank = [&](std::size_t k) {
        const Candidate& c = r.candidates[k];
        const bool within  = c.unfit.empty() && c.within();
        const double cost  = c.cost.value_or(kInfinite);
        return std::tuple(!c.unfit.empty(), !c.cost, !within, within ? cost : c.worst_ratio(), cost);
    };
    for (std::size_t k = 0; k < r.candidates.size(); ++k) {
        const Candidate& c  = r.candidates[k];
        TriedMethod& method = of(c.choice);
        ++method.looked_at;
        method.within = method.within || (c.unfit.empty() && c.within());
        if (!method.candidate || rank(k) < rank(*method.candidate)) method.candidate = k;
    }
    for (std::size_t p = 0; p < r.passed_over.size(); ++p) {
        TriedMethod& method = of(r.passed_over[p].choice);
        ++method.passed_over;
        if (!method.candidate &&
            (!method.outdone_by || r.passed_over[p].ratio < r.passed_over[*method.outdone_by].ratio))
            method.outdone_by = p;
    }
    for (TriedMethod& method : all) {
        if (!method.candidate) continue;
        const Candidate& best = r.candidates[*method.candidate];
        method.best           = best;
        if (best.unfit.empty())
            method.factor = known(best.worst_ratio());
        else
            method.unfit = best.unfit;
    }
    return all;
}

}  // namespace umbra
