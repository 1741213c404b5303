// What methods take on the first rung of a ladder: in turns, so that their ratios mean something.
#pragma once

#include <span>
#include <vector>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// At most `rounds`, fewer where they take longer than the budget, at least one.
struct LadderTurns {
    int rounds       = 6;
    double budget_ms = 600;
};

/// [method][round]: milliseconds of build, aim and visibility over all lights. A round runs each method once, every
/// other round backwards; a round before the first one is not counted. Empty for a method that does not serve the scene
/// or that throws there.
[[nodiscard]] std::vector<std::vector<double>> time_first_rung(const Ladder& ladder,
                                                               std::span<const MethodChoice> methods,
                                                               const LadderTurns& turns = {});

}  // namespace umbra
