#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/pages/mesh_faults.h"
#include "umbra/shadows/volumes/silhouettes.h"

namespace umbra {
namespace {

struct InspectLine {
    std::string scene;
    std::uint64_t silhouettes = 0;  ///< random directions of light; 0: not asked for
    std::uint64_t seed        = 1;
    bool as_json              = false;
};

struct ServedRecord {
    std::string name{};
    ServiceRecord serves{};
};
DESCRIBE(ServedRecord) { MEMBERS(name, serves); }

struct SilhouetteRecord {
    std::string object{};
    double mean = kUnknown, standard_error = kUnknown;
    std::uint64_t directions = 0;
};
DESCRIBE(SilhouetteRecord) {
    MEMBERS(object);
    of(MEMBER(mean), "edges");
    MEMBERS(standard_error, directions);
}

struct InspectRecord {
    int schema = kResultsSchema;
    std::string version{};
    SceneRecord scene{};
    FactsRecord facts{};
    std::vector<LightRecord> lights{};
    std::vector<ServedRecord> methods{};
    std::vector<SilhouetteRecord> silhouettes{};
};
DESCRIBE(InspectRecord) {
    MEMBERS(schema, version, scene, facts, lights, methods);
    of.may(MEMBER(silhouettes), "over random light directions, where they were asked for");
}

std::string joined(const std::vector<std::string>& list) {
    return list.empty() ? "nothing" : fmt::format("{}", fmt::join(list, ", "));
}

/// The faults of an object's mesh, or that it has none.
std::string mesh_state(const ObjectRecord& o) {
    if (o.closed) return o.outward ? "closed, oriented outwards" : "closed, oriented inwards";
    std::string text;
    for (const MeshFault& fault : kMeshFaults)
        if (const std::uint64_t n = o.*fault.count; n != 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, n == 1 ? fault.one : fault.many);
    return "not closed: " + text;
}

/// ", casts_shadows is false" for each switch that is off.
std::string what_is_off(const ObjectRecord& o) {
    std::string text;
    if (o.casts_shadows) text += ", casts_shadows is false";
    if (o.receives_shadows) text += ", receives_shadows is false";
    if (o.seen_by_camera) text += ", seen_by_camera is false";
    return text;
}

InspectRecord inspect_record(const Scene& scene, const SceneFacts& facts, const InspectLine& line) {
    InspectRecord record{.version = std::string(version()),
                         .scene   = scene_record(scene),
                         .facts   = facts_record(facts),
                         .lights  = light_records(facts)};
    for (const MethodInfo* info : methods())
        record.methods.push_back({std::string(info->name), service_record(verdict(*info->make(), facts))});
    if (line.silhouettes > 0)
        for (const SilhouetteStatistics& s : silhouette_statistics(scene, line.silhouettes, line.seed))
            record.silhouettes.push_back({s.object, s.mean, s.standard_error, s.directions});
    return record;
}

/// The same for people.
std::string inspect_text(const InspectRecord& record) {
    const SceneRecord& scene = record.scene;
    const FactsRecord& facts = record.facts;
    std::string text         = fmt::format("{}\n", scene.title);
    if (!scene.shows.empty()) text += fmt::format("  {}\n", scene.shows);
    text += fmt::format("\nRequires:      {}\nDoes not need: {}\n", joined(facts.required), joined(facts.not_required));

    text += "\nLights\n";
    for (const LightRecord& l : record.lights) text += fmt::format("  {}: {}, {}\n", l.name, l.kind, l.place);

    text += fmt::format("\nObjects ({} triangles)\n", facts.triangles);
    for (const ObjectRecord& o : facts.objects)
        text += fmt::format("  {}: {} triangles, {}{}{}\n", o.name, o.triangles, mesh_state(o),
                            o.planar ? ", planar" : "", what_is_off(o));
    if (!scene.origin.empty())
        text +=
            fmt::format("\nOrigin: ({}) of the file; all numbers are relative to it\n", fmt::join(scene.origin, ", "));
    text += fmt::format("\nPlanar receivers: {}, {:.1f} % of the area\n", facts.planes.size(),
                        100 * facts.planar_area_share);

    text += "\nMethods\n";
    for (const ServedRecord& m : record.methods)
        text += fmt::format("  {:<18} {:<14} {}\n", m.name, m.serves.how, m.serves.why);
    if (!record.silhouettes.empty()) {
        text += "\nSilhouette edges over random light directions\n";
        for (const SilhouetteRecord& s : record.silhouettes)
            text += fmt::format("  {}: {:.3f} +- {:.3f}\n", s.object, s.mean, s.standard_error);
    }
    for (const std::string& w : scene.warnings) text += fmt::format("warning: {}\n", w);
    return text;
}

int inspect(const InspectLine& line, const Common& common) {
    const PreparedScene prepared =
        prepare_scene(scene_file(line.scene, common.up), {});  // with what only the picture shows
    const InspectRecord record = inspect_record(prepared.scene, prepared.facts, line);
    print_out("{}", line.as_json ? json_text(to_record(record)) : without_controls(inspect_text(record)) + "\n");
    return kDone;
}

}  // namespace

Action inspect_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<InspectLine>();
    app.add_option("SCENE", line->scene, "Scene: a file (.json .gltf .glb .obj .nff .ply .off .stl) or a scene's name")
        ->type_name("")
        ->required();
    app.add_option("--silhouettes", line->silhouettes,
                   "Also give the mean number of silhouette edges over N random light directions")
        ->check(CLI::Range(std::uint64_t{2}, std::uint64_t{10'000'000}))
        ->type_name("N");
    app.add_option("--seed", line->seed, "Seed of these directions")->type_name("N");
    app.add_flag("--json", line->as_json, "Print JSON");
    return [line, &common] { return inspect(*line, common); };
}

}  // namespace umbra
