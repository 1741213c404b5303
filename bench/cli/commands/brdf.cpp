#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/studies/brdf/brdf_table.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {

Action brdf_command(CLI::App& app, const Common& common) {
    struct Line {
        std::string scene;
        int steps    = 64;
        bool as_json = false;
    };
    const auto line = std::make_shared<Line>();
    add_scene(app, line->scene)->required();
    add_number(app, "--steps", line->steps, "Angles from the normal that are sampled; four times as many about it", 1,
               1000);
    add_json(app, line->as_json);
    return [line, &common] {
        const BrdfRecord record =
            measure_materials(load_scene(scene_file(line->scene, common.up)), line->steps, common.command);
        print_record(line->as_json, common, to_record(record), [&] { return study_text(brdf_report(record)); });
        return kDone;
    };
}

}  // namespace umbra
