// Small charts, as numbers for the pages' templates to draw: error against time, and wrong points against a ladder's
// rungs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
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

/// One method on the rungs of a ladder: its share of wrong interior points, absent where it has no answer.
struct RungSeries {
    std::string label;
    std::vector<std::optional<double>> shares;  ///< one a rung
    std::optional<std::size_t> breaks_at;
    std::size_t style = 0;
};

/// Coordinates in a box 440 wide: the share is logarithmic, rungs are evenly spaced, since they are geometric. Methods
/// of which no point is wrong have a lane each beneath the axis; `limit` is the share above which a method breaks.
[[nodiscard]] nlohmann::json rung_chart(const std::vector<std::string>& rungs, const std::vector<RungSeries>& series,
                                        double limit);

}  // namespace umbra
