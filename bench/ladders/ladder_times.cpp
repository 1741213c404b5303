#include "umbra/bench/ladders/ladder_times.h"

#include "umbra/bench/run/prepare.h"
#include "umbra/bench/time/turns.h"

namespace umbra {

std::vector<std::vector<double>> time_first_rung(const Ladder& ladder, std::span<const MethodChoice> methods,
                                                 const LadderTurns& options) {
    const PreparedScene scene = prepare_scene(ladder.scene(ladder.rungs.front()), ladder.name, {});
    TurnOptions turns;
    turns.rounds           = options.rounds;
    turns.budget_ms        = options.budget_ms;
    turns.most             = options.most;
    turns.share_builds     = false;
    turns.calibration_loop = [] {};  // ratios within one run need none
    std::vector<std::vector<double>> times;
    for (const TurnTimes& t : time_in_turns(scene, methods, turns).settings)
        times.push_back(t.failed.empty() && !t.only_cold ? totals(t) : std::vector<double>{});
    return times;
}

}  // namespace umbra
