#include "umbra/bench/cli/long_runs.h"

#include <fmt/format.h>

#include "umbra/bench/cli/terminal.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/parallel.h"

namespace umbra {

namespace fs = std::filesystem;

ScenesDone compare_on_terminal(const std::vector<fs::path>& files, CompareOptions options, const Common& common,
                               const std::vector<fs::path>& also) {
    options.command = common.command;
    options.threads = thread_count();
    ScenesDone done;
    {
        const Terminal terminal(common.quiet);
        options.progress = [&](const std::string& what) { terminal.progress(what); };
        options.warn     = [&](const std::string& what) { terminal.warn(what); };
        done             = compare_scenes(files, options);
    }
    std::vector<fs::path> folders;
    for (const std::string& name : done.names) folders.push_back(options.out / name);
    if (!folders.empty()) {
        folders.insert(folders.end(), also.begin(), also.end());
        write_report(folders, options.out, {});
    }
    if (!common.quiet && !folders.empty()) fmt::print("{}\n", (options.out / "index.html").string());
    for (const std::string& message : done.failed) fmt::print(stderr, "{}\n", message);
    for (const std::string& message : done.stopped) fmt::print(stderr, "{}\n", message);
    for (const std::string& message : done.missing) fmt::print(stderr, "{}\n", message);
    return done;
}

int exit_code(const ScenesDone& done) {
    if (done.internal || !done.stopped.empty()) return kInternal;
    return done.failed.empty() ? kDone : kUnreadable;
}

Json climb_on_terminal(LadderOptions options, const Common& common) {
    options.command = common.command;
    options.threads = thread_count();
    const Terminal terminal(common.quiet);
    options.progress = [&](const std::string& what) { terminal.progress(what); };
    return climb_ladders(options);
}

}  // namespace umbra
