#include <fmt/format.h>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/core/base/error.h"

namespace umbra {

Action render_command(CLI::App& app, const Common& common) {
    struct Line {
        std::string scene;
        RenderOptions options;
    };
    const auto line = std::make_shared<Line>();
    add_scene(app, line->scene)->required();
    add_method(app, line->options.method, "Method, with settings");
    add_size(app, line->options.size);
    add_pixel_samples(app, line->options.pixel_samples,
                      "Points a pixel of a PNG: 1, 4, 9, 16 ... (an EXR has pixel centres)");
    app.add_flag("--geometry", line->options.with_geometry,
                 "Also write surface points, ids and cameras to the EXR (docs/exr.md)");
    app.add_option("-o,--output", line->options.out, "FILE.exr or FILE.png")->type_name("FILE")->required();
    return [line, &common] {
        RenderOptions& options   = line->options;
        const std::string ending = options.out.extension().string();
        if (ending != ".exr" && ending != ".png")
            throw UsageError(
                fmt::format("-o {}: not a picture format, expected FILE.exr or FILE.png", options.out.string()));
        const Service service =
            on_terminal(common, options, [&] { return render_scene(scene_file(line->scene, common.up), options); });
        if (service) return kDone;
        print_error("{} does not serve this scene: {}\n", options.method, service.why);
        return kNo;
    };
}

}  // namespace umbra
