#include "umbra/bench/report/report_index.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_text.h"

namespace umbra {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// One cell of the summary: a method on a scene.
json cell_view(const ScenePage& scene, const std::string& id, const std::string& href) {
    const std::vector<Field> methods = scene.root["methods"].items();
    const auto method =
        std::find_if(methods.begin(), methods.end(), [&](const Field& m) { return method_id(m) == id; });
    json view = {{"served", false}, {"unserved", false}, {"absent", method == methods.end()}};
    if (method == methods.end()) return view;
    if (!serves(*method)) {
        view["unserved"] = json{{"why", (*method)["serves"]["why"].text()}, {"href", href + "#not-served"}};
        return view;
    }
    const Totals t      = totals(*method);
    const auto coverage = (*method)["coverage"].number();
    view["served"]      = json{{"coverage", percent(coverage)},
                          {"itself", is_reference(scene.root, *method)},
                          {"partial", coverage && *coverage < 1},
                          {"interior", count(t.interior)},
                          {"wrong", t.interior > 0},
                          {"edge", count(t.edge)},
                          {"mae", score(t.mae)},
                          {"ms", milliseconds(t.object_ms)},
                          {"raw_mae", t.mae ? fmt::format("{}", *t.mae) : ""},
                          {"raw_ms", t.object_ms ? fmt::format("{}", *t.object_ms) : ""},
                          {"raw_coverage", coverage ? fmt::format("{}", *coverage) : ""}};
    return view;
}

}  // namespace

json index_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files, const fs::path& out,
                const std::string& title) {
    json cards = json::array(), columns = json::array(), rows = json::array(), runs = json::array(),
         references                    = json::array();
    const std::vector<std::string> ids = method_ids(scenes);

    for (const std::string& id : ids)
        for (const ScenePage& scene : scenes) {
            const std::vector<Field> methods = scene.root["methods"].items();
            const auto method =
                std::find_if(methods.begin(), methods.end(), [&](const Field& m) { return method_id(m) == id; });
            if (method == methods.end()) continue;
            columns.push_back({{"label", method_label(*method, methods)},
                               {"anchor", fmt::format("method-{}", columns.size() + 1)},
                               {"paper", (*method)["paper"].text()},
                               {"summary", (*method)["summary"].text()},
                               {"name", method_id(*method)}});
            break;
        }
    const auto add_once = [](json& list, json view) {
        if (std::find(list.begin(), list.end(), view) == list.end()) list.push_back(std::move(view));
    };
    // Notes that speak of one scene stand on its page alone.
    const auto add_reference = [](json& list, json view) {
        for (json& known : list)
            if (known["title"] == view["title"] && known["text"] == view["text"] && known["exact"] == view["exact"]) {
                if (known["note"] != view["note"]) known["note"] = "Why, each scene's page says.";
                return;
            }
        list.push_back(std::move(view));
    };
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const ScenePage& scene = scenes[i];
        const std::string href = url((scene.page / "index.html").lexically_relative(out));
        std::vector<std::string> lights;
        for (const Field& light : scene.root["lights"].items())
            lights.push_back(
                fmt::format("{}, {}", kind_in_words(light["kind"].text()), place_in_words(light["place"].text())));
        std::sort(lights.begin(), lights.end());
        lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
        json card         = {{"href", href},
                             {"title", scene.title},
                             {"shows", scene.root["scene"]["shows"].text()},
                             {"lights", fmt::format("{}", fmt::join(lights, "; "))},
                             {"triangles", count(scene.triangles)}};
        card["thumbnail"] = files[i].figure(scene.root["reference"]["files"]["png"], "Reference", "picture", "");
        if (card["thumbnail"].is_object())
            card["thumbnail"]["src"] = files[i].link(scene.root["reference"]["files"]["png"], out);
        json cells = json::array();
        for (const std::string& id : ids) cells.push_back(cell_view(scene, id, href));
        rows.push_back({{"title", scene.title}, {"href", href}, {"cells", std::move(cells)}});
        cards.push_back(std::move(card));
        add_once(runs, run_view(scene.root));
        add_reference(references, reference_view(scene.root));
    }
    return {{"title", title},
            {"legend", class_legend()},
            {"scene_count", std::to_string(scenes.size())},
            {"method_count", std::to_string(ids.size())},
            {"scenes", std::move(cards)},
            {"columns", std::move(columns)},
            {"rows", std::move(rows)},
            {"runs", std::move(runs)},
            {"references", std::move(references)}};
}

}  // namespace umbra
