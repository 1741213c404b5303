#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/run/at_work.h"
#include "umbra/bench/run/chosen.h"
#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

struct WhyLine {
    std::string scene, light;
    Size size;
    int x = 0, y = 0;
    std::vector<std::string> methods;
    bool as_json = false;
};

Json triangle_json(const Scene& scene, TriangleId t) {
    if (t == kNoTriangle) return nullptr;
    return {{"triangle", t}, {"object", scene.objects[scene.triangle_object[t]].name}};
}

Json reason_json(const Scene& scene, const Reason& reason) {
    Json evidence = Json::array();
    for (const Evidence& e : reason.evidence) {
        Json entry = {{"name", e.name}};
        std::visit([&](const auto& value) { entry["value"] = value; }, e.value);
        if (!e.unit.empty()) entry["unit"] = e.unit;
        evidence.push_back(entry);
    }
    return {{"verdict", to_string(reason.verdict)},
            {"blocker", triangle_json(scene, reason.blocker)},
            {"at", reason.at ? Json(*reason.at) : Json()},
            {"towards", {reason.towards.x, reason.towards.y, reason.towards.z}},
            {"margin", number(reason.margin)},
            {"unit", reason.unit},
            {"evidence", evidence}};
}

/// One method's answer and its reason at pixel i.
Json answer_json(MethodAtWork& work, const PointBatch& picture, std::size_t i, LightId light) {
    const Scene& scene = work.built().scene;
    Json entry         = {{"method", work.choice().text()}};
    try {
        const bool whole = work.choice().info->needs_raster;
        const auto which = static_cast<std::uint32_t>(i);
        PointBatch point = pick(picture, {&which, 1});
        if (!whole) point.raster.reset();
        const PointBatch& asked = whole ? picture : point;
        const std::size_t k     = whole ? i : 0;
        work.look(asked);
        VisibilityPlane plane(asked.size(), work.built().facts.has_coloured_filters);
        work.visibility(light, plane.out());
        const Given given{plane.s[k], plane.answer[k]};
        if (plane.defined(k)) entry["visibility"] = given.s;
        entry.update(reason_json(scene, work.method().explain(work.aimed(light), work.looked(), k, given)));
        work.forget_look();
    } catch (...) {
        entry["failed"] = current_message();
    }
    return entry;
}

std::string sentence(const Json& a) {
    if (a.contains("failed")) return a["failed"];
    if (a.contains("not_served")) return "does not serve this scene: " + a["not_served"].get<std::string>();
    std::string text = a["verdict"];
    if (a.contains("visibility")) text += fmt::format(", S {:.4g}", a["visibility"].get<float>());
    if (!a["blocker"].is_null()) {
        text += fmt::format("; triangle {} of {} blocks", a["blocker"]["triangle"].get<TriangleId>(),
                            a["blocker"]["object"].get<std::string>());
        if (!a["at"].is_null()) text += fmt::format(" at {:.4g} of the way to the light", a["at"].get<double>());
    }
    if (!a["margin"].is_null())
        text += fmt::format("; margin {:.4g} {}", a["margin"].get<double>(), a["unit"].get<std::string>());
    for (const Json& e : a["evidence"])
        text += fmt::format(
            "; {}: {}{}{}", e["name"].get<std::string>(),
            e["value"].is_string() ? e["value"].get<std::string>() : fmt::format("{:.6g}", e["value"].get<double>()),
            e.contains("unit") ? " " : "", e.value("unit", ""));
    return text;
}

std::string text_of(const Json& record) {
    const Json& point = record["point"];
    std::string text  = fmt::format("{}: pixel {}, {}: triangle {} of {}, position {:.6g} {:.6g} {:.6g}\n",
                                    record["scene"].get<std::string>(), record["pixel"][0].get<int>(),
                                    record["pixel"][1].get<int>(), point["triangle"].get<TriangleId>(),
                                    point["object"].get<std::string>(), point["position"][0].get<double>(),
                                    point["position"][1].get<double>(), point["position"][2].get<double>());
    for (const Json& light : record["lights"]) {
        text += fmt::format("light {}\n", light["light"].get<std::string>());
        if (light.contains("away")) text += "  The light is behind the surface: S is 0 for every method.\n";
        if (light.contains("unshadowed")) text += "  The object receives no shadows: S is 1 for every method.\n";
        for (const Json& a : light["methods"])
            text += fmt::format("  {:24} {}\n", a["method"].get<std::string>(), sentence(a));
    }
    return text;
}

int why(const WhyLine& line, const Common& common) {
    const std::filesystem::path file = scene_file(line.scene, common.up);
    const PreparedScene prepared     = prepare_scene(file, line.size);
    const Scene& scene               = prepared.scene;
    const PointBatch& points         = prepared.points;
    const int width = points.raster->width, height = points.raster->height;
    if (line.x < 0 || line.x >= width || line.y < 0 || line.y >= height)
        throw UsageError(fmt::format("pixel {}, {}: expected 0 to {}, 0 to {}", line.x, line.y, width - 1, height - 1));
    const auto i =
        static_cast<std::size_t>(line.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(line.x);
    if (points.triangle[i] == kNoTriangle) {
        print_error("no surface at pixel {}, {}\n", line.x, line.y);
        return kNo;
    }
    if (!line.light.empty() && std::ranges::find(scene.lights, line.light, &Light::name) == scene.lights.end())
        throw UsageError(fmt::format("no light \"{}\" in {}", line.light, scene.name));
    const std::vector<MethodChoice> choices = chosen_methods(line.methods, {}, {&file, 1});

    const vec3 p = points.position(i);
    Json record  = {
         {"scene", scene.name}, {"pixel", {line.x, line.y}}, {"point", triangle_json(scene, points.triangle[i])}};
    record["point"]["u"]        = points.u[i];
    record["point"]["v"]        = points.v[i];
    record["point"]["position"] = {p.x, p.y, p.z};
    if (const dvec3 o = scene.origin; o != dvec3(0)) record["point"]["origin"] = {o.x, o.y, o.z};
    record["lights"] = Json::array();
    for (const Light& light : scene.lights)
        if (line.light.empty() || light.name == line.light)
            record["lights"].push_back({{"light", light.name}, {"methods", Json::array()}});
    for (const MethodChoice& choice : choices) {
        MethodAtWork work(choice, scene, prepared.facts);
        const Service service = work.service();
        for (Json& entry : record["lights"]) {
            const auto light =
                static_cast<LightId>(std::ranges::find(scene.lights, entry["light"].get<std::string>(), &Light::name) -
                                     scene.lights.begin());
            if (!points.asks(light, i))
                entry[points.faces(light, i) ? "unshadowed" : "away"] = true;
            else if (!service)
                entry["methods"].push_back({{"method", choice.text()}, {"not_served", service.why}});
            else
                entry["methods"].push_back(answer_json(work, points, i, light));
        }
    }
    print_out("{}", line.as_json ? json_text(record) : without_controls(text_of(record)));
    return kDone;
}

}  // namespace

Action why_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<WhyLine>();
    add_scene(app, line->scene)->required();
    app.add_option("X", line->x, "Column of the pixel, from 0")->type_name("")->required();
    app.add_option("Y", line->y, "Row of the pixel, from 0 at the top")->type_name("")->required();
    app.add_option("--light", line->light, "One light (default: all)")->type_name("NAME");
    add_methods(app, line->methods, "Methods, with settings (default: those that compare runs)");
    add_size(app, line->size);
    app.add_flag("--json", line->as_json, "Print the reasons as JSON");
    return [line, &common] { return why(*line, common); };
}

}  // namespace umbra
