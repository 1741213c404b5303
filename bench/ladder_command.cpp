#include "bench/ladder_command.h"

#include "bench/ladder_record.h"
#include "bench/ladder_run.h"
#include "bench/results_file.h"
#include "bench/staged_files.h"

namespace umbra {

Json climb_ladders(const LadderOptions& options) {
    std::vector<const Ladder*> chosen;
    for (const std::string& name : options.names) chosen.push_back(&find_ladder(name));
    if (chosen.empty()) chosen.assign(ladders().begin(), ladders().end());
    std::vector<MethodChoice> methods_chosen;
    for (const std::string& text : options.methods) methods_chosen.push_back(parse_method(text));
    if (options.methods.empty())
        for (const MethodInfo* info : methods())
            if (info != &find_method("exact")) methods_chosen.push_back({info, Settings(info->parameters)});

    Json record = {{"schema", kResultsSchema},         {"version", version()},
                   {"command", options.command},       {"machine", machine_json(options.threads)},
                   {"breaking_share", kBreakingShare}, {"ladders", Json::array()}};
    for (const Ladder* ladder : chosen)
        record["ladders"].push_back(ladder_json(climb_ladder(*ladder, methods_chosen, options.progress)));

    StagedFiles staged;
    staged.write(options.out / "results.json", record.dump(1) + "\n");
    staged.commit();
    return record;
}

}  // namespace umbra
