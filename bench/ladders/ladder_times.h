// What methods take on the first rung of a ladder: in turns, so that their ratios mean something.
#pragma once

#include <span>
#include <vector>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/run/budget.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct LadderTurns {
    int rounds       = 6;    ///< at most
    double budget_ms = 600;  ///< for all methods together, without their first runs
    Budget most{};           ///< of each run of a method: one that takes more is not timed
};

/// [method][round]: milliseconds of build, aim and visibility over all lights, as time_in_turns measures them: samples
/// with one index are of one round. Empty for a method that does not serve the scene, that throws there, or that takes
/// longer than the budget.
[[nodiscard]] std::vector<std::vector<double>> time_first_rung(const Ladder& ladder,
                                                               std::span<const MethodChoice> methods,
                                                               const LadderTurns& options = {});

}  // namespace umbra
