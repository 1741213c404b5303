#include "umbra/bench/sweep/trade_findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "umbra/bench/base/pareto.h"
#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Steps of the staircase that one method takes in a row, without the last one where its error is 0.
struct Flight {
    std::string title;
    double to     = 0;                    ///< the smallest of their errors
    bool at_least = false;                ///< it may be more
    std::vector<std::string> as_cheap{};  ///< other methods that are as cheap within one of these errors
};

/// Adds the titles of other methods with a setting that errs no more than setting `i` and does not cost more.
void add_as_cheap(const SweptScene& scene, std::size_t metric, std::size_t i, std::vector<std::string>& titles) {
    const SweptSetting& step = scene.settings[i];
    for (const SweptSetting& s : scene.settings) {
        if (s.name == step.name || !takes_part(s, metric)) continue;
        if (s.errors[metric]->worst > step.errors[metric]->worst ||
            costs_more(scene, s.cost->median, step.cost->median))
            continue;
        if (std::find(titles.begin(), titles.end(), s.title) == titles.end()) titles.push_back(s.title);
    }
}

/// The cheapest setting of `method` whose error is at most `error` in every view; nothing where none is.
std::optional<std::size_t> cheapest_within(const SweptScene& scene, std::size_t metric, double error,
                                           const std::string& method) {
    std::optional<std::size_t> cheapest;
    for (std::size_t i = 0; i < scene.settings.size(); ++i) {
        const SweptSetting& s = scene.settings[i];
        if (s.name != method || !takes_part(s, metric) || s.errors[metric]->worst > error) continue;
        if (!cheapest || s.cost->median < scene.settings[*cheapest].cost->median) cheapest = i;
    }
    return cheapest;
}

std::string as_cheap_in_words(const std::vector<std::string>& titles) {
    return titles.empty() ? "" : fmt::format(" (as cheap, as far as noise tells: {})", fmt::join(titles, ", "));
}

}  // namespace

bool takes_part(const SweptSetting& s, std::size_t metric) { return s.cost && s.errors[metric] && !s.excluded; }

bool is_loud(const SweptScene& scene) { return is_too_noisy(scene.noise_bar.value_or(0)); }

bool costs_more(const SweptScene& scene, double dearer, double cheaper) {
    return is_dearer(dearer, cheaper, scene.noise_bar.value_or(0));
}

std::vector<std::size_t> front_of(const SweptScene& scene, std::size_t metric) {
    if (is_loud(scene)) return {};
    std::vector<CostError> points;
    for (const SweptSetting& s : scene.settings)
        points.push_back(takes_part(s, metric) ? CostError{s.cost->median, s.errors[metric]->worst}
                                               : CostError{kNever, kNever});  // not finite: on no front
    return pareto_front(points);
}

std::string staircase_in_words(const SweptScene& scene, std::size_t metric) {
    if (is_loud(scene))
        return fmt::format(
            "Not ranked: times vary by more than {} %, or are of fewer than six rounds: too much to say which setting is "
            "the cheapest.",
            percent(kMostNoise));
    const std::vector<std::size_t> front = front_of(scene, metric);
    if (front.empty()) return "No setting was both timed and compared.";
    const auto error = [&](std::size_t i) { return scene.settings[i].errors[metric]->worst; };
    const auto cost  = [&](std::size_t i) { return scene.settings[i].cost->median; };

    std::vector<Flight> flights;
    std::optional<std::size_t> before, exact;  // the last step with an error, the first without
    for (const std::size_t i : front) {
        if (error(i) > 0) {
            const std::string& title = scene.settings[i].title;
            if (before && error(i) == error(*before)) continue;  // as cheap, too
            if (flights.empty() || flights.back().title != title) flights.push_back({title});
            flights.back().to       = error(i);
            flights.back().at_least = scene.settings[i].errors[metric]->at_least;
            add_as_cheap(scene, metric, i, flights.back().as_cheap);
            before = i;
        } else if (!exact) {
            exact = i;
        }
    }
    std::vector<std::string> as_cheap;  // as the first without an error
    if (exact) add_as_cheap(scene, metric, *exact, as_cheap);
    if (!before) {
        const SweptSetting& s = scene.settings[*exact];
        return fmt::format("{} ({}){} is the cheapest and its error is exactly 0.", s.title, s.label,
                           as_cheap_in_words(as_cheap));
    }
    std::string words;
    for (const Flight& flight : flights)
        words += fmt::format("{} {}{}: {}{}", words.empty() ? "Cheapest down to an error of" : "; below that down to",
                             flight.at_least ? "at least " : "", score(flight.to), flight.title,
                             as_cheap_in_words(flight.as_cheap));
    if (!exact) return words + "; no setting has a smaller error.";
    return words +
           fmt::format("; exactly 0: {}{}, {}.", scene.settings[*exact].title, as_cheap_in_words(as_cheap),
                       costs_more(scene, cost(*exact), cost(*before))
                           ? fmt::format("at {} times the cost of the step before", score(cost(*exact) / cost(*before)))
                           : "at a cost that noise does not tell from that of the step before");
}

std::vector<FixedError> at_fixed_errors(const std::vector<SweptScene>& scenes, const std::vector<SweptMethod>& methods,
                                        const std::string& metric, const std::vector<double>& errors) {
    std::vector<FixedError> all;
    for (std::size_t k = 0; k < scenes.size(); ++k) {
        const SweptScene& scene = scenes[k];
        const auto column       = std::ranges::find(scene.metrics, metric, &SweptMetric::name);
        if (column == scene.metrics.end()) continue;
        for (const double error : errors) {
            FixedError row{k, error, {}, {}, kNever};
            for (const SweptMethod& method : methods) {
                row.cheapest.push_back(
                    cheapest_within(scene, std::size_t(column - scene.metrics.begin()), error, method.name));
                row.costs.push_back(row.cheapest.back() ? scene.settings[*row.cheapest.back()].cost->median : kNever);
                row.least = std::min(row.least, row.costs.back());
            }
            all.push_back(std::move(row));
        }
    }
    return all;
}

}  // namespace umbra
