#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/pages/mesh_faults.h"
#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/shadows/volumes/silhouettes.h"

namespace umbra {
namespace {

struct SilhouetteOptions {
    std::uint64_t directions = 0;  ///< 0: not asked for
    std::uint64_t seed       = 1;
};

std::string join(const Json& list) {
    std::string text;
    for (const Json& item : list) text += (text.empty() ? "" : ", ") + item.get<std::string>();
    return text.empty() ? "nothing" : text;
}

/// The faults of an object's mesh, or that it has none.
std::string mesh_state(const Json& o) {
    if (o["closed"]) return o["outward"] ? "closed, oriented outwards" : "closed, oriented inwards";
    std::string text;
    for (const MeshFault& fault : kMeshFaults)
        if (const auto n = o[std::string(fault.key)].get<std::uint64_t>(); n != 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, n == 1 ? fault.one : fault.many);
    return "not closed: " + text;
}

/// ", casts_shadows is false" for each switch that is off.
std::string what_is_off(const Json& o) {
    std::string text;
    for (const ObjectSwitch& each : kObjectSwitches)
        if (o.contains(std::string(each.key))) text += fmt::format(", {} is false", each.key);
    return text;
}

/// {schema, scene, facts, lights, methods: [{name, serves}], silhouettes?}
Json inspect_json(const Scene& scene, const SceneFacts& facts, const SilhouetteOptions& silhouettes) {
    Json record = {{"schema", kResultsSchema},   {"version", version()},         {"scene", scene_json(scene)},
                   {"facts", facts_json(facts)}, {"lights", lights_json(facts)}, {"methods", Json::array()}};
    for (const MethodInfo* info : methods())
        record["methods"].push_back({{"name", info->name}, {"serves", service_json(verdict(*info->make(), facts))}});
    if (silhouettes.directions > 0) {
        record["silhouettes"] = Json::array();
        for (const SilhouetteStatistics& s : silhouette_statistics(scene, silhouettes.directions, silhouettes.seed))
            record["silhouettes"].push_back({{"object", s.object},
                                             {"mean", number(s.mean)},
                                             {"standard_error", number(s.standard_error)},
                                             {"directions", s.directions}});
    }
    return record;
}

/// The same for people.
std::string inspect_text(const Json& record) {
    const Json& scene = record["scene"];
    const Json& facts = record["facts"];
    std::string text  = fmt::format("{}\n", scene["title"].get<std::string>());
    if (!scene["shows"].get<std::string>().empty()) text += fmt::format("  {}\n", scene["shows"].get<std::string>());
    text +=
        fmt::format("\nRequires:      {}\nDoes not need: {}\n", join(facts["requires"]), join(facts["not_required"]));

    text += "\nLights\n";
    for (const Json& l : record["lights"])
        text += fmt::format("  {}: {}, {}\n", l["name"].get<std::string>(), l["kind"].get<std::string>(),
                            l["place"].get<std::string>());

    text += fmt::format("\nObjects ({} triangles)\n", facts["triangles"].get<std::uint64_t>());
    for (const Json& o : facts["objects"])
        text += fmt::format("  {}: {} triangles, {}{}{}\n", o["name"].get<std::string>(),
                            o["triangles"].get<std::uint64_t>(), mesh_state(o), o["planar"] ? ", planar" : "",
                            what_is_off(o));
    if (scene.contains("origin"))
        text += fmt::format("\nOrigin: ({}, {}, {}) of the file; all numbers are relative to it\n",
                            scene["origin"][0].get<double>(), scene["origin"][1].get<double>(),
                            scene["origin"][2].get<double>());
    text += fmt::format("\nPlanar receivers: {}, {:.1f} % of the area\n", facts["planes"].size(),
                        100 * facts["planar_area_share"].get<double>());

    text += "\nMethods\n";
    for (const Json& m : record["methods"])
        text += fmt::format("  {:<18} {:<14} {}\n", m["name"].get<std::string>(), m["serves"]["how"].get<std::string>(),
                            m["serves"]["why"].get<std::string>());
    if (record.contains("silhouettes")) {
        text += "\nSilhouette edges over random light directions\n";
        for (const Json& s : record["silhouettes"])
            text += fmt::format("  {}: {:.3f} +- {:.3f}\n", s["object"].get<std::string>(), s["mean"].get<double>(),
                                s["standard_error"].get<double>());
    }
    for (const Json& w : scene["warnings"]) text += fmt::format("warning: {}\n", w.get<std::string>());
    return text;
}

struct InspectLine {
    std::string scene;
    SilhouetteOptions silhouettes;
    bool as_json = false;
};

int inspect(const InspectLine& line, const Common& common) {
    const PreparedScene prepared =
        prepare_scene(scene_file(line.scene, common.up), {});  // with what only the picture shows
    const Json record = inspect_json(prepared.scene, prepared.facts, line.silhouettes);
    print_out("{}", line.as_json ? json_text(record) : without_controls(inspect_text(record)) + "\n");
    return kDone;
}

}  // namespace

Action inspect_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<InspectLine>();
    app.add_option("SCENE", line->scene, "Scene: a file (.json .gltf .glb .obj .nff .ply .off .stl) or a scene's name")
        ->type_name("")
        ->required();
    app.add_option("--silhouettes", line->silhouettes.directions,
                   "Also give the mean number of silhouette edges over N random light directions")
        ->check(CLI::Range(std::uint64_t{2}, std::uint64_t{10'000'000}))
        ->type_name("N");
    app.add_option("--seed", line->silhouettes.seed, "Seed of these directions")->type_name("N");
    app.add_flag("--json", line->as_json, "Print JSON");
    return [line, &common] { return inspect(*line, common); };
}

}  // namespace umbra
