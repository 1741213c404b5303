#include "umbra/bench/recommend/first_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/record/field.h"
#include "umbra/bench/sweep/bounds.h"

namespace umbra {
namespace {

using Clock = std::chrono::steady_clock;

/// Of n points none of which is wrong, a share of 3 / n may be (upper_share); half of a picture's points may have no
/// surface, or one that faces away from the light.
constexpr double kPoints = 6, kFewestPoints = 14400;

bool depends_on_the_size(const Metric& metric) {
    return metric.name != "rmse" && metric.name != "mae" && metric.name != "image_rmse";
}

/// One search; the clock runs from the start.
class FirstSearch {
public:
    FirstSearch(SceneLab& coarse, SceneLab& whole, const RecommendOptions& options, double seconds)
        : coarse_(coarse),
          whole_(whole),
          options_(options),
          until_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {}

    [[nodiscard]] bool is_over() const { return Clock::now() >= until_; }
    [[nodiscard]] const std::optional<FirstAnswer>& best() const { return best_; }

    /// Each setting costs more than those before it, and errs less.
    void look_at(const Family& family) {
        for (const MethodChoice& choice : family.settings)
            if (is_over() || !is_cheaper(choice) || take_if_within(choice)) return;
    }

private:
    /// One run at few points tells most of those that are dearer.
    [[nodiscard]] bool is_cheaper(const MethodChoice& choice) {
        for (SceneLab* lab : {&coarse_, &whole_}) {
            const std::optional<double> c = cost(*lab, choice);
            if (!c || (best_ && *c >= best_->cost)) return false;
        }
        return true;
    }

    [[nodiscard]] std::optional<double> cost(SceneLab& lab, const MethodChoice& choice) const {
        const std::optional<RunTimes> run = lab.price(choice);
        if (!run) return std::nullopt;
        const auto sum = [](const std::vector<double>& of) { return std::accumulate(of.begin(), of.end(), 0.0); };
        return frame_cost_ms(options_.workload, {run->build, sum(run->aim), run->look, sum(run->visibility)});
    }

    /// Whether it is within the limits; then it is the best so far.
    bool take_if_within(const MethodChoice& choice) {
        std::vector<Json> cells;
        for (int view = 0; view < kFirstViews; ++view) {
            cells.push_back(coarse_.cell(choice, view));
            if (!why_unfit({&cells.back(), 1}).empty()) return false;
            for (const Limit& limit : options_.limits) {
                const auto error = possible_error(*limit.metric, cells.back());
                if (!error || *error > limit.most) return false;
            }
        }
        std::vector<double> bounds;
        for (const Limit& limit : options_.limits) {
            const auto bound = upper_bound(*limit.metric, cells);
            if (!bound || *bound > limit.most) return false;
            bounds.push_back(*bound);
        }
        best_.emplace(FirstAnswer{.choice = choice, .bounds = std::move(bounds), .cost = *cost(whole_, choice)});
        return true;
    }

    SceneLab &coarse_, &whole_;
    const RecommendOptions& options_;
    Clock::time_point until_;
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
    std::vector<Family> all = families(options.choices);
    std::stable_partition(all.begin(), all.end(), [](const Family& f) { return f.settings.front().info->reference; });
    bool in_time = true;
    for (const Family& family : all) {
        if ((in_time = !search.is_over()) == false) break;
        search.look_at(family);
    }
    std::optional<FirstAnswer> answer = search.best();
    if (answer)
        answer->size = coarse.size(), answer->views = kFirstViews, answer->in_time = in_time && !search.is_over();
    return answer;
}

std::string first_answer_text(const FirstAnswer& a, const RecommendOptions& options) {
    std::string bounds;
    for (std::size_t k = 0; k < options.limits.size(); ++k)
        bounds += fmt::format("{}{} at most {:.3g}", k > 0 ? ", " : "", options.limits[k].metric->name, a.bounds[k]);
    return fmt::format(
        "Provisional: {}, about {:.3g} ms a frame with {}\n  {}, by {} views of {} x {} pixels{}; the final answer "
        "follows.\n",
        a.choice.text(), a.cost, to_text(options.workload), bounds, a.views, a.size.width, a.size.height,
        a.in_time ? "" : ", before all settings were looked at");
}

Json first_answer_json(const FirstAnswer& a, const RecommendOptions& options) {
    Json bounds = Json::object();
    for (std::size_t k = 0; k < options.limits.size(); ++k)
        bounds[std::string(options.limits[k].metric->name)] = number(a.bounds[k]);
    return {{"method", a.choice.text()},
            {"cost", number(a.cost)},
            {"bounds", std::move(bounds)},
            {"size", {{"width", a.size.width}, {"height", a.size.height}}},
            {"views", a.views},
            {"in_time", a.in_time}};
}

}  // namespace umbra
