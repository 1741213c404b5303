#include "umbra/bench/cli/inspect.h"
#include "umbra/bench/cli/streams.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"

namespace umbra {
namespace {

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
