#include "umbra/bench/cli/long_runs.h"

#include <fmt/format.h>

#include "umbra/bench/base/field.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/report/report.h"
#include "umbra/bench/sweep/trade_page.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

/// The records and their page.
void write_records(const SweepOptions& options, const SweepDone& done) {
    StagedFiles staged;
    std::vector<fs::path> files;
    for (std::size_t s = 0; s < done.records.size(); ++s) {
        make_folder(options.out / done.folders[s]);
        check_writable_beside(options.out / done.folders[s]);
        files.push_back(fs::absolute(options.out) / done.folders[s] / "results.json");
        staged.write(files.back(), json_text(to_record(done.records[s])));
    }
    const Json all = done.records.size() == 1 ? to_record(done.records.front())
                                              : Json{{"schema", kResultsSchema},
                                                     {"version", version()},
                                                     {"command", options.command},
                                                     {"sweeps", done.folders}};
    staged.write(options.out / "results.json", json_text(all));
    staged.commit();
    StagedFiles page;
    static_cast<void>(write_trade_page(files, fs::absolute(options.out), "", page));
    page.commit();
}

}  // namespace

ScenesDone compare_on_terminal(const std::vector<fs::path>& files, CompareOptions options, const Common& common,
                               const CompareOutput& output) {
    options.add_page = write_scene_page;
    // Whatever happens to this run, the first page fits the folders beside it; and it shows the scenes that are done, in
    // a twentieth of the time at most.
    using Clock            = std::chrono::steady_clock;
    const fs::path first   = options.out / "index.html";
    Clock::time_point next = Clock::now() + std::chrono::seconds(5);  // a short run writes its pages at its end
    options.scene_done     = [&, next, count = 0]() mutable {
        const Clock::time_point begun = Clock::now();
        const std::string so_far      = fmt::format("{} of {} scenes", ++count, files.size());
        if (begun < next && links_hold(first)) return;
        try {
            write_report({options.out}, options.out, {.so_far = so_far, .language = output.language});
        } catch (const InputError&) {  // an older result beside is not readable
        }
        next = Clock::now() + 20 * (Clock::now() - begun);
    };
    ScenesDone done = on_terminal(common, options, [&] { return compare_scenes(files, options); });
    std::vector<fs::path> folders;
    for (const std::string& name : done.names) folders.push_back(options.out / name);
    const auto write_pages = [&](const char* so_far) {
        if (!done.names.empty())
            write_report(folders, options.out, {.failed = done.failed, .so_far = so_far, .language = output.language});
    };
    if (output.then) {
        write_pages("all scenes; ladders, sweeps and studies follow");
        for (fs::path& folder : output.then()) folders.push_back(std::move(folder));
    }
    write_pages("");
    if (output.as_json) {
        std::vector<std::string> records;
        for (const std::string& name : done.names) records.push_back(bytes_of(options.out / name / "results.json"));
        print_records(records);
    } else if (!common.quiet && !done.names.empty())
        print_out("{}\n", (options.out / "index.html").string());
    for (const std::string& message : done.failed) print_error("{}\n", message);
    for (const std::string& message : done.stopped) print_error("{}\n", message);
    for (const std::string& message : done.missing) print_error("{}\n", message);
    return done;
}

int exit_code(const ScenesDone& done) {
    if (done.internal || !done.stopped.empty()) return kInternal;
    return done.failed.empty() ? kDone : kUnreadable;
}

LaddersRecord climb_on_terminal(LadderOptions options, const Common& common) {
    LaddersRecord record = on_terminal(common, options, [&] { return climb_ladders(options); });
    for (const ListedFailureRecord& failed : record.failed) print_error("{}\n", failed_climb_in_words(failed));
    return record;
}

SweepDone sweep_on_terminal(SweepOptions options, const Common& common) {
    SweepDone done = on_terminal(common, options, [&] { return sweep(options); });
    write_records(options, done);
    for (const std::string& message : done.failed) print_error("{}\n", message);
    return done;
}

}  // namespace umbra
