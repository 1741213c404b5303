#include "umbra/bench/sweep/trade_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/chart_parts.h"
#include "umbra/bench/pages/report_chart.h"

namespace umbra {
namespace {

using nlohmann::json;
using namespace chart;

constexpr double kLeastMs = 1e-4;  // below this a clock says nothing
constexpr double kAxisEnd = 250, kLane = 20;

double shown_ms(double ms) { return std::max(ms, kLeastMs); }

/// The lane of each method that has a setting without an error, by its style; in the order of the styles.
std::map<std::size_t, double> lanes_of(const std::vector<ParetoPoint>& points) {
    std::map<std::size_t, double> lanes;
    for (const ParetoPoint& p : points)
        if (!(p.error.worst > 0)) lanes[p.style] = 0;
    double at = kAxisEnd + 12 + kLane / 2;
    for (auto& [style, y] : lanes) {
        y = at;
        at += kLane;
    }
    return lanes;
}

struct Placed {
    double x, x_low, x_high;
    double y, y_low, y_high;  ///< `y_low` belongs to the smallest error: further down
};

Placed place(const ParetoPoint& p, const LogAxis& x, const LogAxis& y, const std::map<std::size_t, double>& lanes) {
    const auto height = [&](double error) {
        if (error > 0) return std::clamp(y(error), kTop, kAxisEnd + 6);
        return p.error.worst > 0 ? kAxisEnd + 6 : lanes.at(p.style);
    };
    return {x(shown_ms(p.cost.median)), x(shown_ms(p.cost.low)), x(shown_ms(p.cost.high)),
            height(p.error.worst),      height(p.error.least),   height(p.error.bound.value_or(p.error.worst))};
}

/// From the top of the cheapest setting of the front to the right end of the axis.
std::string staircase(const std::vector<ParetoPoint>& points, const std::vector<Placed>& places) {
    std::map<std::size_t, std::size_t> front;  // number to index
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i].front > 0) front[points[i].front] = i;
    std::string path;
    for (const auto& [number, i] : front)
        path += path.empty() ? fmt::format("M{:.1f} {:.1f}V{:.1f}", places[i].x, kTop, places[i].y)
                             : fmt::format("H{:.1f}V{:.1f}", places[i].x, places[i].y);
    return path.empty() ? path : path + fmt::format("H{:.1f}", kRight);
}

}  // namespace

json pareto_chart(const std::vector<ParetoPoint>& points) {
    std::vector<double> costs, errors;
    for (const ParetoPoint& p : points) {
        for (const double ms : {p.cost.low, p.cost.median, p.cost.high}) costs.push_back(shown_ms(ms));
        if (p.error.worst > 0) errors.insert(errors.end(), {p.error.worst, p.error.bound.value_or(p.error.worst)});
    }
    const LogAxis x(costs, 1, kLeft + 12, kRight - 12), y(errors, 1e-3, kAxisEnd, kTop + 8);
    const std::map<std::size_t, double> lanes = lanes_of(points);
    const double bottom                       = kAxisEnd + 12 + kLane * double(lanes.size());

    std::vector<Placed> places;
    for (const ParetoPoint& p : points) places.push_back(place(p, x, y, lanes));
    LabelPlaces labels({kLeft + 2, 0, kWidth, bottom});
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double half = points[i].front > 0 ? 8 : 5;
        labels.take({places[i].x - half, places[i].y - half, places[i].x + half, places[i].y + half});
    }
    const bool ranked = std::any_of(points.begin(), points.end(), [](const ParetoPoint& p) { return p.front > 0; });
    json marks        = json::array();
    // Settings of the front last, so that nothing covers them.
    for (const bool front : {false, true})
        for (std::size_t i = 0; i < points.size(); ++i) {
            const ParetoPoint& p = points[i];
            const Placed& m      = places[i];
            if ((p.front > 0) != front) continue;
            json view = {{"x", coordinate(m.x)},
                         {"y", coordinate(m.y)},
                         {"x_low", coordinate(m.x_low)},
                         {"x_high", coordinate(m.x_high)},
                         {"y_low", coordinate(m.y_low)},
                         {"y_high", coordinate(m.y_high)},
                         {"shape", mark_path(p.style, 0, 0)},
                         {"colour", std::to_string(mark_style(p.style).colour)},
                         {"words", p.words},
                         {"front", front ? std::to_string(p.front) : ""},
                         {"beaten", ranked && !front},
                         {"label_x", ""}};
            if (front)
                if (const auto label = labels.place_below_left(m.x, m.y, std::to_string(p.front))) {
                    view["label_x"] = coordinate(label->first);
                    view["label_y"] = coordinate(label->second);
                }
            marks.push_back(std::move(view));
        }
    json view          = frame(bottom + 46, bottom);
    view["y_middle"]   = coordinate((kTop + kAxisEnd) / 2);
    view["zero"]       = lanes.empty() ? "" : coordinate(kAxisEnd + 12);
    view["zero_label"] = coordinate((kAxisEnd + 12 + bottom) / 2 + 4);
    view["x_ticks"]    = x.fine_ticks();
    view["y_ticks"]    = y.fine_ticks();
    view["staircase"]  = staircase(points, places);
    view["marks"]      = std::move(marks);
    return view;
}

json profile_chart(const std::vector<ProfileCurve>& curves) {
    constexpr double axis_end   = 200;
    std::vector<double> factors = {1};
    for (const ProfileCurve& curve : curves)
        for (const auto& [factor, fraction] : curve.steps) factors.push_back(factor);
    const LogAxis x(factors, 1, kLeft + 12, kRight - 12);
    const auto y = [&](double fraction) { return axis_end + fraction * (kTop + 8 - axis_end); };

    json lines = json::array(), y_ticks = json::array();
    for (const ProfileCurve& curve : curves) {
        std::string path;
        double last = 0;
        for (const auto& [factor, fraction] : curve.steps) {
            path += path.empty() ? fmt::format("M{:.1f} {:.1f}", x(factor), y(fraction))
                                 : fmt::format("H{:.1f}V{:.1f}", x(factor), y(fraction));
            last = fraction;
        }
        if (!path.empty()) path += fmt::format("H{:.1f}", kRight);
        lines.push_back({{"label", curve.label},
                         {"colour", std::to_string(mark_style(curve.style).colour)},
                         {"path", path},
                         {"mark", path.empty() ? "" : mark_path(curve.style, kRight, y(last))},
                         {"key", mark_path(curve.style, 14, 9)}});
    }
    for (const int percent : {0, 25, 50, 75, 100})
        y_ticks.push_back({{"at", coordinate(y(percent / 100.0))}, {"label", fmt::format("{} %", percent)}});
    json view        = frame(axis_end + 58, axis_end + 12);
    view["y_middle"] = coordinate((kTop + axis_end) / 2);
    view["x_ticks"]  = x.fine_ticks();
    view["y_ticks"]  = std::move(y_ticks);
    view["lines"]    = std::move(lines);
    return view;
}

}  // namespace umbra
