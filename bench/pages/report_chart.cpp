#include "umbra/bench/pages/report_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/chart_parts.h"

namespace umbra {
namespace {

using nlohmann::json;

using namespace chart;

constexpr double kLane = 32;

/// A point of the error-time chart in coordinates.
struct PlacedMark {
    double camera_x, x, y;
    double line_from;  ///< where the line that leads to the mark begins: at the axis, or at the mark itself
};

}  // namespace

MarkStyle mark_style(std::size_t style) { return {style % 6, (style % 6 + style / 6) % 6}; }

json error_time_chart(const std::vector<ChartPoint>& points) {
    constexpr double least_ms = 1e-4;  // below this a clock says nothing
    constexpr double axis_end = 250;
    std::vector<double> times, errors;
    for (const ChartPoint& p : points) {
        times.push_back(std::max(p.camera_ms, least_ms));
        times.push_back(std::max(p.object_ms, least_ms));
        if (p.error > 0) errors.push_back(p.error);
    }
    const LogAxis x(times, 1, kLeft + 12, kRight - 12), y(errors, 1e-3, axis_end, kTop + 8);

    std::vector<PlacedMark> places;
    std::vector<double> lanes;
    for (const ChartPoint& p : points) {
        const bool right = !(p.error > 0);
        if (right) lanes.push_back(axis_end + 8 + kLane * (double(lanes.size()) + 0.5));
        const double camera_x = x(std::max(p.camera_ms, least_ms));
        places.push_back({camera_x, x(std::max(p.object_ms, least_ms)), right ? lanes.back() : y(p.error),
                          right ? kLeft : camera_x});
    }
    const double bottom = lanes.empty() ? axis_end + 12 : lanes.back() + kLane / 2;

    LabelPlaces labels({kLeft + 2, kTop, kRight, bottom});
    for (const PlacedMark& m : places) {
        for (const double at : {m.camera_x, m.x}) labels.take({at - 8, m.y - 8, at + 8, m.y + 8});
        labels.take({m.line_from, m.y - 2, m.x, m.y + 2});
    }
    json marks = json::array(), lines = json::array();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ChartPoint& p = points[i];
        const PlacedMark& m = places[i];
        json view           = {{"y", coordinate(m.y)},
                               {"x", coordinate(m.x)},
                               {"camera_x", coordinate(m.camera_x)},
                               {"shape", mark_path(p.style, m.x, m.y)},
                               {"camera_shape", mark_path(p.style, m.camera_x, m.y)},
                               {"key", mark_path(p.style, 14, 9)},
                               {"colour", std::to_string(mark_style(p.style).colour)},
                               {"label", p.label}};
        const auto label    = labels.place(m.camera_x, m.x, m.y, p.label);
        view["label_x"]     = label ? coordinate(label->first) : "";
        view["label_y"]     = label ? coordinate(label->second) : "";
        marks.push_back(std::move(view));
    }
    // A lane's line leads from the axis to the mark and ends there, so that nothing runs through the label behind it.
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!(points[i].error > 0))
            lines.push_back({{"at", coordinate(places[i].y)}, {"end", coordinate(places[i].camera_x)}});
    json view          = frame(bottom + 46, bottom);
    view["y_middle"]   = coordinate((kTop + axis_end) / 2);
    view["zero_label"] = lanes.empty() ? "" : coordinate((lanes.front() + lanes.back()) / 2 + 4);
    view["x_ticks"]    = x.ticks();
    view["y_ticks"]    = y.ticks();
    view["lanes"]      = std::move(lines);
    view["marks"]      = std::move(marks);
    return view;
}

json rung_chart(const std::vector<std::string>& rungs, const std::vector<RungSeries>& series, double limit) {
    constexpr double axis_end = 200, lane = 12, least = 1e-4;  // less than one point of such pictures
    const LogAxis y({least, 1}, least, axis_end, kTop);
    const double bottom = axis_end + lane * (double(series.size()) + 0.5);
    const double step   = (kRight - kLeft - 24) / std::max(1.0, double(rungs.size()) - 1);
    const auto x        = [&](std::size_t r) { return kLeft + 12 + step * double(r); };

    json x_ticks = json::array(), lines = json::array();
    const std::size_t stride = std::max<std::size_t>(1, (rungs.size() + 5) / 6);
    for (std::size_t r = 0; r < rungs.size(); ++r)
        if (r % stride == 0 || rungs.size() == 1) x_ticks.push_back({{"at", coordinate(x(r))}, {"label", rungs[r]}});
    for (std::size_t i = 0; i < series.size(); ++i) {
        const RungSeries& s = series[i];
        std::string path, dots, broken;
        bool down = false;  // the pen: lifted where there is no answer
        for (std::size_t r = 0; r < s.shares.size(); ++r) {
            if (!s.shares[r]) {
                down = false;
                continue;
            }
            const double share = *s.shares[r];
            const double at    = share > 0 ? y(std::max(share, least)) : axis_end + lane * (double(i) + 1);
            path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", x(r), at);
            dots += fmt::format("M{:.1f} {:.1f}m-2 0a2 2 0 1 0 4 0a2 2 0 1 0 -4 0z", x(r), at);
            if (s.breaks_at == r) broken = mark_path(s.style, x(r), at);
            down = true;
        }
        lines.push_back({{"colour", std::to_string(mark_style(s.style).colour)},
                         {"label", s.label},
                         {"path", path},
                         {"dots", dots},
                         {"broken", broken},
                         {"dashed", s.dashed},
                         {"key", mark_path(s.style, 14, 9)}});
    }
    json view          = frame(bottom + 46, bottom);
    view["y_middle"]   = coordinate((kTop + axis_end) / 2);
    view["zero"]       = coordinate(axis_end + lane / 2);
    view["zero_label"] = coordinate((axis_end + bottom) / 2 + 5);
    view["limit"]      = coordinate(y(limit));
    view["x_ticks"]    = std::move(x_ticks);
    view["y_ticks"]    = y.ticks();
    view["lines"]      = std::move(lines);
    return view;
}

}  // namespace umbra
