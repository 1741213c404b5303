#include "umbra/bench/studies/energy/energy.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"

namespace umbra {

Action energy_command(CLI::App& app, const Common& common) {
    struct Line {
        std::vector<std::string> scenes;
        ShadowMethod method{"exact"};
        std::filesystem::path out;
        bool as_json = false;
        EnergyOptions options;
    };
    const auto line = std::make_shared<Line>();
    add_scenes(app, line->scenes, "A scene, or its frames: SCENE@FIRST..LAST")->required();
    add_shadow_method(app, line->method);
    add_number(app, "--points", line->options.points, "Points on all faces together; each face has one at least", 1,
               10'000'000);
    add_json(app, line->as_json);
    add_output(app, line->out);
    return [line, &common] {
        EnergyOptions& options                         = line->options;
        options.method                                 = line->method.choice();
        const std::vector<std::filesystem::path> files = scene_files(line->scenes, common.up);
        StagedFolder staged(line->out);
        const Json record =
            on_terminal(common, options, [&] { return measure_energy(files, options, staged.folder()); });
        write_text(staged.folder() / "results.json", json_text(record));
        staged.commit();
        print_record(line->as_json, common, record, [&] { return energy_text(record); });
        return kDone;
    };
}

}  // namespace umbra
