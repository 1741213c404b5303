#include "umbra/bench/sweep/sweep_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/statistics/pareto.h"
#include "umbra/bench/statistics/statistics.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/metrics.h"

namespace umbra {
namespace {

Json optional_number(const std::optional<double>& value) { return value ? number(*value) : Json(); }

Json view_json(const Json& cell) {
    Json metrics_here = Json::object(), at_least = Json::array();
    for (const Metric& m : metrics()) {
        metrics_here[std::string(m.name)] = optional_number(metric_value(m, cell));
        if (is_at_least(m, cell)) at_least.push_back(std::string(m.name));
    }
    Json view = {{"view", cell.at("view")}, {"metrics", std::move(metrics_here)}};
    if (!at_least.empty()) view["at_least"] = std::move(at_least);
    for (const char* member : {"errors", "image"})
        if (cell.contains(member)) view[member] = cell.at(member);
    return view;
}

std::optional<double> worst_of(const Metric& metric, std::span<const Json> views) {
    std::optional<double> worst;
    for (const Json& cell : views) {
        const auto value = metric_value(metric, cell);
        if (!value) return std::nullopt;
        worst = std::max(worst.value_or(*value), *value);
    }
    return worst;
}

Json setting_entry(const MeasuredSetting& s, const Workload& workload) {
    const Json& cell  = s.views.front();
    const auto preset = preset_of(s.choice);
    std::string why   = why_unfit(s.views);
    if (why.empty() && s.times.is_null()) why = "it was not timed";
    Json entry;
    for (const char* member : {"text", "name", "title"}) entry[member] = cell.at(member);
    entry["preset"] = preset.empty() ? Json() : Json(preset);
    for (const char* member :
         {"parameters", "serves", "failed", "measures", "compared_with", "memory_bytes", "points_bytes", "coverage"})
        if (cell.contains(member)) entry[member] = cell.at(member);
    // As the errors, of the worst view.
    if (entry.contains("coverage") && entry["coverage"].is_number()) entry["coverage"] = 1 - most_undefined(s.views);
    entry["excluded"] = why.empty() ? Json() : Json(why);
    entry["views"]    = Json::array();
    for (const Json& view : s.views) entry["views"].push_back(view_json(view));
    entry["values"] = Json::object();
    entry["bounds"] = Json::object();
    for (const Metric& m : metrics()) {
        entry["values"][std::string(m.name)] = optional_number(worst_of(m, s.views));
        entry["bounds"][std::string(m.name)] = optional_number(upper_bound(m, s.views));
    }
    if (!s.times.is_null()) entry["times"] = s.times;
    entry["cost_ms"] = optional_number(cost_of(s.times, workload));
    return entry;
}

}  // namespace

std::optional<double> cost_of(const Json& times, const Workload& workload) {
    if (times.is_null()) return std::nullopt;
    const auto phase = [&](const char* name) { return times.at(name).at("median").get<double>(); };
    return frame_cost_ms(workload, {phase("build_ms"), phase("aim_ms"), phase("look_ms"), phase("visibility_ms")});
}

Json sweep_json(std::span<const MeasuredSetting> settings, int views, const Workload& workload, const Json& turns) {
    Json record = {{"views", views},
                   {"metrics", to_record(metric_records())},
                   {"turns", turns},
                   {"workload", {{"camera", workload.camera}, {"light", workload.light}, {"object", workload.object}}},
                   {"settings", Json::array()},
                   {"fronts", Json::object()}};
    for (const MeasuredSetting& s : settings) record["settings"].push_back(setting_entry(s, workload));
    for (const Metric& m : metrics()) {
        const std::string name(m.name);
        std::vector<CostError> points;
        std::vector<std::string> texts;
        for (const Json& entry : record["settings"]) {
            if (!entry["excluded"].is_null() || !entry["cost_ms"].is_number() || !entry["values"][name].is_number())
                continue;
            points.push_back({entry["cost_ms"], entry["values"][name]});
            texts.push_back(entry["text"]);
        }
        Json front = Json::array();
        for (const std::size_t i : pareto_front(points)) front.push_back(texts[i]);
        record["fronts"][name] = std::move(front);
    }
    return record;
}

std::string front_in_words(const Json& record) {
    const Json &sweep = record["sweep"], &turns = sweep["turns"];
    // Without times nothing is ranked by them; of too few rounds nobody knows how far they vary.
    const double bar       = !turns.is_object()               ? 0
                             : turns["noise_bar"].is_number() ? turns["noise_bar"].get<double>()
                                                              : noise_bar({});
    const std::string what = record["scene"]["name"].get<std::string>() +
                             ": cost of a frame, S_j error (rmse), its upper bound; ",
                      vary = fmt::format("{:.0f} %", std::ceil(100 * bar));
    std::vector<std::string> texts;
    if (is_too_noisy(bar)) {
        for (const Json& s : sweep["settings"])
            if (s["excluded"].is_null() && s["cost_ms"].is_number() && s["values"]["rmse"].is_number())
                texts.push_back(s["text"]);
    } else {
        for (const Json& text : sweep["fronts"]["rmse"]) texts.push_back(text);
    }
    std::string words =
        what + (is_too_noisy(bar) ? (std::isfinite(bar) ? "not ranked, as times vary by " + vary + ":\n"
                                                        : "not ranked, as times are of fewer than six rounds:\n")
                : bar > 0         ? "settings that no other beats in both, costs that differ by less than " + vary +
                                " are not told apart:\n"
                          : "settings that no other beats in both:\n");
    for (const std::string& text : texts) {
        const Json& s =
            *std::ranges::find(sweep["settings"], text, [](const Json& of) { return of["text"].get<std::string>(); });
        const Json& bound = s["bounds"]["rmse"];
        words += fmt::format("  {:>9.3f} ms  {:<9.3g}  {:<9}  {}\n", s["cost_ms"].get<double>(),
                             s["values"]["rmse"].get<double>(),
                             bound.is_number() ? fmt::format("{:.3g}", bound.get<double>()) : "-", text);
    }
    return words;
}

}  // namespace umbra
