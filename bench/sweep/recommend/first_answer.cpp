#include "umbra/bench/sweep/recommend/first_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "umbra/bench/sweep/bounds.h"
#include "umbra/core/base/stopwatch.h"

namespace umbra {
namespace {

/// Of n points none of which is wrong, a share of 3 / n may be (upper_share); half of a picture's points may have no
/// surface, or one that faces away from the light.
constexpr double kPoints = 6, kFewestPoints = 60000;  ///< the second: so that limits from 0.01 on share their cells

constexpr double kSecondsOfKept = 1;  ///< of computing further views of what earlier questions have looked at

constexpr double kFarBeyond = 2;  ///< times the limit

constexpr double kLongMs = 500;  ///< of one run, at few points or at all: nobody waits for a longer one
constexpr double kSlowMs = 200;  ///< of one run at few points: a method with a longer one comes behind the others

bool depends_on_the_size(const Metric& metric) {
    return metric.name != "rmse" && metric.name != "mae" && metric.name != "image_rmse";
}

/// One search; the clock runs from the start.
class FirstSearch {
public:
    FirstSearch(SceneLab& coarse, SceneLab& whole, const RecommendOptions& options, double seconds)
        : coarse_(coarse), whole_(whole), options_(options), seconds_(seconds) {}

    [[nodiscard]] bool is_over() const { return start_.seconds() >= seconds_; }
    [[nodiscard]] const std::optional<FirstAnswer>& best() const { return best_; }

    /// What earlier questions have looked at: first what they leave to read, then what takes too short to wait for,
    /// and where nothing is within the limits, what was so at fewer points.
    void look_at_kept(std::span<const Family> families) {
        const std::vector<KeptSetting> kept = kept_settings(coarse_, whole_, families, options_.workload);
        std::vector<KeptSetting> rest;
        for (const KeptSetting& k : kept) {
            if (k.choice.info->reference) continue;
            if (kept_views(coarse_, k.choice) < kFirstViews)
                rest.push_back(k);
            else if (take_if_within(k.choice, k.cost))
                break;
        }
        for (const KeptSetting& k : rest) {
            if (best_ && k.cost >= best_->cost) break;
            if (start_.seconds() + kFirstViews * coarse_.spent_on(k.choice) > kSecondsOfKept) continue;
            if (take_if_within(k.choice, k.cost)) break;
        }
        if (best_ || !has_fewer()) return;
        for (const KeptSetting& k : kept_settings(few_, whole_, families, options_.workload))
            if (!k.choice.info->reference && is_within_as_kept(k.choice) &&
                (is_over() || take_if_within(k.choice, k.cost)))
                return;
    }

    /// The next setting of a family: each costs more than those before it, and errs less. What it costs; nothing where
    /// no further one of the family can be the answer.
    [[nodiscard]] std::optional<double> look_at(const MethodChoice& choice) {
        SceneLab& small                  = lab_for(choice);
        const bool is_beyond             = &small == &few_;
        const std::optional<double> cost = cost_of(choice, small);
        if (!cost || (best_ && *cost >= best_->cost) || (!is_beyond && take_if_within(choice, *cost)))
            return std::nullopt;
        return cost;
    }

    /// Whether a run at few points takes longer than kSlowMs.
    [[nodiscard]] bool is_slow(const MethodChoice& choice) {
        return !choice.info->reference && lab_for(choice).takes_longer(choice, kSlowMs / 1000);
    }

private:
    [[nodiscard]] SceneLab& lab_for(const MethodChoice& choice) {
        return is_far_beyond_as_kept(choice) ? few_ : coarse_;
    }

    /// The views, from view 0 on, that need not be computed; no more than an answer is from.
    [[nodiscard]] static int kept_views(SceneLab& lab, const MethodChoice& choice) {
        int views = 0;
        while (views < kFirstViews && lab.has_cell(choice, views)) ++views;
        return views;
    }

    /// At fewer points, in each view that an earlier question has looked at.
    [[nodiscard]] bool is_within_as_kept(const MethodChoice& choice) {
        for (int view = 0, views = kept_views(few_, choice); view < views; ++view)
            if (!is_within(few_.cell(choice, view))) return false;
        return true;
    }

    /// At fewer points, by an earlier question: more points change no mean error that much.
    [[nodiscard]] bool is_far_beyond_as_kept(const MethodChoice& choice) {
        if (!has_fewer() || choice.info->reference || kept_views(few_, choice) == 0) return false;
        const Cell cell = few_.cell(choice, 0);
        return std::ranges::any_of(options_.limits, [&](const Limit& limit) {
            const auto error = possible_error(*limit.metric, cell);
            return !depends_on_the_size(*limit.metric) && error && *error > kFarBeyond * limit.most;
        });
    }

    /// In one view.
    [[nodiscard]] bool is_within(const Cell& cell) const {
        if (!why_unfit({&cell, 1}).empty()) return false;
        return std::ranges::all_of(options_.limits, [&](const Limit& limit) {
            const auto error = possible_error(*limit.metric, cell);
            return error && *error <= limit.most;
        });
    }

