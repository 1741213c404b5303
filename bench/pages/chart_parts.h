// Parts of charts as coordinates for the pages' templates: the frame, logarithmic axes, marks, positions of labels.
// All charts are 440 wide.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace umbra::chart {

/// The ticks' labels, of at most 6 characters, lie between the title of the axis and kLeft.
inline constexpr double kWidth = 440, kLeft = 64, kRight = 430, kTop = 14;

/// One digit after the point.
[[nodiscard]] std::string coordinate(double x);

/// Whole decades around the values, at least one. Values are positive.
struct LogAxis {
    double low = 0, high = 1;  ///< log10
    double from = 0, to = 1;   ///< coordinates

    LogAxis(const std::vector<double>& values, double fallback, double from, double to);
    [[nodiscard]] double operator()(double value) const;
    /// {at, label} of at most 7 decades: 0.01, 0.1, 1, 10, 100, beyond that 10⁻⁵.
    [[nodiscard]] nlohmann::json ticks() const;
    /// The same, and 2 and 5 times each decade where there are at most two decades.
    [[nodiscard]] nlohmann::json fine_ticks() const;
};

/// The outline of a mark, 12 to 15 across, with its centre at x, y: the path of an SVG.
[[nodiscard]] std::string mark_path(std::size_t style, double x, double y);

struct Rect {
    double x0, y0, x1, y1;
    [[nodiscard]] bool meets(const Rect& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Positions of labels of text 12 high that cover neither each other nor what is taken.
class LabelPlaces {
public:
    explicit LabelPlaces(const Rect& inside) : inside_(inside) {}
    void take(const Rect& box) { taken_.push_back(box); }
    /// Where the label begins (x) and its baseline (y): right, left, above or below a mark that reaches from `left` to
    /// `right` (centres) at the height y; nothing where each of these positions covers something or leaves the frame.
    [[nodiscard]] std::optional<std::pair<double, double>> place(double left, double right, double y,
                                                                 const std::string& label);
    /// The same for a single mark on a front of points where less is better: below it and to its left first, where
    /// neither the front nor other marks are.
    [[nodiscard]] std::optional<std::pair<double, double>> place_below_left(double x, double y,
                                                                            const std::string& label);

private:
    using Position = std::pair<double, double>;
    std::optional<Position> first_free(const std::vector<Position>& positions, double length);

    Rect inside_;
    std::vector<Rect> taken_;
};

/// What the templates draw the frame from; `bottom` is the lower end of the vertical axis.
[[nodiscard]] nlohmann::json frame(double height, double bottom);

}  // namespace umbra::chart
