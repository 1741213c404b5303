#include "umbra/bench/studies/motion/growth.h"

#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"

namespace umbra {
namespace {

struct GrowthLine {
    bool as_json = false;
    GrowthCommand command;
};

int growth(GrowthLine line, const Common& common) {
    GrowthCommand& command = line.command;
    command.command        = common.command;
    command.threads        = thread_count();
    check_writable_beside(command.out);
    const PlaceLock lock      = PlaceLock::inside(command.out);
    const GrowthRecord record = on_terminal(common, command.options, [&] { return measure_growth(command); });
    if (line.as_json)
        print_out("{}", json_text(to_record(record)));
    else if (!common.quiet && !record.growth.empty())
        print_out("{}{}\n", growth_table(record), (command.out / "index.html").string());
    for (const ListedFailureRecord& f : record.failed)
        print_error("{}: {}: {}\n", f.family, f.method, f.failure.message);
    return record.failed.empty() ? kDone : kInternal;
}

}  // namespace

Action growth_command(CLI::App& app, const Common& common) {
    const auto line        = std::make_shared<GrowthLine>();
    GrowthCommand& command = line->command;
    app.add_option("--over", command.over,
                   "What grows: triangles, bodies, pixels, lights, samples, resolution (default: all)")
        ->type_name("SIZE");
    add_methods(app, command.methods);
    app.add_option("--max", command.most,
                   "The largest size, with one --over (default: triangles 1e6, pixels 2048 x 2048)")
        ->check(number_in(1, 1e12, "a number from 1 to 1e12"))
        ->type_name("N");
    add_number(app, "--rounds", command.options.turns.rounds, "Rounds of time at each size", 1, 1000);
    add_budget(app, command.options.turns.most);
    add_output(app, command.out);
    add_json(app, line->as_json);
    return [line, &common] { return growth(*line, common); };
}

}  // namespace umbra
