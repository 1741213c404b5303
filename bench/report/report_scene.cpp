#include "umbra/bench/report/report_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

json parameters(const Field& method) {
    json all = json::array();
    for (const auto& [name, value] : method["parameters"].members())
        all.push_back({{"name", name}, {"value", value.scalar()}});
    return all;
}

json timing(const Field& time) {
    const auto median = time["median"].number(), min = time["min"].number(), max = time["max"].number();
    json view = {{"median", milliseconds(median)}, {"range", false}};
    if (median && min && max && *min != *max)
        view["range"] = fmt::format("{}–{}", milliseconds(min), milliseconds(max));
    return view;
}

std::string percent_words(const Field& method) {
    const auto coverage = method["coverage"].number();
    return coverage && *coverage < 1 ? fmt::format("covers {} %", percent(coverage)) : std::string();
}

/// What is wrong in one light's plane, in words, and whether there is anything to see on its class picture.
struct WrongInWords {
    std::string text;
    bool any = false;
};
WrongInWords wrong_in_words(const Field& error) {
    const auto n       = [&](const Field& field) { return field.number().value_or(0); };
    const Field shadow = error["false_shadow"], lit = error["false_light"];
    const double interior_shadow = n(shadow["interior"]), interior_light = n(lit["interior"]);
    const double edge = n(shadow["edge"]) + n(lit["edge"]), terminator = n(error["terminator"]["wrong"]);
    WrongInWords words{
        fmt::format("interior: {} false shadow, {} false light", count(interior_shadow), count(interior_light)),
        interior_shadow + interior_light + edge + terminator + n(error["on_boundary"]) > 0};
    std::string causes;
    for (const auto& [key, field] :
         {std::pair{"acne", shadow["acne"]}, {"detachment", lit["detachment"]}, {"leak", lit["leak"]}})
        if (n(field) > 0) causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", count(field.number()), key);
    if (!causes.empty()) words.text += fmt::format(" ({})", causes);
    return words;
}

/// The pictures of S_j, of its difference and of the classes of errors, one row a light, one column a method.
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
                             fmt::format("S_j of {}, {} less the reference: false shadow blue, false light red; {}",
                                         name, label, wrong.text));
            column["classes"] =
                wrong.any
                    ? scene.figure(files["classes"], label, "errors of " + name,
                                   fmt::format("What the wrong points of {} by {} are, by colour as in the legend; {}",
                                               name, label, wrong.text))
                    : json(false);
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

/// The table of errors: a group of rows a light. Columns that no method fills are left out.
json error_view(const Field& root, const std::vector<Field>& methods) {
    json groups   = json::array();
    bool has_acne = false, has_detachment = false, has_leak = false;
    for (const Field& light : root["lights"].items()) {
        const std::string name = light["name"].required_text();
        json rows              = json::array();
        for (const Field& method : methods) {
            if (is_reference(root, method)) continue;
            for (const Field& e : method["errors"].items()) {
                if (e["light"].required_text() != name) continue;
                const Field shadow = e["false_shadow"], lit = e["false_light"];
                has_acne |= shadow["acne"].present();
                has_detachment |= lit["detachment"].present();
                has_leak |= lit["leak"].present();
                const auto wrong = [](std::optional<double> n) {
                    return json{{"n", count(n)}, {"wrong", n && *n > 0}};
                };
                rows.push_back({{"label", method_label(method, methods)},
                                {"coverage", percent(method["coverage"].number())},
                                {"points", count(e["points"].number())},
                                {"undefined", count(e["undefined"].number())},
                                {"on_boundary", count(e["on_boundary"].number())},
                                {"away", count(e["away"].number())},
                                {"lit", count(e["lit"].number())},
                                {"umbra", count(e["umbra"].number())},
                                {"penumbra", count(e["penumbra"].number())},
                                {"shadow_interior", wrong(shadow["interior"].number())},
                                {"shadow_edge", count(shadow["edge"].number())},
                                {"acne", count(shadow["acne"].number())},
                                {"light_interior", wrong(lit["interior"].number())},
                                {"light_edge", count(lit["edge"].number())},
                                {"detachment", count(lit["detachment"].number())},
                                {"leak", count(lit["leak"].number())},
                                {"mae", score(e["mae"].number())},
                                {"rmse", score(e["rmse"].number())},
                                {"max", score(e["max"].number())},
                                {"bias", score(e["bias"].number())}});
            }
        }
        if (!rows.empty()) groups.push_back({{"light", name}, {"rows", std::move(rows)}});
    }
    return {{"groups", std::move(groups)},
            {"has_acne", has_acne},
            {"has_detachment", has_detachment},
            {"has_leak", has_leak},
            {"shadow_columns", std::to_string(2 + has_acne)},
            {"light_columns", std::to_string(2 + has_detachment + has_leak)},
            {"all_columns", std::to_string(11 + has_acne + has_detachment + has_leak)}};
}

