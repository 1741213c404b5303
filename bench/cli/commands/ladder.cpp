#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/ladders/ladder_record.h"

namespace umbra {

Action ladder_command(CLI::App& app, const Common& common) {
    struct Line {
        LadderOptions options;
        bool as_json = false;
    };
    const auto line = std::make_shared<Line>();
    app.add_option("LADDER", line->options.names,
                   "Ladders, or files of your own (docs/report.md; default: all of ours; umbra list names them)")
        ->type_name("");
    add_methods(app, line->options.methods,
                "Methods, with settings (default: all that reports show but exact, each also @textbook)");
    add_number(app, "--patience", line->options.patience_s,
               "Seconds of a thread: a method that takes longer on a rung is asked on no later one", 0.001, 1e6, "S");
    add_budget(app, line->options.budget);
    add_output(app, line->options.out);
    add_json(app, line->as_json);
    return [line, &common] {
        return_ladders(line->options.methods, line->options.names);
        const LaddersRecord record = climb_on_terminal(line->options, common);
        print_record(line->as_json, common, to_record(record), [&] { return ladder_table(record.ladders); });
        return record.failed.empty() ? kDone : kInternal;
    };
}

}  // namespace umbra
