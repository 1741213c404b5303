#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/shading/brdf_table.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

struct BrdfLine {
    std::string scene;
    int steps    = 64;
    bool as_json = false;
};

int brdf(const BrdfLine& line, const Common& common) {
    const Json record = measure_materials(load_scene(scene_file(line.scene, common.up)), line.steps, common.command);
    if (line.as_json)
        print_out("{}", json_text(record));
    else if (!common.quiet)
        print_out("{}", without_controls(brdf_text(record)));
    return kDone;
}

}  // namespace

Action brdf_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<BrdfLine>();
    app.add_option("SCENE", line->scene, "Scene: a file or a scene's name")->type_name("")->required();
    app.add_option("--steps", line->steps, "Angles from the normal that are sampled; four times as many about it")
        ->check(number_in(1, 1000, "an integer from 1 to 1000"))
        ->capture_default_str()
        ->type_name("N");
    app.add_flag("--json", line->as_json, "Print the record instead of the table");
    return [line, &common] { return brdf(*line, common); };
}

}  // namespace umbra