/// Where errors come from: a row a method and light that has something to tell.
json cause_view(const Field& root, const std::vector<Field>& methods) {
    json groups = json::array();
    for (const Field& light : root["lights"].items()) {
        const std::string name = light["name"].required_text();
        json rows              = json::array();
        for (const Field& method : methods) {
            if (is_reference(root, method)) continue;
            for (const Field& e : method["errors"].items()) {
                if (e["light"].required_text() != name) continue;
                const Field off = e["edge_displacement_px"], width = e["penumbra_width_px"], noise = e["noise"],
                            interior = e["interior"], terminator = e["terminator"];
                rows.push_back({{"label", method_label(method, methods)},
                                {"wrong_lit", count(interior["lit"].number())},
                                {"wrong_penumbra", count(interior["penumbra"].number())},
                                {"wrong_umbra", count(interior["umbra"].number())},
                                {"terminator_facet", count(terminator["facet_away"].number())},
                                {"terminator_normal", count(terminator["normal_away"].number())},
                                {"terminator_wrong", count(terminator["wrong"].number())},
                                {"off_mean", score(off["mean"].number())},
                                {"off_p95", score(off["p95"].number())},
                                {"off_max", score(off["max"].number())},
                                {"width", score(width["method"].number())},
                                {"width_reference", score(width["reference"].number())},
                                {"noise", score(noise["noise_rmse"].number())},
                                {"noise_bias", score(noise["bias_rmse"].number())},
                                {"bracket", score(e["bracket"]["max_half_width"].number())}});
            }
        }
        if (!rows.empty()) groups.push_back({{"light", name}, {"rows", std::move(rows)}});
    }
    return {{"groups", std::move(groups)}};
}

json time_view(const Field& root, const std::vector<Field>& methods) {
    json rows = json::array(), by_light = json::array(), shared = json::array();
    for (const Field& method : methods) {
        if (!serves(method)) continue;
        const Totals t    = totals(method);
        const Field times = method["times"];
        rows.push_back({{"label", method_label(method, methods)},
                        {"build", timing(times["build_ms"])},
                        {"aim", timing(times["aim_ms"])},
                        {"visibility", timing(times["visibility_ms"])},
                        {"object", milliseconds(t.object_ms)},
                        {"light", milliseconds(t.light_ms)},
                        {"camera", milliseconds(t.camera_ms)},
                        {"memory", mebibytes(method["memory_bytes"].number())}});
        for (const Field& light : method["light_times"].items())
            by_light.push_back({{"label", method_label(method, methods)},
                                {"light", light["light"].required_text()},
                                {"aim", timing(light["aim_ms"])},
                                {"visibility", timing(light["visibility_ms"])}});
    }
    for (const auto& [key, name] : {std::pair{"load_ms", "reading the scene"},
                                    {"facts_ms", "finding its facts"},
                                    {"rays_build_ms", "the ray tracer's tree"},
                                    {"gbuffer_ms", "the points that the camera sees"},
                                    {"shade_ms", "the sum, once"}})
        if (const auto ms = root["times"][key].number()) shared.push_back({{"name", name}, {"ms", score(ms)}});
    const bool several = root["lights"].items().size() > 1 && !by_light.empty();
    return {{"rows", std::move(rows)},
            {"several_lights", several},
            {"by_light", std::move(by_light)},
            {"shared", std::move(shared)}};
}

json fact_view(const Field& root) {
    const Field facts = root["facts"];
    json requirements = json::array(), not_required = json::array(), objects = json::array();
    for (const Field& f : facts["requires"].items()) requirements.push_back(f.required_text());
    for (const Field& f : facts["not_required"].items()) not_required.push_back(f.required_text());
    for (const Field& o : facts["objects"].items()) {
        json faults = json::array();
        for (const auto& [key, words] : {std::pair{"boundary_edges", "boundary edges"},
                                         {"nonmanifold_edges", "non-manifold edges"},
                                         {"misoriented_edges", "misoriented edges"},
                                         {"nonmanifold_vertices", "non-manifold vertices"},
                                         {"degenerate_triangles", "degenerate triangles"},
                                         {"duplicate_triangles", "duplicate triangles"}})
            if (const auto n = o[key].number(); n && *n > 0) faults.push_back(fmt::format("{} {}", count(n), words));
        const bool closed = o["closed"].flag(), outward = o["outward"].flag(), planar = o["planar"].flag();
        objects.push_back({{"name", o["name"].text()},
                           {"triangles", count(o["triangles"].number())},
                           {"vertices", count(o["vertices"].number())},
                           {"components", count(o["components"].number())},
                           {"shape", fmt::format("{}{}", closed ? (outward ? "closed" : "closed, inside out") : "open",
                                                 planar ? ", planar" : "")},
                           {"area", score(o["area"].number())},
                           {"volume", closed ? score(o["volume"].number()) : kNone},
                           {"faults", std::move(faults)}});
    }
    return {{"triangles", count(facts["triangles"].number())},
            {"requires", std::move(requirements)},
            {"not_required", std::move(not_required)},
            {"has_objects", !objects.empty()},
            {"objects", std::move(objects)}};
}

