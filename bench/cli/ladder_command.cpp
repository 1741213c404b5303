#include "umbra/bench/cli/ladder_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/ladders/ladder_break.h"
#include "umbra/bench/ladders/ladder_page.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/bench/out/files.h"
#include "umbra/bench/out/own_files.h"
#include "umbra/bench/out/staged_folder.h"
#include "umbra/bench/run/results_file.h"
#include "umbra/bench/run/steps.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// Writes the scene that breaks a method, and its pictures.
void add_break(Json& method, const std::filesystem::path& folder, const LadderRun& run, std::size_t m) {
    const auto same = std::count_if(run.methods.begin(), run.methods.begin() + std::ptrdiff_t(m),
                                    [&](const MethodChoice& other) { return other.info == run.methods[m].info; });
    const std::string name =
        fmt::format("{}.{}{}", run.ladder->name, run.methods[m].info->name, same ? fmt::format("-{}", same + 1) : "");
    method["break"] = write_break(folder, name, *run.ladder, method["breaks_at"], run.methods[m]);
}

}  // namespace

Json climb_ladders(const LadderOptions& options) {
    if (holds_record_without(options.out, "ladders"))
        throw InputError(
            fmt::format("{}: holds the results of another command and is not replaced, expected another folder "
                        "with -o",
                        options.out.string()));
    std::vector<const Ladder*> chosen;
    for (const std::string& name : options.names) chosen.push_back(&find_ladder(name));
    if (chosen.empty()) chosen.assign(ladders().begin(), ladders().end());
    std::vector<MethodChoice> methods_chosen;
    for (const std::string& text : options.methods) methods_chosen.push_back(parse_method(text));
    if (options.methods.empty())
        for (const MethodInfo* info : methods())
            if (info->by_default && !info->reference) methods_chosen.emplace_back(*info);

    Json record = {{"schema", kResultsSchema},         {"version", version()},
                   {"command", options.command},       {"machine", machine_json(options.threads)},
                   {"breaking_share", kBreakingShare}, {"ladders", Json::array()},
                   {"failed", Json::array()}};
    StagedFolder staged(options.out);
    std::filesystem::create_directory(staged.folder() / "breaks");
    Steps steps(chosen.size(), options.progress);
    const auto progress = [&](const std::string& what) { steps.show(what); };
    for (const Ladder* ladder : chosen) {
        steps.next();
        const auto fail = [&](const std::string& method) {
            record["failed"].push_back({{"ladder", ladder->name},
                                        {"rung", nullptr},
                                        {"method", method},
                                        {"light", nullptr},
                                        {"message", current_message()}});
        };
        try {
            const LadderRun run = climb_ladder(*ladder, methods_chosen, progress);
            Json entry          = ladder_json(run);
            for (Json& failed : failed_climbs_json(run)) record["failed"].push_back(std::move(failed));
            for (std::size_t m = 0; m < run.methods.size(); ++m) {
                const Climb c = climb(run, m);
                if (!c.breaks_at || !run.rungs[*c.breaks_at].outcomes[m].ran()) continue;
                progress(fmt::format("{}: what breaks {}", ladder->name, run.methods[m].text()));
                try {
                    add_break(entry["methods"][m], staged.folder() / "breaks", run, m);
                } catch (const InputError&) {  // a file that cannot be written
                    throw;
                } catch (...) {
                    fail(run.methods[m].text());
                }
            }
            record["ladders"].push_back(std::move(entry));
        } catch (const InputError&) {
            throw;
        } catch (...) {
            fail("the ladder");
        }
    }
    write_text(staged.folder() / "results.json", json_text(record));
    write_ladder_page(staged.folder());
    staged.commit();
    return record;
}

}  // namespace umbra
