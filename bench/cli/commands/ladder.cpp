#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/ladders/ladder_record.h"

namespace umbra {
namespace {

struct LadderLine {
    LadderOptions options;
    bool as_json = false;
};

int ladder(LadderLine line, const Common& common) {
    return_ladders(line.options.methods, line.options.names);
    const Json record = climb_on_terminal(line.options, common);
    if (line.as_json)
        print_out("{}", json_text(record));
    else if (!common.quiet)
        print_out("{}", ladder_table(record["ladders"]));
    return record["failed"].empty() ? kDone : kInternal;
}

}  // namespace

Action ladder_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<LadderLine>();
    app.add_option("LADDER", line->options.names, "Ladders (default: all; umbra list names them)")->type_name("");
    app.add_option("--methods", line->options.methods,
                   "Methods, with settings (default: all that reports show but exact, each also @textbook)")
        ->type_name("METHOD");
    app.add_option("--patience", line->options.patience_s,
                   "Seconds of a thread: a method that takes longer on a rung is asked on no later one")
        ->check(number_in(0.001, 1e6, "a number from 0.001 to 1000000"))
        ->capture_default_str()
        ->type_name("S");
    app.add_option("-o,--output", line->options.out, "Folder to write to")->type_name("DIR")->required();
    app.add_flag("--json", line->as_json, "Print results.json instead of the table");
    return [line, &common] { return ladder(*line, common); };
}

}  // namespace umbra
