// Small charts, as coordinates for the pages' templates to draw: error against time, wrong points against the rungs of a
// ladder, and what was measured beside its formula. All are 440 wide.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace umbra {

/// Marks differ in shape and colour; the first 36 styles are distinct, then they repeat.
struct MarkStyle {
    std::size_t colour, shape;  ///< of 6 each
};
[[nodiscard]] MarkStyle mark_style(std::size_t style);

/// One method: the time of a new camera and of a full rebuild (ms), and its mean absolute error.
struct ChartPoint {
    std::string label;
    double camera_ms = 0, object_ms = 0, error = 0;
    std::size_t style = 0;
};

/// Ticks, marks and labels. Both axes are logarithmic. Methods without error have no logarithm: each gets a lane of its
/// own below the axis. A label lies beside its mark where it covers nothing else, and is left out where it cannot:
/// the legend below the chart names every mark.
[[nodiscard]] nlohmann::json error_time_chart(const std::vector<ChartPoint>& points);

/// One method on the rungs of a ladder: its share of wrong interior points, absent where it has no answer.
struct RungSeries {
    std::string label;
    std::vector<std::optional<double>> shares;  ///< one per rung
    std::optional<std::size_t> breaks_at;
    std::size_t style = 0;
    bool dashed       = false;  ///< a second form of the method that has this style, too
};

/// The share is logarithmic; rungs are geometric and so evenly spaced. Rungs without a wrong point lie in the lane of
/// their method below the axis; `limit` is the share above which a method breaks.
[[nodiscard]] nlohmann::json rung_chart(const std::vector<std::string>& rungs, const std::vector<RungSeries>& series,
                                        double limit);

/// Values at the same x: measured ones as dots, their formula as a line, which is dashed where nothing was measured.
struct FormulaSeries {
    std::string label;
    std::vector<double> x, measured, formula;  ///< not finite in `formula`: left open there
};

/// Both axes are linear; that of values begins at 0 unless some are negative.
[[nodiscard]] nlohmann::json formula_chart(const std::vector<FormulaSeries>& series);

}  // namespace umbra
