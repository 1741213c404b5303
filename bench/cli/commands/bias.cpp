#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/studies/bias/bias_study.h"

namespace umbra {

Action bias_command(CLI::App& app, const Common& common) {
    struct Line {
        std::vector<std::string> scenes;
        bool as_json = false;
        BiasOptions options;
    };
    const auto line = std::make_shared<Line>();
    add_scenes(app, line->scenes, "Scenes: files or names of scenes (default: all canonical scenes)");
    app.add_option("--map", line->options.map, "Settings of shadow_zbuffer other than its bias")->type_name("k=v,k=v");
    add_size(app, line->options.size, "320x180");
    add_json(app, line->as_json);
    add_output(app, line->options.out);
    return [line, &common] {
        BiasOptions& options = line->options;
        const auto files =
            line->scenes.empty() ? canonical_scenes(scenes_folder()) : scene_files(line->scenes, common.up);
        check_bias_map(options.map);
        check_writable_beside(options.out, {"bias.csv"});
        const PlaceLock lock = PlaceLock::inside(options.out);
        std::vector<std::string> failed;
        const BiasRecord record = on_terminal(common, options, [&] { return study_biases(files, options, failed); });
        if (line->as_json)
            print_out("{}", json_text(to_record(record)));
        else if (!common.quiet && !record.bias.empty())
            print_out("{}{}\n", study_text(bias_report(record)), (options.out / "index.html").string());
        for (const std::string& message : failed) print_error("{}\n", message);
        for (const ListedFailureRecord& f : record.failed) print_error("{}: {}\n", f.scene, f.failure.message);
        return !record.failed.empty() ? kInternal : failed.empty() ? kDone : kUnreadable;
    };
}

}  // namespace umbra
