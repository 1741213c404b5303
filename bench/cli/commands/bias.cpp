#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "umbra/bench/cli/bias_command.h"
#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/out/own_files.h"
#include "umbra/bench/out/place_lock.h"
#include "umbra/bench/run/canonical.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

struct BiasLine {
    std::vector<std::string> scenes;
    std::string size;
    BiasOptions options;
};

int bias(BiasLine line, const Common& common) {
    BiasOptions& options = line.options;
    if (!line.size.empty()) options.size = parse_size(line.size);
    options.command  = common.command;
    options.threads  = thread_count();
    const auto files = line.scenes.empty() ? canonical_scenes(scenes_folder()) : scene_files(line.scenes, common.up);
    check_bias_map(options.map, default_bias_grid());
    check_writable_beside(options.out);
    const PlaceLock lock = PlaceLock::inside(options.out);
    std::vector<std::string> failed;
    Json record;
    {
        const Terminal terminal(common.quiet);
        options.progress = [&](const std::string& what) { terminal.progress(what); };
        record           = study_biases(files, options, failed);
    }
    if (!common.quiet && !record["bias"].empty())
        print_out("{}{}\n", bias_table(record), (options.out / "index.html").string());
    for (const std::string& message : failed) print_error("{}\n", message);
    for (const Json& failure : record["failed"])
        print_error("{}: {}\n", failure["scene"].get<std::string>(), failure["message"].get<std::string>());
    return !record["failed"].empty() ? kInternal : failed.empty() ? kDone : kUnreadable;
}

}  // namespace

Action bias_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<BiasLine>();
    app.add_option("SCENE", line->scenes, "Scenes: files or names of scenes (default: all canonical scenes)")
        ->type_name("");
    app.add_option("--map", line->options.map, "Settings of shadow_zbuffer other than its bias")->type_name("k=v,k=v");
    app.add_option("--size", line->size, "Size of the pictures (default: 320x180)")->type_name("WIDTHxHEIGHT");
    app.add_option("-o,--output", line->options.out, "Folder to write to")->type_name("DIR")->required();
    return [line, &common] { return bias(*line, common); };
}

}  // namespace umbra
