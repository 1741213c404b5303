#include "umbra/bench/compare/compare.h"

#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/out/own_files.h"
#include "umbra/bench/out/place_lock.h"
#include "umbra/bench/run/antialias.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

struct CompareLine {
    std::vector<std::string> scenes;
    std::string size, reference;
    CompareOptions options;
};

int compare(CompareLine line, const Common& common) {
    return_scenes(line.options.methods, line.scenes);
    if (line.scenes.empty()) throw UsageError("compare: SCENE is required");
    if (!line.size.empty()) line.options.size = parse_size(line.size);
    if (!line.reference.empty()) line.options.reference = line.reference;
    check_writable_beside(line.options.out);
    const PlaceLock lock  = PlaceLock::inside(line.options.out);
    const ScenesDone done = compare_on_terminal(scene_files(line.scenes, common.up), line.options, common);
    const int code        = exit_code(done);
    return code == kDone && !done.missing.empty() ? kUnreadable : code;
}

}  // namespace

Action compare_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<CompareLine>();
    app.add_option("SCENE", line->scenes, "Scenes: files or names of scenes (required)")->type_name("");
    app.add_option("--methods", line->options.methods, "Methods, with settings (default: all)")->type_name("METHOD");
    app.add_option("--reference", line->reference,
                   "Reference method (default: exact, or ray tracing where exact does not serve the scene)")
        ->type_name("METHOD");
    app.add_option("--reference-points", line->options.points,
                   "Score area lights at about N stratified points (default: all points, if affordable)")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 30))
        ->type_name("N");
    app.add_option("--size", line->size, "Size of the pictures (default: the scene's)")->type_name("WIDTHxHEIGHT");
    line->options.pixel_samples = kPictureSamples;
    app.add_option("--pixel-samples", line->options.pixel_samples,
                   "Points a pixel in pictures: 1, 4, 9, 16 ... (planes and errors stay at pixel centres)")
        ->check(pixel_samples())
        ->capture_default_str()
        ->type_name("N");
    app.add_option("-o,--output", line->options.out, "Folder to write to")->type_name("DIR")->required();
    return [line, &common] { return compare(*line, common); };
}

}  // namespace umbra
