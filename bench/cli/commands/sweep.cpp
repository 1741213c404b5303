#include "umbra/bench/sweep/sweep.h"

#include <fmt/format.h>

#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

struct SweepLine {
    std::vector<std::string> scenes;
    std::string settings_file, workload, pack;
    std::optional<std::size_t> list;
    std::vector<std::string> merge;
    bool no_times = false, as_json = false;
    SweepOptions options;
};

/// One command a part, for engines that run commands: each may be run again and writes files of its own.
void print_list(const SweepOptions& options, std::size_t parts) {
    const std::vector<PlannedCell> cells = planned_cells(options.plan);
    if (parts == 0) parts = cells.size();
    parts                       = std::min(parts, cells.size());
    const std::string arguments = plan_arguments(options.plan);
    for (std::size_t k = 0; k < parts; ++k)
        print_out("{} sweep {} --pack {}/{} -o '{}'\n", fs::read_symlink("/proc/self/exe").string(), arguments, k + 1,
                  parts, fs::absolute(options.out).string());
}

int sweep(SweepLine line, const Common& common) {
    SweepOptions& options = line.options;
    return_scenes(options.plan.settings, line.scenes);
    if (!line.merge.empty() && (!line.scenes.empty() || !options.plan.settings.empty()))
        throw UsageError("sweep: --merge takes scenes and settings from the folders, expected none beside it");
    if (line.merge.empty() && line.scenes.empty()) throw UsageError("sweep: SCENE is required");
    if (!line.settings_file.empty())
        for (const MethodChoice& choice : settings_in_file(line.settings_file))
            options.plan.settings.push_back(choice.text());
    if (!line.workload.empty()) options.workload = parse_workload(line.workload);
    options.times = !line.no_times;
    for (const fs::path& file : scene_files(line.scenes, common.up)) options.plan.scenes.push_back(fs::absolute(file));

    if (line.list) {
        constexpr std::size_t kMostParts = 1'000'000'000;  // -1 is read as the largest number that there is
        if (*line.list > kMostParts) throw UsageError(fmt::format("--list: expected 0 to {}", kMostParts));
        print_list(options, *line.list);
        return kDone;
    }
    if (!line.pack.empty()) {
        const Pack pack = parse_pack(line.pack);
        std::vector<std::string> failed;
        on_terminal(common, options, [&] { return sweep_pack(options, pack, failed); });
        for (const std::string& message : failed) print_error("{}\n", message);
        return failed.empty() ? kDone : kInternal;
    }
    check_writable_beside(options.out);
    const PlaceLock lock = PlaceLock::inside(options.out);
    if (!line.merge.empty()) {
        const Budget budget = options.plan.budget;
        options.plan        = merged_plan({line.merge.begin(), line.merge.end()}, options.out);
        options.plan.budget = budget;
    }
    const SweepDone done = sweep_on_terminal(options, common);
    if (line.as_json) {
        std::vector<std::string> records;
        for (const SweepResults& record : done.records) records.push_back(json_text(to_record(record)));
        print_records(records);
    } else if (!common.quiet) {
        for (const SweepResults& r : done.records) print_out("{}", front_in_words(r.scene.name, r.sweep));
        print_out("{}, {} of them computed now\n{}\n", counted(static_cast<double>(done.cells), "cell"), done.computed,
                  (options.out / "index.html").string());
    }
    return done.failed.empty() ? kDone : kInternal;
}

}  // namespace

Action sweep_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<SweepLine>();
    add_scenes(app, line->scenes, "Scenes: files or names of scenes");
    add_methods(app, line->options.plan.settings,
                "Settings: METHOD, METHOD@PRESET, METHOD:k=a|b|c,l=d|e (default: the methods' own sweeps)");
    app.add_option("--settings", line->settings_file, "A file of such settings, one a line")->type_name("FILE");
    app.add_option("--views", line->options.plan.views,
                   "Views: the scene's own, and others with camera and lights jittered")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000))
        ->type_name("N");
    add_size(app, line->options.plan.size);
    add_reference(app, line->options.plan.reference, line->options.plan.points);
    add_budget(app, line->options.plan.budget);
    app.add_option("--workload", line->workload,
                   "Events a second that the cost of a frame is for (default: camera=60,light=1,object=0)")
        ->type_name("LIST");
    app.add_flag("--no-times", line->no_times, "Errors only");
    app.add_option("--list", line->list,
                   "Print the commands that compute the cells in N parts (0: one a cell), and do nothing else")
        ->type_name("N")
        ->expected(0, 1)
        ->default_str("0");
    app.add_option("--pack", line->pack, "Compute part K of N of the cells, and nothing else")->type_name("K/N");
    app.add_option("--merge", line->merge, "Put folders with parts of one sweep together")->type_name("DIR");
    add_json(app, line->as_json, "the fronts");
    add_output(app, line->options.out, "Folder to write to, and to go on from");
    return [line, &common] { return sweep(*line, common); };
}

}  // namespace umbra
