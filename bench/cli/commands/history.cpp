#include "umbra/bench/report/history.h"

#include <CLI/CLI.hpp>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/streams.h"

namespace umbra {

Action history_command(CLI::App& app, const Common&) {
    struct Line {
        std::vector<std::filesystem::path> folders;
        std::filesystem::path html;
    };
    const auto line = std::make_shared<Line>();
    app.add_option("DIR", line->folders,
                   "A folder a commit that compare wrote, the oldest first; its name is the commit's")
        ->type_name("")
        ->required();
    app.add_option("--html", line->html, "Write a page: rows of scenes and methods, a column a commit")
        ->type_name("FILE");
    return [line] {
        const History history = read_history(line->folders);
        if (!line->html.empty()) {
            StagedFiles staged;
            staged.write(line->html, history_page(history));
            staged.commit();
        }
        print_out("{}", history_text(history));
        return kDone;
    };
}

}  // namespace umbra
