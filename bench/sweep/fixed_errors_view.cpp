#include "umbra/bench/sweep/trade_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "umbra/bench/base/profile.h"
#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/chart_parts.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/sweep/trade_chart.h"
#include "umbra/bench/sweep/trade_findings.h"

namespace umbra {
namespace {

using nlohmann::json;

const std::vector<double> kErrors = {0.1, 0.03, 0.01, 0.003, 0.001, 0};

std::string error_in_words(double error) { return error > 0 ? fmt::format("{:g}", error) : "exactly 0"; }

/// Whether a method's cost is the least, as far as the noise bar tells.
bool is_least(const SweptScene& scene, const FixedError& problem, std::size_t method) {
    return !costs_more(scene, problem.costs[method], problem.least);
}

/// The coverage of the settings of a method that are within an error, but leave points without an answer and are
/// therefore not ranked: the largest. Nothing where there is none.
std::optional<double> left_out(const SweptScene& scene, const std::string& metric, double error,
                               const std::string& method) {
    std::optional<double> most;
    for (std::size_t m = 0; m < scene.metrics.size(); ++m)
        for (const SweptSetting& s : scene.settings) {
            const bool within =
                scene.metrics[m].name == metric && s.name == method && s.errors[m] && s.errors[m]->worst <= error;
            if (within && s.excluded && s.coverage && *s.coverage < 1) most = std::max(most.value_or(0), *s.coverage);
        }
    return most;
}

json cell_view(const SweptScene& scene, const FixedError& problem, std::size_t method,
               std::optional<double> not_ranked) {
    if (!problem.cheapest[method])
        return {{"none", true}, {"covers", not_ranked ? fmt::format("covers {} %", percent(not_ranked)) : ""}};
    const SweptSetting& s = scene.settings[*problem.cheapest[method]];
    return {{"ratio", score(problem.costs[method] / problem.least)},
            {"best", is_least(scene, problem, method)},
            {"label", s.label},
            {"ms", milliseconds(s.cost->median)}};
}

/// Over the scenes in which the method has a setting within the error, of those in which any method has one.
json mean_view(const std::vector<FixedError>& problems, double error, std::size_t method) {
    std::vector<double> ratios;
    std::size_t solved = 0;
    for (const FixedError& problem : problems) {
        if (problem.error != error || !std::isfinite(problem.least)) continue;
        ++solved;
        if (problem.cheapest[method]) ratios.push_back(problem.costs[method] / problem.least);
    }
    if (ratios.empty()) return {{"none", true}, {"covers", ""}};
    return {{"ratio", score(geometric_mean(ratios))},
            {"of", fmt::format("{} of {}", ratios.size(), counted(double(solved), "scene"))}};
}

json profile_view(const std::vector<SweptScene>& scenes, const std::vector<FixedError>& problems,
                  const std::vector<SweptMethod>& methods) {
    std::vector<std::vector<double>> costs(methods.size());
    for (const FixedError& problem : problems)
        for (std::size_t m = 0; m < methods.size(); ++m)
            costs[m].push_back(is_least(scenes[problem.scene], problem, m) ? problem.least : problem.costs[m]);
    const PerformanceProfile profile(costs);
    std::vector<ProfileCurve> curves;
    for (std::size_t m = 0; m < methods.size(); ++m) {
        ProfileCurve curve{methods[m].title, m, {{1, profile.fraction(m, 1)}}};
        for (const double ratio : profile.ratios(m))
            if (std::isfinite(ratio) && ratio > curve.steps.back().first)
                curve.steps.emplace_back(ratio, profile.fraction(m, ratio));
        if (curve.steps.back().second > 0) curves.push_back(std::move(curve));
    }
    json view        = profile_chart(curves);
    view["problems"] = counted(double(profile.problems()), "problem");
    return view;
}

}  // namespace

json fixed_errors_view(const std::vector<SweptScene>& scenes, const std::vector<SweptMethod>& methods) {
    if (scenes.empty() || scenes[0].metrics.empty()) return false;
    const SweptMetric& metric        = scenes[0].metrics[0];
    std::vector<FixedError> problems = at_fixed_errors(scenes, methods, metric.name, kErrors);
    std::erase_if(problems, [&](const FixedError& p) { return is_loud(scenes[p.scene]); });
    std::string loud;
    for (const SweptScene& scene : scenes)
        if (is_loud(scene)) loud += (loud.empty() ? "" : ", ") + scene.title;
    if (std::ranges::none_of(problems, [](const FixedError& p) { return std::isfinite(p.least); })) return false;

    json columns = json::array(), groups = json::array(), means = json::array();
    for (std::size_t m = 0; m < methods.size(); ++m)
        columns.push_back({{"label", methods[m].title},
                           {"colour", std::to_string(mark_style(m).colour)},
                           {"key", chart::mark_path(m, 14, 9)}});
    for (std::size_t k = 0; k < scenes.size(); ++k) {
        json rows = json::array();
        for (const FixedError& problem : problems) {
            if (problem.scene != k) continue;
            json cells = json::array();
            for (std::size_t m = 0; m < methods.size(); ++m)
                cells.push_back(
                    cell_view(scenes[k], problem, m, left_out(scenes[k], metric.name, problem.error, methods[m].name)));
            rows.push_back({{"error", error_in_words(problem.error)}, {"cells", std::move(cells)}});
        }
        if (!rows.empty()) groups.push_back({{"scene", scenes[k].title}, {"rows", std::move(rows)}});
    }
    for (const double error : kErrors) {
        json cells = json::array();
        for (std::size_t m = 0; m < methods.size(); ++m) cells.push_back(mean_view(problems, error, m));
        means.push_back({{"error", error_in_words(error)}, {"cells", std::move(cells)}});
    }
    return {{"metric", metric.title},
            {"all_columns", std::to_string(methods.size() + 1)},
            {"columns", std::move(columns)},
            {"groups", std::move(groups)},
            {"means", std::move(means)},
            {"profile", profile_view(scenes, problems, methods)},
            {"loud", loud}};
}

}  // namespace umbra
