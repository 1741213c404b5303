#include "umbra/bench/report/report_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/failures.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"

namespace umbra {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// One cell of the summary: a setting on a scene.
json cell_view(const ScenePage& scene, const MethodRecord& setting, const std::string& href) {
    const MethodRecord* method = find_setting(scene.results.methods, setting);
    json view = {{"served", false}, {"unserved", false}, {"failed", false}, {"absent", method == nullptr}};
    if (method == nullptr) return view;
    if (!serves(*method)) {
        view[method->failed ? "failed" : "unserved"] =
            json{{"why", method->serves.why}, {"href", href + "#not-served"}};
        return view;
    }
    const Totals t      = totals(*method);
    const auto coverage = method->coverage;
    view["served"]      = json{{"coverage", percent(coverage)},
                          {"itself", is_reference(scene.results, *method)},
                          {"partial", coverage && *coverage < 1},
                          {"interior", t.points > 0 ? count(t.interior) : "not judged"},
                          {"wrong", t.interior > 0},
                          {"edge", t.points > 0 ? count(t.edge) : kNone},
                          {"mae", score(t.mae)},
                          {"ms", milliseconds(t.object_ms)},
                          {"raw_mae", t.mae ? fmt::format("{}", *t.mae) : ""},
                          {"raw_ms", t.object_ms ? fmt::format("{}", *t.object_ms) : ""},
                          {"raw_interior", t.points > 0 ? fmt::format("{:.0f}", t.interior) : ""},
                          {"raw_coverage", coverage ? fmt::format("{}", *coverage) : ""}};
    return view;
}

/// The noise bar of a scene's times of a full rebuild; infinite of too few rounds, nothing in records of older versions.
std::optional<double> noise_of(const Results& results) {
    if (!results.turns) return std::nullopt;
    return results.turns->noise_bar.value_or(noise_bar({}));
}

bool has_soft_light(const Results& results) {
    return std::ranges::any_of(results.lights, [](const LightRecord& light) {
        return light.kind == "rectangle" || light.kind == "disk" || light.kind == "sphere";
    });
}

/// The first screen: of scenes in soft light that with the most triangles, or else the scene on which a method has the
/// most wrong interior points; its worst method beside the reference, and how wrong it is. The first scene where nothing
/// is wrong; false where none has both pictures.
json front_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files, const fs::path& out) {
    std::optional<std::size_t> shown;
    std::tuple<bool, double, double> most;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const MethodRecord* method = worst_method(scenes[i].results);
        if (method == nullptr || !picture_of(scenes[i].results.reference.files)) continue;
        const double wrong = totals(*method).interior;
        const bool soft    = wrong > 0 && has_soft_light(scenes[i].results);
        const std::tuple rank(soft, soft ? static_cast<double>(scenes[i].triangles) : 0, wrong);
        if (!shown || rank > most) shown = i, most = rank;
    }
    if (!shown) return false;
    const ScenePage& scene = scenes[*shown];
    const auto* method     = worst_method(scene.results);
    json view              = slider_view(files[*shown], method, out);
    view["href"]           = url((scene.page / "index.html").lexically_relative(out));
    view["title"]          = scene.title;
    view["finding"]        = first_finding(scene.results, *method);
    view["classes"] = class_picture_view(files[*shown], *method, method_label(*method, scene.results.methods), out);
    return view;
}

}  // namespace

json index_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files, const fs::path& out,
                const std::string& title) {
    json cards = json::array(), columns = json::array(), rows = json::array(), runs = json::array(),
         references                          = json::array();
    const std::vector<MethodRecord> settings = settings_of(scenes);

    for (const MethodRecord& setting : settings)
        columns.push_back({{"label", method_label(setting, settings)},
                           {"anchor", fmt::format("method-{}", columns.size() + 1)},
                           {"paper", setting.paper},
                           {"summary", setting.summary},
                           {"name", setting_text(setting)}});
    // Notes on one scene are shown on its own page only.
    const auto add_reference = [](json& list, json view) {
        for (json& known : list)
            if (known["title"] == view["title"] && known["text"] == view["text"] && known["exact"] == view["exact"]) {
                if (known["note"] != view["note"]) known["note"] = "The page of each scene says why.";
                return;
            }
        list.push_back(std::move(view));
    };
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const ScenePage& scene = scenes[i];
        const std::string href = url((scene.page / "index.html").lexically_relative(out));
        std::vector<std::string> lights;
        for (const LightRecord& light : scene.results.lights)
            lights.push_back(fmt::format("{}, {}", kind_in_words(light.kind), place_in_words(light.place)));
        std::sort(lights.begin(), lights.end());
        lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
        json card         = {{"href", href},
                             {"title", scene.title},
                             {"shows", scene.results.scene.shows},
                             {"lights", fmt::format("{}", fmt::join(lights, "; "))},
                             {"triangles", count(scene.triangles)}};
        card["thumbnail"] = files[i].figure(picture_of(scene.results.reference.files), "Reference", "picture", "", out);
        const auto noise  = noise_of(scene.results);
        json cells        = json::array();
        for (const MethodRecord& setting : settings) cells.push_back(cell_view(scene, setting, href));
        rows.push_back({{"title", scene.title},
                        {"href", href},
                        {"noise", noise ? fmt::format("{}", *noise) : ""},
                        {"loud", noise && is_too_noisy(*noise)},
                        {"cells", std::move(cells)}});
        cards.push_back(std::move(card));
        add_run(runs, scene.results.head, scene.results.machine);
        add_reference(references, reference_view(scene.results.reference));
    }
    return {{"title", title},
            {"legend", class_legend()},
            {"front", front_view(scenes, files, out)},
            {"scene_count", counted(double(scenes.size()), "scene")},
            {"method_count", counted(double(settings.size()), "shadow method")},
            {"scenes", std::move(cards)},
            {"columns", std::move(columns)},
            {"rows", std::move(rows)},
            {"runs", std::move(runs)},
            {"references", std::move(references)}};
}

}  // namespace umbra
