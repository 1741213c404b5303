#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/studies/whitted/whitted_study.h"

namespace umbra {
namespace {

struct WhittedLine {
    std::string scene, places = "regular";
    Size size;
    ShadowMethod method;
    std::filesystem::path out;
    bool as_json = false, formula = false;
    WhittedOptions options;
};

/// Why the method gives no shadows for this scene; empty where it does.
std::string refusal(const MethodChoice& choice, const SceneFacts& facts) {
    const Service service = verdict(*choice.make(), facts);
    return service ? refusal_of(*choice.info) : service.why;
}

int whitted(const WhittedLine& line, const Common& common) {
    WhittedOptions options = line.options;
    options.places = *std::ranges::find(kEyePlaces, line.places, [](EyePlaces places) { return to_string(places); });
    options.method = line.method.choice();
    PreparedScene prepared = prepare_scene(scene_file(line.scene, common.up), line.size, 1, Work::picture);
    correct_warnings(prepared.scene);
    if (options.method)
        if (const std::string why = refusal(*options.method, prepared.facts); !why.empty()) {
            print_error("{} does not serve this scene: {}\n", options.method->text(), why);
            return kNo;
        }
    if (line.formula) {
        options.bodies = find_bodies(prepared.scene);
        if (options.bodies->list.empty()) {
            print_error("--formula does not serve this scene: no mesh of it is a sphere or a box\n");
            return kNo;
        }
    }
    pass_warnings(prepared.scene, [&](const std::string& warning) { Terminal(common.quiet).warn(warning); });
    const WhittedRecord record = on_terminal(
        common, options, [&] { return write_study(line.out, trace_whitted, whitted_report, prepared, options); });
    print_record(line.as_json, common, to_record(record), [&] {
        return fmt::format("{}{}\n", study_text(whitted_report(record)), (line.out / "index.html").string());
    });
    return kDone;
}

}  // namespace

Action whitted_command(CLI::App& app, const Common& common) {
    const auto line         = std::make_shared<WhittedLine>();
    WhittedOptions& options = line->options;
    add_scene(app, line->scene)->required();
    add_shadow_method(app, line->method);
    add_number(app, "--depth", options.depth, "Rays on a path, the eye ray included; 1: no mirrors, no glass", 1, 32);
    add_number(app, "--least-weight", options.least_weight,
               "Do not trace rays whose product of k_r and k_t is below this; 0: trace all", 0, 1, "W");
    add_pixel_samples(app, options.pixel_samples, "Eye rays a pixel: 1, 4, 9, 16 ...");
    std::vector<std::string> places;
    for (const EyePlaces p : kEyePlaces) places.emplace_back(to_string(p));
    app.add_option(
           "--pixel-places", line->places,
           "Where eye rays pass: at regular places, anywhere in their part of the pixel (jittered), or anywhere "
           "in the pixel (random)")
        ->check(CLI::IsMember(places))
        ->capture_default_str()
        ->type_name("PLACES");
    app.add_flag("--glossy", options.glossy,
                 "Spread mirrored rays by each material's shininess: rough mirrors, with noise that more "
                 "--pixel-samples average out");
    app.add_flag(
        "--formula", line->formula,
        "Add a picture in which rays meet spheres, boxes, cylinders, cones and tori by formula instead of by triangles");
    add_number(app, "--runs", options.runs, "Runs of each way to trace; the fastest counts", 1, 1000);
    add_size(app, line->size);
    add_json(app, line->as_json, "the tables");
    add_output(app, line->out);
    return [line, &common] { return whitted(*line, common); };
}

}  // namespace umbra
