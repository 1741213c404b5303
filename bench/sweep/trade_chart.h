// The charts of the page of sweeps, as coordinates for its templates.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "umbra/bench/sweep/swept_scene.h"

namespace umbra {

/// One setting on the plot of error against frame cost.
struct ParetoPoint {
    std::string words;  ///< its setting and figures, shown where a pointer rests on the mark
    FrameCost cost;
    SweptError error;
    std::size_t style = 0;  ///< of its method (mark_style)
    std::size_t front = 0;  ///< its number on the front, from 1, by ascending cost; 0 where another setting beats it,
                            ///< or where there is no front
};

/// Both axes are logarithmic; lines through a mark are the quartiles of its cost, and its error from the best view to
/// the upper bound. Settings without an error have no logarithm: each method that has some gets a lane below the axis.
/// `staircase` runs through the front: up to the cost of the next setting, the error of the last one is what is to be
/// had.
[[nodiscard]] nlohmann::json pareto_chart(const std::vector<ParetoPoint>& points);

/// One method of a performance profile: at each factor (at least 1, ascending) the fraction of the problems, [0, 1],
/// that it solves within that factor of the cheapest.
struct ProfileCurve {
    std::string label;
    std::size_t style = 0;
    std::vector<std::pair<double, double>> steps;
};

/// Factors are logarithmic, from 1 to the last step of all curves.
[[nodiscard]] nlohmann::json profile_chart(const std::vector<ProfileCurve>& curves);

}  // namespace umbra
