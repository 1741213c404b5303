#include "umbra/bench/trade/trade_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/statistics/pareto.h"

namespace umbra {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Steps of the staircase that one method takes in a row, without the last one where its error is 0.
struct Flight {
    std::string title;
    double to;  ///< the smallest of their errors
};

}  // namespace

bool takes_part(const SweptSetting& s, std::size_t metric) { return s.cost && s.errors[metric] && s.excluded.empty(); }

std::vector<std::size_t> front_of(const SweptScene& scene, std::size_t metric) {
    std::vector<CostError> points;
    std::vector<std::size_t> settings;
    for (std::size_t i = 0; i < scene.settings.size(); ++i) {
        const SweptSetting& s = scene.settings[i];
        if (!takes_part(s, metric)) continue;
        points.push_back({s.cost->median, s.errors[metric]->worst});
        settings.push_back(i);
    }
    std::vector<std::size_t> front;
    for (const std::size_t i : pareto_front(points)) front.push_back(settings[i]);
    return front;
}

std::string staircase_in_words(const SweptScene& scene, std::size_t metric) {
    const std::vector<std::size_t> front = front_of(scene, metric);
    if (front.empty()) return "No setting was both timed and compared.";
    const auto error = [&](std::size_t i) { return scene.settings[i].errors[metric]->worst; };
    const auto cost  = [&](std::size_t i) { return scene.settings[i].cost->median; };

    std::vector<Flight> flights;
    std::optional<std::size_t> before, exact;  // the last step with an error, the first without
    for (const std::size_t i : front) {
        if (error(i) > 0) {
            const std::string& title = scene.settings[i].title;
            if (before && error(i) == error(*before)) {  // the same cost, too
                if (!flights.back().title.ends_with(title)) flights.back().title += " or " + title;
                continue;
            }
            if (flights.empty() || flights.back().title != title) flights.push_back({title, 0});
            flights.back().to = error(i);
            before            = i;
        } else if (!exact) {
            exact = i;
        }
    }
    if (!before) {
        const SweptSetting& s = scene.settings[*exact];
        return fmt::format("{} ({}) is the cheapest and its error is exactly 0.", s.title, s.label);
    }
    std::string words;
    for (const Flight& flight : flights)
        words += fmt::format("{} {}: {}", words.empty() ? "Cheapest down to an error of" : "; below that down to",
                             score(flight.to), flight.title);
    if (!exact) return words + "; no setting has a smaller error.";
    return words + fmt::format("; exactly 0: {}, at {} times the cost of the step before.",
                               scene.settings[*exact].title, score(cost(*exact) / cost(*before)));
}

std::optional<std::size_t> cheapest_within(const SweptScene& scene, std::size_t metric, double error,
                                           const std::string& method) {
    std::optional<std::size_t> cheapest;
    for (std::size_t i = 0; i < scene.settings.size(); ++i) {
        const SweptSetting& s = scene.settings[i];
        if (s.method != method || !takes_part(s, metric) || s.errors[metric]->worst > error) continue;
        if (!cheapest || s.cost->median < scene.settings[*cheapest].cost->median) cheapest = i;
    }
    return cheapest;
}

std::vector<FixedError> at_fixed_errors(const std::vector<SweptScene>& scenes, const std::vector<SweptMethod>& methods,
                                        const std::string& metric, const std::vector<double>& errors) {
    std::vector<FixedError> all;
    for (std::size_t k = 0; k < scenes.size(); ++k) {
        const SweptScene& scene = scenes[k];
        const auto column       = std::find_if(scene.metrics.begin(), scene.metrics.end(),
                                               [&](const SweptMetric& m) { return m.name == metric; });
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
