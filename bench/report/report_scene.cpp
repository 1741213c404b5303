#include "umbra/bench/report/report_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/failures.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/pages/why_point.h"
#include "umbra/bench/report/finding.h"

namespace umbra {
namespace {

using nlohmann::json;

/// Why it serves as it does, and which truth it is compared with where that is not the visible area.
std::string reason(const MethodRecord& method) {
    std::string why = method.serves.why;
    if (method.measures == "irradiance")
        why +=
            fmt::format(" It measures the irradiance-weighted fraction and is compared with {}.", method.compared_with);
    return why;
}

json parameters(const MethodRecord& method) {
    json all = json::array();
    for (const auto& [name, value] : method.parameters) all.push_back({{"name", name}, {"value", text_of(value)}});
    return all;
}

std::string percent_words(const MethodRecord& method) {
    return method.coverage && *method.coverage < 1 ? fmt::format("covers {} %", percent(method.coverage)) : "";
}

/// The wrong points of one light in words, and whether its class picture shows any.
struct WrongInWords {
    std::string text;
    bool any = false;
};
WrongInWords wrong_in_words(const ErrorRecord& error) {
    WrongInWords words;
    words.any = error.terminator.wrong + error.on_boundary > 0;
    std::string special;
    for (const std::string_view group : kErrorGroups) {
        if (group == "false_shadow" ? !error.false_shadow : !error.false_light) continue;
        const auto interior = wrong_points(error, group, "interior");
        if (!interior) return {"no point is judged", false};
        words.text +=
            fmt::format("{}{} {}", words.text.empty() ? "interior: " : ", ", count(interior), in_words(group));
        words.any |= *interior + wrong_points(error, group, "edge").value_or(0) > 0;
        for (const ErrorColour& entry : kErrorPalette)
            if (entry.group == group && !entry.member.empty())
                if (const auto n = wrong_points(error, group, entry.member); n && *n > 0)
                    special += fmt::format("{}{} {}", special.empty() ? "" : ", ", count(n), in_words(entry.key));
    }
    if (!special.empty()) words.text += fmt::format(" ({})", special);
    return words;
}

/// The pictures of S_j, of its difference and of the classes of wrong points: a row per light, a column per method.
json light_views(const SceneFiles& scene) {
    const Results& results = scene.scene().results;
    json all               = json::array();
    for (const LightRecord& light : results.lights) {
        const std::string& name           = light.name;
        json columns                      = json::array();
        const LightFilesRecord* reference = files_of(results.reference.files, name);
        for (const MethodRecord& method : results.methods) {
            if (!serves(method) || is_reference(results, method)) continue;
            const std::string label       = method_label(method, results.methods);
            const LightFilesRecord* found = files_of(method.files, name);
            const LightFilesRecord files  = found != nullptr ? *found : LightFilesRecord{};
            json column                   = {{"label", label}, {"coverage", percent_words(method)}};
            column["visibility"] =
                scene.figure(files.visibility, label, "S of " + name,
                             fmt::format("S_j of {} by {}: lit points white, umbra black, penumbra grey", name, label));
            WrongInWords wrong;
            for (const ErrorRecord& error : method.errors)
                if (error.light == name) wrong = wrong_in_words(error);
            column["wrong"] = wrong.text;
            column["difference"] =
                scene.figure(files.difference, label, "difference of " + name,
                             fmt::format("S_j of {}, {} minus the reference: false shadow blue, false light red; {}",
                                         name, label, wrong.text));
            column["classes"] = false;
            if (wrong.any) {
                column["classes"] = scene.figure(
                    files.classes, label, "errors of " + name,
                    fmt::format("Classes of the wrong points of {} by {}, in the colours of the legend; {}", name,
                                label, wrong.text));
                // Both pictures show the rings; the caption explains them once.
                if (json rings = scene.rings(files.classes); rings.is_object()) {
                    column["rings_words"] = rings["words"];
                    for (const char* picture : {"difference", "classes"})
                        if (column[picture].is_object()) column[picture]["rings"] = rings;
                }
            }
            columns.push_back(std::move(column));
        }
        all.push_back(
            {{"id", fmt::format("light-{}", all.size() + 1)},
             {"name", name},
             {"kind", kind_in_words(light.kind)},
             {"place", place_in_words(light.place)},
             {"reference",
              scene.figure(
                  reference != nullptr ? reference->visibility : FileName{}, "Reference", "S of " + name,
                  fmt::format("S_j of {} by the reference: lit points white, umbra black, penumbra grey", name))},
             {"columns", std::move(columns)}});
    }
    return all;
}

/// An entry for each light and each method with wrong interior points at it: its points, each with a piece of the class
/// picture around it, the reasons and their difference in words.
json why_view(const SceneFiles& scene) {
    const Results& results = scene.scene().results;
    const SizeRecord& size = results.size;
    json all               = json::array();
    if (!size.width || !size.height) return all;
    for (const LightRecord& light : results.lights)
        for (const MethodRecord& method : results.methods)
            for (const ErrorRecord& error : method.errors) {
                const LightFilesRecord* files = files_of(method.files, light.name);
                if (error.light != light.name || error.explained.empty() || files == nullptr) continue;
                const std::string label = method_label(method, results.methods);
                const json picture      = scene.figure(files->classes, label, "errors of " + light.name, "");
                if (!picture.is_object()) continue;
                json points = json::array();
                for (const ExplainedPointRecord& point : error.explained) {
                    if (point.pixel.size() != 2) continue;
                    points.push_back(why_point(point, {picture["src"], label, method.compared_with, size}));
                }
                all.push_back({{"label", label}, {"light", light.name}, {"points", std::move(points)}});
            }
    return all;
}

/// At how many points area lights are compared, where the exact reference at all would take too long.
std::string judged_in_words(const ReferenceRecord& reference) {
    if (!reference.judged) return {};
    return fmt::format(
        "An exact reference at every pixel would take too long. Area lights are compared at {} of {} points, one "
        "random "
        "point per tile. The other pixels of the reference picture come from {}: they locate shadow edges but are not "
        "compared.",
        count(reference.judged->points), count(reference.judged->of), reference.judged->guess);
}

/// The scene's file; of an absolute path only its name, since a page says nothing of the machine's folders.
std::string source_of(const SceneRecord& scene) {
    const std::filesystem::path source = scene.source;
    return (source.is_absolute() ? source.filename() : source).generic_string();
}

std::string size_in_words(const SizeRecord& size) {
    return size.width && size.height ? fmt::format("{} × {}", *size.width, *size.height) : "";
}

}  // namespace

json scene_view(const SceneFiles& scene, const std::vector<MethodRecord>& settings) {
    const Results& results                   = scene.scene().results;
    const std::vector<MethodRecord>& methods = results.methods;
    json pictures = json::array(), used = json::array(), unserved = json::array(), image = json::array(),
         files = json::array();
    std::vector<ChartPoint> chart;

    const ReferenceRecord& reference = results.reference;
    if (json f = scene.figure(picture_of(reference.files), "Reference", "picture",
                              fmt::format("{}: shadows by the reference", scene.scene().title));
        f.is_object()) {
        f["note"] = fmt::format("{}: {}", reference_view(reference)["title"].get<std::string>(),
                                reference.exact ? "exact" : "not exact");
        pictures.push_back(std::move(f));
    }
    if (const json exr = scene.exr(reference.files); exr.is_string())
        files.push_back({{"label", "Reference"}, {"href", exr}});

    for (const MethodRecord& method : methods) {
        const std::string label = method_label(method, methods);
        const bool served       = serves(method);
        used.push_back({{"label", label},
                        {"how", served          ? method.serves.how
                                : method.failed ? "failed"
                                                : "not served"},
                        {"why", reason(method)},
                        {"parameters", parameters(method)}});
        if (!served) {
            unserved.push_back({{"label", label}, {"why", method.serves.why}});
            continue;
        }
        const Totals t           = totals(method);
        const bool itself        = is_reference(results, method);
        const std::string covers = percent_words(method);
        if (t.mae && t.camera_ms && t.object_ms) {
            const auto style = std::find_if(settings.begin(), settings.end(),
                                            [&](const MethodRecord& s) { return same_setting(s, method); }) -
                               settings.begin();
            chart.push_back({itself           ? label + " (the reference)"
                             : covers.empty() ? label
                                              : fmt::format("{} ({})", label, covers),
                             *t.camera_ms, *t.object_ms, *t.mae, std::size_t(style)});
        }
        if (const json exr = scene.exr(method.files); exr.is_string())
            files.push_back({{"label", label}, {"href", exr}});
        if (itself) continue;
        if (json f = scene.figure(picture_of(method.files), label, "picture",
                                  fmt::format("{}: shadows by {}", scene.scene().title, label));
            f.is_object()) {
            f["note"] = fmt::format(
                "{}, {} ms{}", t.points > 0 ? counted(t.interior, "wrong interior point") : "no point is judged",
                milliseconds(t.object_ms), covers.empty() ? "" : fmt::format("; {}, the rest is drawn lit", covers));
            pictures.push_back(std::move(f));
        }
        const ImageRecord scores = method.image.value_or(ImageRecord{});
        image.push_back(
            {{"label", label},
             {"coverage", percent(method.coverage)},
             {"covers", covers},
             {"rmse", score(scores.rmse)},
             {"psnr", scores.psnr        ? fmt::format("{:.1f}", *scores.psnr)
                      : scores.rmse == 0 ? "∞"
                                         : kNone},
             {"ssim", scores.ssim ? fmt::format("{:.4f}", *scores.ssim) : kNone},
             {"flip", score(scores.flip)},
             {"map", scene.figure(method.files ? method.files->flip : FileName{}, label, "FLIP map",
                                  fmt::format("FLIP map of {}: bright where a viewer notices a difference", label))}});
    }

    json view         = {{"title", scene.scene().title},
                         {"shows", results.scene.shows},
                         {"finding", finding(results)},
                         {"pair", slider_view(scene, worst_method(results))},
                         {"values", scene.values(results.values)},
                         {"source", source_of(results.scene)},
                         {"view", std::filesystem::path(results.scene.source).is_absolute() ? results.scene.name
                                                                                            : source_of(results.scene)},
                         {"size", size_in_words(results.size)},
                         {"warnings", results.scene.warnings},
                         {"pictures", std::move(pictures)},
                         {"lights", light_views(scene)},
                         {"why", why_view(scene)},
                         {"legend", class_legend()},
                         {"errors", error_view(results)},
                         {"causes", cause_view(results)},
                         {"times", time_view(results)},
                         {"image", std::move(image)},
                         {"methods", std::move(used)},
                         {"unserved", std::move(unserved)},
                         {"facts", fact_view(results.facts)},
                         {"reference", reference_view(reference)},
                         {"judged", judged_in_words(reference)},
                         {"run", run_view(results.head, results.machine)},
                         {"files", std::move(files)}};
    view["has_rings"] = std::any_of(view["lights"].begin(), view["lights"].end(), [](const json& light) {
        return std::any_of(light["columns"].begin(), light["columns"].end(),
                           [](const json& column) { return column.contains("rings_words"); });
    });
    view["failures"]  = scene_failures(results);
    view["chart"]     = chart.empty() ? json(false) : error_time_chart(chart);
    return view;
}

}  // namespace umbra
