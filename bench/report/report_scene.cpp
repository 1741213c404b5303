#include "umbra/bench/report/report_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/failures.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"
#include "umbra/bench/report/scene_tables.h"

namespace umbra {
namespace {

using nlohmann::json;

/// Why it serves as it does, and which truth it is compared with where that is not the visible area.
std::string reason(const Field& method) {
    std::string why = method["serves"]["why"].text();
    if (method["measures"].text() == "irradiance")
        why += fmt::format(" It measures the irradiance-weighted fraction and is compared with {}.",
                           method["compared_with"].text());
    return why;
}

json parameters(const Field& method) {
    json all = json::array();
    for (const auto& [name, value] : method["parameters"].members())
        all.push_back({{"name", name}, {"value", value.scalar()}});
    return all;
}

std::string percent_words(const Field& method) {
    const auto coverage = method["coverage"].number();
    return coverage && *coverage < 1 ? fmt::format("covers {} %", percent(coverage)) : std::string();
}

/// The wrong points of one light in words, and whether its class picture shows any.
struct WrongInWords {
    std::string text;
    bool any = false;
};
WrongInWords wrong_in_words(const Field& error) {
    const auto n = [&](const Field& field) { return field.number().value_or(0); };
    WrongInWords words;
    words.any = n(error["terminator"]["wrong"]) + n(error["on_boundary"]) > 0;
    std::string special;
    for (const std::string& group : error_groups()) {
        if (!error[group].present()) continue;
        if (!error[group]["interior"].present()) return {"no point is judged", false};
        words.text += fmt::format("{}{} {}", words.text.empty() ? "interior: " : ", ",
                                  count(n(error[group]["interior"])), in_words(group));
        words.any |= n(error[group]["interior"]) + n(error[group]["edge"]) > 0;
        for (const ErrorColour& entry : kErrorPalette)
            if (entry.group == group && !entry.member.empty() && n(error[group][entry.member]) > 0)
                special += fmt::format("{}{} {}", special.empty() ? "" : ", ",
                                       count(error[group][entry.member].number()), in_words(std::string(entry.key)));
    }
    if (!special.empty()) words.text += fmt::format(" ({})", special);
    return words;
}

/// The pictures of S_j, of its difference and of the classes of wrong points: a row per light, a column per method.
json light_views(const SceneFiles& scene, const std::vector<Field>& methods) {
    const Field root = scene.scene().root;
    json all         = json::array();
    for (const Field& light : root["lights"].items()) {
        const std::string name = light["name"].required_text();
        json columns           = json::array();
        json reference =
            scene.figure(root["reference"]["files"]["lights"][name]["visibility"], "Reference", "S of " + name,
                         fmt::format("S_j of {} by the reference: lit points white, umbra black, penumbra grey", name));
        for (const Field& method : methods) {
            if (!serves(method) || is_reference(root, method)) continue;
            const std::string label = method_label(method, methods);
            const Field files       = method["files"]["lights"][name];
            json column             = {{"label", label}, {"coverage", percent_words(method)}};
            column["visibility"] =
                scene.figure(files["visibility"], label, "S of " + name,
                             fmt::format("S_j of {} by {}: lit points white, umbra black, penumbra grey", name, label));
            WrongInWords wrong;
            for (const Field& error : method["errors"].items())
                if (error["light"].text() == name) wrong = wrong_in_words(error);
            column["wrong"] = wrong.text;
            column["difference"] =
                scene.figure(files["difference"], label, "difference of " + name,
                             fmt::format("S_j of {}, {} minus the reference: false shadow blue, false light red; {}",
                                         name, label, wrong.text));
            column["classes"] = false;
            if (wrong.any) {
                column["classes"] = scene.figure(
                    files["classes"], label, "errors of " + name,
                    fmt::format("Classes of the wrong points of {} by {}, in the colours of the legend; {}", name,
                                label, wrong.text));
                // Both pictures show the rings; the caption explains them once.
                if (json rings = scene.rings(files["classes"]); rings.is_object()) {
                    column["rings_words"] = rings["words"];
                    for (const char* picture : {"difference", "classes"})
                        if (column[picture].is_object()) column[picture]["rings"] = rings;
                }
            }
            columns.push_back(std::move(column));
        }
        all.push_back({{"id", fmt::format("light-{}", all.size() + 1)},
                       {"name", name},
                       {"kind", kind_in_words(light["kind"].text())},
                       {"place", place_in_words(light["place"].text())},
                       {"reference", std::move(reference)},
                       {"columns", std::move(columns)}});
    }
    return all;
}

/// At how many points area lights are compared, where the exact reference at all would take too long.
std::string judged_in_words(const Field& root) {
    const Field judged = root["reference"]["judged"];
    if (!judged.present()) return {};
    return fmt::format(
        "An exact reference at every pixel would take too long. Area lights are compared at {} of {} points, one "
        "random "
        "point per tile. The other pixels of the reference picture come from {}: they locate shadow edges but are not "
        "compared.",
        count(judged["points"].number()), count(judged["of"].number()), judged["guess"].text());
}

/// The scene's file; of an absolute path only its name, since a page says nothing of the machine's folders.
std::string source_of(const Field& root) {
    const std::filesystem::path source = root["scene"]["source"].text();
    return (source.is_absolute() ? source.filename() : source).generic_string();
}

std::string size_in_words(const Field& root) {
    const auto w = root["size"]["width"].number(), h = root["size"]["height"].number();
    return w && h ? fmt::format("{:.0f} × {:.0f}", *w, *h) : std::string();
}

}  // namespace

json scene_view(const SceneFiles& scene, const std::vector<Field>& settings) {
    const Field root                 = scene.scene().root;
    const std::vector<Field> methods = root["methods"].items();
    json pictures = json::array(), used = json::array(), unserved = json::array(), image = json::array(),
         files = json::array();
    std::vector<ChartPoint> chart;

    const Field reference = root["reference"];
    if (json f = scene.figure(reference["files"]["png"], "Reference", "picture",
                              fmt::format("{}: shadows by the reference", scene.scene().title));
        f.is_object()) {
        f["note"] = fmt::format("{}: {}", reference_view(root)["title"].get<std::string>(),
                                reference["exact"].flag() ? "exact" : "not exact");
        pictures.push_back(std::move(f));
    }
    if (const json exr = scene.exr(reference["files"]); exr.is_string())
        files.push_back({{"label", "Reference"}, {"href", exr}});

    for (const Field& method : methods) {
        const std::string label = method_label(method, methods);
        const bool served       = serves(method);
        used.push_back({{"label", label},
                        {"how", served           ? method["serves"]["how"].text()
                                : failed(method) ? "failed"
                                                 : "not served"},
                        {"why", reason(method)},
                        {"parameters", parameters(method)}});
        if (!served) {
            unserved.push_back({{"label", label}, {"why", method["serves"]["why"].text()}});
            continue;
        }
        const Totals t           = totals(method);
        const bool itself        = is_reference(root, method);
        const std::string covers = percent_words(method);
        if (t.mae && t.camera_ms && t.object_ms) {
            const auto style = std::find_if(settings.begin(), settings.end(),
                                            [&](const Field& s) { return same_setting(s, method); }) -
                               settings.begin();
            chart.push_back({itself           ? label + " (the reference)"
                             : covers.empty() ? label
                                              : fmt::format("{} ({})", label, covers),
                             *t.camera_ms, *t.object_ms, *t.mae, std::size_t(style)});
        }
        if (const json exr = scene.exr(method["files"]); exr.is_string())
            files.push_back({{"label", label}, {"href", exr}});
        if (itself) continue;
        if (json f = scene.figure(method["files"]["png"], label, "picture",
                                  fmt::format("{}: shadows by {}", scene.scene().title, label));
            f.is_object()) {
            f["note"] = fmt::format(
                "{}, {} ms{}", t.points > 0 ? counted(t.interior, "wrong interior point") : "no point is judged",
                milliseconds(t.object_ms), covers.empty() ? "" : fmt::format("; {}, the rest is drawn lit", covers));
            pictures.push_back(std::move(f));
        }
        const Field scores = method["image"];
        image.push_back(
            {{"label", label},
             {"coverage", percent(method["coverage"].number())},
             {"covers", covers},
             {"rmse", score(scores["rmse"].number())},
             {"psnr", scores["psnr"].present()       ? fmt::format("{:.1f}", *scores["psnr"].number())
                      : scores["rmse"].number() == 0 ? "∞"
                                                     : kNone},
             {"ssim", scores["ssim"].present() ? fmt::format("{:.4f}", *scores["ssim"].number()) : kNone},
             {"flip", score(scores["flip"].number())},
             {"map", scene.figure(method["files"]["flip"], label, "FLIP map",
                                  fmt::format("FLIP map of {}: bright where a viewer notices a difference", label))}});
    }

    json warnings = json::array();
    for (const Field& w : root["scene"]["warnings"].items()) warnings.push_back(w.required_text());
    json view            = {{"title", scene.scene().title},
                            {"shows", root["scene"]["shows"].text()},
                            {"finding", finding(root)},
                            {"pair", slider_view(scene, worst_method(root))},
                            {"source", source_of(root)},
                            {"size", size_in_words(root)},
                            {"warnings", std::move(warnings)},
                            {"pictures", std::move(pictures)},
                            {"lights", light_views(scene, methods)},
                            {"legend", class_legend()},
                            {"errors", error_view(root, methods)},
                            {"causes", cause_view(root, methods)},
                            {"times", time_view(root, methods)},
                            {"has_image", !image.empty()},
                            {"image", std::move(image)},
                            {"methods", std::move(used)},
                            {"has_unserved", !unserved.empty()},
                            {"unserved", std::move(unserved)},
                            {"facts", fact_view(root)},
                            {"reference", reference_view(root)},
                            {"judged", judged_in_words(root)},
                            {"run", run_view(root)},
                            {"files", std::move(files)}};
    view["has_rings"]    = std::any_of(view["lights"].begin(), view["lights"].end(), [](const json& light) {
        return std::any_of(light["columns"].begin(), light["columns"].end(),
                              [](const json& column) { return column.contains("rings_words"); });
    });
    view["failures"]     = scene_failures(root);
    view["has_failures"] = !view["failures"].empty();
    view["has_warnings"] = !view["warnings"].empty();
    view["chart"]        = chart.empty() ? json(false) : error_time_chart(chart);
    return view;
}

}  // namespace umbra
