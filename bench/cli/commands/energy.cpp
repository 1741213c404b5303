#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/energy/energy.h"
#include "umbra/bench/out/files.h"
#include "umbra/bench/out/staged_folder.h"

namespace umbra {
namespace {

struct EnergyLine {
    std::vector<std::string> scenes;
    std::string method = "exact";
    std::filesystem::path out;
    bool as_json = false;
    EnergyOptions options;
};

int energy(const EnergyLine& line, const Common& common) {
    EnergyOptions options = line.options;
    options.command       = common.command;
    if (line.method != "none") options.method = parse_method(line.method);
    const std::vector<std::filesystem::path> files = scene_files(line.scenes, common.up);
    StagedFolder staged(line.out);
    Json record;
    {
        const Terminal terminal(common.quiet);
        options.progress = [&](const std::string& what) { terminal.progress(what); };
        record           = measure_energy(files, options, staged.folder());
    }
    write_text(staged.folder() / "results.json", json_text(record));
    staged.commit();
    if (line.as_json)
        print_out("{}", json_text(record));
    else if (!common.quiet)
        print_out("{}", without_controls(energy_text(record)));
    return kDone;
}

}  // namespace

Action energy_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<EnergyLine>();
    app.add_option("SCENE", line->scenes, "A scene, or its frames: SCENE@FIRST..LAST")->type_name("")->required();
    app.add_option("--method", line->method, "Method of S_j, with settings; none: no shadows")
        ->capture_default_str()
        ->type_name("METHOD");
    app.add_option("--points", line->options.points, "Points on all faces together; each face has one at least")
        ->check(number_in(1, 1e7, "an integer from 1 to 10000000"))
        ->capture_default_str()
        ->type_name("N");
    app.add_flag("--json", line->as_json, "Print results.json instead of the table");
    app.add_option("-o,--output", line->out, "Folder to write to")->type_name("DIR")->required();
    return [line, &common] { return energy(*line, common); };
}

}  // namespace umbra
