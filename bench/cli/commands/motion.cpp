#include "umbra/bench/studies/motion/motion.h"

#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

struct MotionLine {
    std::vector<std::string> scenes;
    bool as_json = false;
    MotionCommand command;
};

int motion(MotionLine line, const Common& common) {
    MotionCommand& command = line.command;
    return_scenes(command.methods, line.scenes);
    if (line.scenes.empty()) throw UsageError("motion: SCENE is required");
    command.command  = common.command;
    command.threads  = thread_count();
    const auto files = scene_files(line.scenes, common.up);
    check_writable_beside(command.out);
    const PlaceLock lock = PlaceLock::inside(command.out);
    std::vector<std::string> unreadable;
    const MotionRecord record =
        on_terminal(common, command.options, [&] { return measure_motion(files, command, unreadable); });
    if (line.as_json)
        print_out("{}", json_text(to_record(record)));
    else if (!common.quiet && !record.motion.empty())
        print_out("{}{}\n", motion_table(record), (command.out / "index.html").string());
    for (const std::string& message : unreadable) print_error("{}\n", message);
    for (const ListedFailureRecord& f : record.failed)
        print_error("{}: {}: {}\n", f.scene, f.method, f.failure.message);
    return !record.failed.empty() ? kInternal : unreadable.empty() ? kDone : kUnreadable;
}

}  // namespace

Action motion_command(CLI::App& app, const Common& common) {
    const auto line        = std::make_shared<MotionLine>();
    MotionCommand& command = line->command;
    add_scenes(app, line->scenes);
    add_methods(app, command.methods);
    add_number(app, "--frames", command.options.frames, "Frames of each movement", 1, 10000);
    add_size(app, command.size, "320x180");
    add_budget(app, command.options.still.most);
    app.add_option("--reference-points", command.options.area_points,
                   "Compare area lights at about N stratified points a frame")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 30))
        ->capture_default_str()
        ->type_name("N");
    add_number(app, "--max-rmse", command.max_rmse, "Also name the fastest method whose RMSE stays within this", 0, 1,
               "E");
    add_output(app, command.out);
    add_json(app, line->as_json);
    return [line, &common] { return motion(*line, common); };
}

}  // namespace umbra
