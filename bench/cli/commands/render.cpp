#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/run/antialias.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

struct RenderLine {
    std::string scene, size;
    RenderOptions options;
};

int render(const RenderLine& line, const Common& common) {
    RenderOptions options = line.options;
    options.command       = common.command;
    if (!line.size.empty()) options.size = parse_size(line.size);
    const std::string ending = options.out.extension().string();
    if (ending != ".exr" && ending != ".png")
        throw UsageError(
            fmt::format("-o {}: not a picture format, expected FILE.exr or FILE.png", options.out.string()));
    const Terminal terminal(common.quiet);
    options.warn          = [&](const std::string& what) { terminal.warn(what); };
    const Service service = render_scene(scene_file(line.scene, common.up), options);
    if (service) return kDone;
    print_error("{} does not serve this scene: {}\n", options.method, service.why);
    return kNo;
}

}  // namespace

Action render_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<RenderLine>();
    app.add_option("SCENE", line->scene, "Scene: a file or a scene's name")->type_name("")->required();
    app.add_option("--method", line->options.method, "Method, with settings")
        ->capture_default_str()
        ->type_name("METHOD");
    app.add_option("--size", line->size, "Size of the picture (default: the scene's)")->type_name("WIDTHxHEIGHT");
    line->options.pixel_samples = kPictureSamples;
    app.add_option("--pixel-samples", line->options.pixel_samples,
                   "Points a pixel of a PNG: 1, 4, 9, 16 ... (an EXR has pixel centres)")
        ->check(pixel_samples())
        ->capture_default_str()
        ->type_name("N");
    app.add_flag("--geometry", line->options.with_geometry,
                 "Also write surface points, ids and cameras to the EXR (docs/exr.md)");
    app.add_option("-o,--output", line->options.out, "FILE.exr or FILE.png")->type_name("FILE")->required();
    return [line, &common] { return render(*line, common); };
}

}  // namespace umbra
