#include "umbra/bench/sweep/trade_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "umbra/bench/pages/chart_parts.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/sweep/trade_chart.h"
#include "umbra/bench/sweep/trade_findings.h"

namespace umbra {
namespace {

using nlohmann::json;

/// The number of a setting on a front, from 1; 0 where it is not on it.
std::size_t number_on(const std::vector<std::size_t>& front, std::size_t setting) {
    const auto at = std::find(front.begin(), front.end(), setting);
    return at == front.end() ? 0 : 1 + std::size_t(at - front.begin());
}

/// The error of the worst view: "≥ 8.00" where it may be more.
std::string worst_in_words(const SweptError& e) { return (e.at_least ? "≥ " : "") + score(e.worst); }

std::string range(double low, double high) { return fmt::format("{}–{}", milliseconds(low), milliseconds(high)); }

/// A plot of one metric with its front as a list; false where no setting was both timed and compared.
json plot_view(const SweptScene& scene, const std::vector<SweptMethod>& methods, std::size_t metric,
               const std::vector<std::size_t>& front) {
    std::vector<ParetoPoint> points;
    bool errs = false;
    for (std::size_t i = 0; i < scene.settings.size(); ++i) {
        const SweptSetting& s = scene.settings[i];
        if (!takes_part(s, metric)) continue;
        const SweptError& e = *s.errors[metric];
        errs                = errs || e.worst > 0;
        points.push_back({fmt::format("{}: {} ms, {}", s.text, milliseconds(s.cost->median), worst_in_words(e)),
                          *s.cost, e, index_of(methods, s.name), number_on(front, i)});
    }
    const SweptMetric& m = scene.metrics[metric];
    json view            = {{"title", m.title},
                            {"doc", m.doc},
                            {"finding", staircase_in_words(scene, metric)},
                            {"chart", false},
                            {"steps", json::array()}};
    if (!errs) return view;  // a chart of nothing but zeros shows what the sentence says
    view["chart"]          = pareto_chart(points);
    view["chart"]["title"] = m.title;
    for (const std::size_t i : front) {
        const SweptSetting& s = scene.settings[i];
        view["steps"].push_back({{"title", s.title},
                                 {"label", s.label},
                                 {"colour", std::to_string(mark_style(index_of(methods, s.name)).colour)},
                                 {"error", worst_in_words(*s.errors[metric])},
                                 {"ms", milliseconds(s.cost->median)}});
    }
    return view;
}

json legend_of(const SweptScene& scene, const std::vector<SweptMethod>& methods) {
    json legend = json::array();
    for (std::size_t k = 0; k < methods.size(); ++k)
        if (is_timed_on(scene, methods[k]))
            legend.push_back({{"label", methods[k].title},
                              {"colour", std::to_string(mark_style(k).colour)},
                              {"key", chart::mark_path(k, 14, 9)}});
    return legend;
}

/// A row of the table of all settings.
json row_view(const SweptScene& scene, const std::vector<SweptMethod>& methods, std::size_t i,
              const std::vector<std::vector<std::size_t>>& fronts) {
    const SweptSetting& s = scene.settings[i];
    const std::size_t k   = index_of(methods, s.name);
    json row              = {{"text", s.text},
                             {"preset", s.preset.value_or("")},
                             {"colour", std::to_string(mark_style(k).colour)},
                             {"key", chart::mark_path(k, 14, 9)},
                             {"note", s.note.empty() ? s.excluded.value_or("") : s.note},
                             {"failed", s.failed.has_value()},
                             {"cost", s.cost ? milliseconds(s.cost->median) : kNone},
                             {"range", s.cost && s.cost->low < s.cost->high ? range(s.cost->low, s.cost->high) : ""},
                             {"memory", mebibytes(s.memory_bytes)},
                             {"coverage", percent(s.coverage)},
                             {"partial", s.note.empty() && s.excluded},
                             {"errors", json::array()}};
    for (std::size_t m = 0; m < scene.metrics.size(); ++m) {
        const auto& e            = s.errors[m];
        const std::size_t number = number_on(fronts[m], i);
        row["errors"].push_back({{"worst", e ? worst_in_words(*e) : kNone},
                                 {"bound", score(e ? e->bound : std::nullopt)},
                                 {"front", number > 0 ? std::to_string(number) : ""}});
    }
    return row;
}

std::string times_a_second(double n) {
    return n == 0 ? "never" : n == 1 ? "once a second" : fmt::format("{:g} times a second", n);
}

}  // namespace

json swept_scene_view(const SweptScene& scene, const std::vector<SweptMethod>& methods, const std::string& id) {
    std::vector<std::vector<std::size_t>> fronts;
    json plots = json::array(), columns = json::array();
    for (std::size_t m = 0; m < scene.metrics.size(); ++m) {
        fronts.push_back(front_of(scene, m));
        plots.push_back(plot_view(scene, methods, m, fronts.back()));
        columns.push_back(scene.metrics[m].title);
    }
    std::vector<std::size_t> order(scene.settings.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const auto &x = scene.settings[a].cost, &y = scene.settings[b].cost;
        return x && y ? x->median < y->median : x.has_value() && !y;
    });
    json rows = json::array();
    for (const std::size_t i : order) rows.push_back(row_view(scene, methods, i, fronts));
    return {{"id", id},
            {"title", scene.title},
            {"finding", scene.metrics.empty() ? "No metric was swept." : staircase_in_words(scene, 0)},
            {"metric", scene.metrics.empty() ? "" : scene.metrics[0].title},
            {"triangles", count(scene.triangles)},
            {"views", counted(scene.views, "view")},
            {"settings", counted(double(scene.settings.size()), "setting")},
            {"workload",
             fmt::format("The camera moves {}, a light {}, an object {}.", times_a_second(scene.workload.camera),
                         times_a_second(scene.workload.light), times_a_second(scene.workload.object))},
            {"noise_bar", scene.noise_bar && std::isfinite(*scene.noise_bar)
                              ? fmt::format("{:.0f}", std::ceil(100 * *scene.noise_bar))
                              : ""},
            {"loud", is_loud(scene)},
            {"legend", legend_of(scene, methods)},
            {"plots", std::move(plots)},
            {"columns", std::move(columns)},
            {"rows", std::move(rows)}};
}

}  // namespace umbra
