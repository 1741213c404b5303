#include "umbra/bench/compare/method_times.h"

#include "umbra/bench/compare/record.h"
#include "umbra/bench/run/machine_load.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

void remove_files(const fs::path& folder, const Json& files) {
    for (const auto& item : files.items())
        if (item.value().is_string())
            fs::remove(folder / item.value().get<std::string>());
        else
            remove_files(folder, item.value());
}

}  // namespace

RunTimes times_of(const MethodRun& run) {
    RunTimes times{.build = run.build.median, .look = run.look.median};
    for (const Timing& t : run.aim) times.aim.push_back(t.median);
    for (const Timing& t : run.visibility) times.visibility.push_back(t.median);
    return times;
}

Json time_methods(const fs::path& folder, const PreparedScene& prepared, std::span<const MethodChoice> choices,
                  std::vector<Answered>& answered, const Repeats& repeats,
                  const std::function<void(const std::string&)>& tell) {
    std::vector<MethodChoice> timed;
    std::vector<std::size_t> which;
    TurnOptions turn_options;
    for (std::size_t k = 0; k < choices.size(); ++k) {
        if (!answered[k].first) continue;
        timed.push_back(choices[k]);
        which.push_back(k);
        turn_options.first.push_back(answered[k].first);
    }
    constexpr double phases = 4;
    turn_options.rounds     = repeats.max_runs;
    turn_options.budget_ms  = phases * repeats.budget_ms * static_cast<double>(timed.size());
    turn_options.progress   = [&](const std::string& what) { tell("times, " + what); };
    const double before     = load_average();
    const Turns turns       = time_in_turns(prepared, timed, turn_options);
    for (std::size_t t = 0; t < timed.size(); ++t) {
        Json& entry = answered[which[t]].entry;
        if (turns.settings[t].failed.empty()) {
            set_times(entry, prepared.scene, turns.settings[t]);
            continue;
        }
        // What throws when it runs again has no answers that anybody could rely on.
        remove_files(folder, entry["files"]);
        entry = failed_json(entry["id"], timed[t], prepared.scene, std::nullopt, turns.settings[t].failed);
    }
    return turns_json(turns, turn_options, {before, load_average()});
}

}  // namespace umbra
