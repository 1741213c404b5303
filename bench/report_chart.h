// A small chart of error against time, both logarithmic, as numbers for the page's template to draw.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace umbra {

/// One method: what a new camera costs, what everything anew costs (ms), and its error; `style` picks colour and mark.
struct ChartPoint {
    std::string label;
    double camera_ms = 0, object_ms = 0, error = 0;
    std::size_t style = 0;
};

/// Coordinates in a 440 x 340 box: ticks, marks, and labels placed where they cover neither marks nor one another.
/// An error of 0 has no logarithm: it lies on a line of its own beneath the axis.
[[nodiscard]] nlohmann::json error_time_chart(const std::vector<ChartPoint>& points);

}  // namespace umbra