/// On how many points area lights are judged, where the reference is too dear for all.
std::string judged_in_words(const Field& root) {
    const Field judged = root["reference"]["judged"];
    if (!judged.present()) return {};
    return fmt::format(
        "Too dear for every point: area lights are judged on {} of {} points, one at random out of each square tile of "
        "the picture. Between them the reference’s picture is by {}, which also says where edges are and judges "
        "nothing.",
        count(judged["points"].number()), count(judged["of"].number()), judged["guess"].text());
}

std::string size_in_words(const Field& root) {
    const auto w = root["size"]["width"].number(), h = root["size"]["height"].number();
    return w && h ? fmt::format("{:.0f} × {:.0f}", *w, *h) : std::string();
}

}  // namespace

json scene_view(const SceneFiles& scene, const std::vector<std::string>& styles) {
    const Field root                 = scene.scene().root;
    const std::vector<Field> methods = root["methods"].items();
    json pictures = json::array(), used = json::array(), unserved = json::array(), image = json::array(),
         files = json::array();
    std::vector<ChartPoint> chart;

    const Field reference = root["reference"];
    if (json f = scene.figure(reference["files"]["png"], "Reference", "picture",
                              fmt::format("{}: the picture with the reference's shadows", scene.scene().title));
        f.is_object()) {
        f["note"] = fmt::format("{}: {}", reference_view(root)["title"].get<std::string>(),
                                reference["exact"].flag() ? "exact" : "sampled, not exact");
        pictures.push_back(std::move(f));
    }
    if (const json exr = scene.exr(reference["files"]); exr.is_string())
        files.push_back({{"label", "Reference"}, {"href", exr}});

    for (const Field& method : methods) {
        const std::string label = method_label(method, methods), id = method_id(method);
        const bool served = serves(method);
        used.push_back({{"label", label},
                        {"how", served ? method["serves"]["how"].text() : "not served"},
                        {"why", method["serves"]["why"].text()},
                        {"parameters", parameters(method)}});
        if (!served) {
            unserved.push_back({{"label", label}, {"why", method["serves"]["why"].text()}});
            continue;
        }
        const Totals t    = totals(method);
        const bool itself = is_reference(root, method);
        if (t.mae && t.camera_ms && t.object_ms) {
            const auto style = std::find(styles.begin(), styles.end(), id) - styles.begin();
            chart.push_back(
                {itself ? label + " (the reference)" : label, *t.camera_ms, *t.object_ms, *t.mae, std::size_t(style)});
        }
        if (const json exr = scene.exr(method["files"]); exr.is_string())
            files.push_back({{"label", label}, {"href", exr}});
        if (itself) continue;
        if (json f = scene.figure(method["files"]["png"], label, "picture",
                                  fmt::format("{}: the picture with the shadows of {}", scene.scene().title, label));
            f.is_object()) {
            const std::string coverage = percent_words(method);
            f["note"] = fmt::format("{} wrong in the interior, {} ms{}{}", count(t.interior), milliseconds(t.object_ms),
                                    coverage.empty() ? "" : "; ", coverage);
            pictures.push_back(std::move(f));
        }
        const Field scores = method["image"];
        image.push_back(
            {{"label", label},
             {"rmse", score(scores["rmse"].number())},
             {"psnr", scores["psnr"].present()       ? fmt::format("{:.1f}", *scores["psnr"].number())
                      : scores["rmse"].number() == 0 ? "∞"
                                                     : kNone},
             {"ssim", scores["ssim"].present() ? fmt::format("{:.4f}", *scores["ssim"].number()) : kNone},
             {"flip", score(scores["flip"].number())},
             {"map",
              scene.figure(method["files"]["flip"], label, "FLIP map",
                           fmt::format("FLIP map of {}: bright where a viewer would see a difference", label))}});
    }

    json warnings = json::array();
    for (const Field& w : root["scene"]["warnings"].items()) warnings.push_back(w.required_text());
    json view            = {{"title", scene.scene().title},
                            {"shows", root["scene"]["shows"].text()},
                            {"source", root["scene"]["source"].text()},
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
    view["has_warnings"] = !view["warnings"].empty();
    view["chart"]        = chart.empty() ? json(false) : error_time_chart(chart);
    return view;
}

}  // namespace umbra