    /// By one run on the whole picture, where one at few points does not say already that it is dearer; from that one
    /// where the other would take too long.
    [[nodiscard]] std::optional<double> cost_of(const MethodChoice& choice, SceneLab& small) {
        if (!choice.info->reference && small.takes_longer(choice, kLongMs / 1000)) return std::nullopt;
        const std::optional<RunTimes> few = small.price(choice);
        if (!few) return std::nullopt;
        const double more = more_points(small, whole_);
        if (more * few->all() > kLongMs) return price_ms(options_.workload, *few, more);
        if (const double least = price_ms(options_.workload, *few); best_ && least >= best_->cost) return least;
        const std::optional<RunTimes> all = whole_.price(choice);
        return all ? std::optional(price_ms(options_.workload, *all)) : std::nullopt;
    }

    /// Whether it is within the limits; then it is the best so far.
    bool take_if_within(const MethodChoice& choice, double cost) {
        std::vector<Cell> cells;
        for (int view = 0; view < kFirstViews; ++view) {
            if (is_the_reference(choice, cells)) break;
            if (view > 0 && is_over()) return false;
            cells.push_back(coarse_.cell(choice, view));
            if (!is_within(cells.back())) return false;
        }
        FirstAnswer answer{{.method = choice.text(), .cost = cost}, choice};
        for (const Limit& limit : options_.limits) {
            const auto bound = upper_bound(*limit.metric, cells);
            if (!bound || *bound > limit.most) return false;
            answer.bounds.emplace_back(limit.metric->name, *bound);
        }
        best_ = std::move(answer);
        return true;
    }

    /// Whether questions with looser limits were answered by smaller pictures.
    [[nodiscard]] bool has_fewer() const { return more_points(few_, coarse_) > 1; }

    SceneLab &coarse_, &whole_;
    SceneLab few_{coarse_, first_size(whole_.size(), {})};
    const RecommendOptions& options_;
    double seconds_;
    Stopwatch start_;
    std::optional<FirstAnswer> best_;
};

}  // namespace

Size first_size(const Size& whole, std::span<const Limit> limits) {
    double points = kFewestPoints;
    for (const Limit& limit : limits) {
        if (depends_on_the_size(*limit.metric)) return whole;
        points = std::max(points,
                          kPoints / (limit.metric->kind == Metric::Kind::rms ? limit.most * limit.most : limit.most));
    }
    const double all = static_cast<double>(whole.width) * whole.height, side = std::sqrt(std::min(1.0, points / all));
    return {std::max(1, static_cast<int>(std::ceil(side * whole.width))),
            std::max(1, static_cast<int>(std::ceil(side * whole.height)))};
}

std::optional<FirstAnswer> first_answer(SceneLab& coarse, SceneLab& whole, const RecommendOptions& options,
                                        double seconds) {
    FirstSearch search(coarse, whole, options, seconds);
    const std::vector<Family> all = families(options.choices);
    search.look_at_kept(all);
    const bool is_kept = search.best().has_value();
    struct Line {
        std::span<const MethodChoice> left;
        double last  = 0;      ///< what the setting before the first of these costs
        bool is_slow = false;  ///< a run of the method takes longer than kSlowMs
    };
    std::vector<Line> lines;
    for (const Family& family : all) lines.push_back({family});
    // Always where the last one was cheapest, slow methods last: what costs a lot is looked at if nothing that costs little
    // is an answer.
    while (!is_kept && !lines.empty() && !search.is_over()) {
        const auto line = std::ranges::min_element(
            lines, {}, [](const Line& l) { return std::tuple(!l.left.front().info->reference, l.is_slow, l.last); });
        const MethodChoice& choice = line->left.front();
        if (!line->is_slow && search.is_slow(choice)) {
            for (Line& other : lines) other.is_slow = other.is_slow || other.left.front().info == choice.info;
            continue;
        }
        const auto cost = search.look_at(choice);
        if (cost && line->left.size() > 1)
            *line = {line->left.subspan(1), *cost, line->is_slow};
        else
            lines.erase(line);
    }
    std::optional<FirstAnswer> answer = search.best();
    if (!answer) return answer;
    answer->size    = size_record(coarse.size());
    answer->views   = kFirstViews;
    answer->in_time = lines.empty();
    return answer;
}

std::string first_answer_text(const FirstAnswer& a, const RecommendOptions& options) {
    std::string bounds;
    for (const auto& [metric, bound] : a.bounds)
        bounds += fmt::format("{}{} at most {:.3g}", bounds.empty() ? "" : ", ", metric, bound);
    return fmt::format(
        "Provisional: {}, about {:.3g} ms a frame with {}\n  {}, by {} views of {} x {} pixels{}; the final answer "
        "follows.\n",
        a.method, a.cost, to_text(options.workload), bounds, a.views, *a.size.width, *a.size.height,
        a.in_time ? "" : ", before all settings were looked at");
}

}  // namespace umbra
