#include "umbra/bench/report/report_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// One method over lights, or over scenes.
struct Sums {
    double points = 0, undefined = 0, false_shadow = 0, false_light = 0, edge = 0;  ///< false_...: interior
    double squares = 0, errors = 0;                                                 ///< of the points that have figures

    void add(const MethodRecord& method) {
        for (const ErrorRecord& e : method.errors) {
            const auto n = static_cast<double>(e.points.value_or(0));
            points += n, undefined += static_cast<double>(e.undefined);
            false_shadow += wrong_points(e, "false_shadow", "interior").value_or(0);
            false_light += wrong_points(e, "false_light", "interior").value_or(0);
            for (const std::string_view group : kErrorGroups) edge += wrong_points(e, group, "edge").value_or(0);
            squares += e.rmse.value_or(0) * e.rmse.value_or(0) * n, errors += e.bias.value_or(0) * n;
        }
    }
    [[nodiscard]] json cells() const {
        const bool any = points > 0;
        return {{"points", count(points)},
                {"undefined", count(undefined)},
                {"false_shadow", any ? count(false_shadow) : kNone},
                {"false_light", any ? count(false_light) : kNone},
                {"edge", any ? count(edge) : kNone},
                {"any_false_shadow", false_shadow > 0},
                {"any_false_light", false_light > 0},
                {"rmse", score(any ? std::optional(std::sqrt(squares / points)) : std::nullopt)},
                {"bias", score(any ? std::optional(errors / points) : std::nullopt)}};
    }
};

std::optional<double> sum_of(const std::optional<OwnTimesRecord>& own) {
    if (!own) return std::nullopt;
    double sum = 0;
    for (const double ms : {own->build_ms, own->aim_ms, own->look_ms, own->visibility_ms}) sum += known(ms).value_or(0);
    return sum;
}

json row_of(const ScenePage& scene, const MethodRecord& method) {
    json row   = {{"label", method_label(method, scene.results.methods)}};
    row["ran"] = serves(method);
    row["why"] = method.failed ? "Failed: " + method.failed->message : method.serves.why;
    if (!serves(method)) return row;
    Sums sums;
    sums.add(method);
    row.update(sums.cells());
    row["ms"]      = milliseconds(totals(method).object_ms);
    row["own"]     = milliseconds(sum_of(method.own_times));
    row["finding"] = finding_of(method);
    return row;
}

/// "Answers on 9 of 10 scenes. Of 142 909 points, 26 are wrong away from the edges of shadows, ..." of one contender.
std::string finding_over(const Sums& sums, std::size_t served, std::size_t right, std::size_t scenes) {
    std::string text = fmt::format("Answers on {} of {}", served, counted(static_cast<double>(scenes), "scene"));
    if (sums.points == 0) return text + ".";
    const double wrong = sums.false_shadow + sums.false_light;
    return text + fmt::format(
                      ". Of {}, {} {} wrong away from the edges of shadows, and {} at edges. Scenes without a wrong "
                      "point away from edges: {}.",
                      counted(sums.points, "point"), count(wrong), wrong == 1 ? "is" : "are", count(sums.edge), right);
}

}  // namespace

json renderers_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files, const fs::path& out) {
    std::vector<MethodRecord> settings = settings_of(scenes);
    std::erase_if(settings, [](const MethodRecord& m) { return m.outside.empty(); });
    if (settings.empty()) return false;
    json contenders = json::array(), shown = json::array();
    for (const MethodRecord& setting : settings) {
        Sums sums;
        std::size_t served = 0, right = 0, of = 0;
        for (const ScenePage& scene : scenes)
            if (const MethodRecord* method = find_setting(scene.results.methods, setting)) {
                ++of;
                if (!serves(*method)) continue;
                ++served;
                sums.add(*method);
                right += totals(*method).points > 0 && totals(*method).interior == 0 ? 1 : 0;
            }
        std::vector<std::string> parameters;
        for (const auto& [name, value] : setting.parameters) parameters.push_back(name + "=" + text_of(value));
        json row = sums.cells();
        row.update({{"id", fmt::format("contender-{}", contenders.size() + 1)},
                    {"page", "renderers.html"},
                    {"label", method_label(setting, settings)},
                    {"typed", setting_text(setting)},
                    {"kind", setting.outside},
                    {"summary", setting.summary},
                    {"parameters", fmt::format("{}", fmt::join(parameters, ", "))},
                    {"irradiance", setting.measures == "irradiance"},
                    {"scenes", fmt::format("{} of {}", served, of)},
                    {"finding", finding_over(sums, served, right, of)}});
        contenders.push_back(std::move(row));
    }
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        json rows = json::array(), pictures = json::array();
        for (const MethodRecord& method : scenes[i].results.methods) {
            if (method.outside.empty()) continue;
            rows.push_back(row_of(scenes[i], method));
            const Totals found = totals(method);
            if (!serves(method) || found.interior + found.edge == 0) continue;
            if (json view = class_picture_view(files[i], method, rows.back()["label"], out); view.is_object())
                pictures.push_back(std::move(view));
        }
        if (rows.empty()) continue;
        shown.push_back({{"title", scenes[i].title},
                         {"id", fmt::format("scene-{}", shown.size() + 1)},
                         {"href", url((scenes[i].page / "index.html").lexically_relative(out))},
                         {"reference", scenes[i].results.reference.title},
                         {"inexact", !scenes[i].results.reference.exact},
                         {"rows", std::move(rows)},
                         {"pictures", std::move(pictures)}});
    }
    json runs = json::array();
    for (const ScenePage& scene : scenes)
        if (std::ranges::any_of(scene.results.methods, [](const MethodRecord& m) { return !m.outside.empty(); }))
            if (json run = run_view(scene.results.head, scene.results.machine);
                std::ranges::find(runs, run) == runs.end())
                runs.push_back(std::move(run));
    return {{"contenders", std::move(contenders)},
            {"scenes", std::move(shown)},
            {"runs", std::move(runs)},
            {"legend", class_legend()}};
}

}  // namespace umbra
