#include "umbra/bench/pages/report_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// Coordinates between two ends; a range of a single value is widened.
struct LinearAxis {
    double low, high, from, to;

    LinearAxis(double low_, double high_, double from_, double to_)
        : low(low_), high(high_ > low_ ? high_ : low_ + 1), from(from_), to(to_) {}
    double operator()(double value) const { return from + (value - low) / (high - low) * (to - from); }
    /// At multiples of 1, 2 or 5 times a power of ten, at most 7.
    [[nodiscard]] json ticks() const {
        const double decade = std::pow(10, std::floor(std::log10((high - low) / 6)));
        double step         = 10 * decade;
        for (const double part : {5.0, 2.0, 1.0})
            if ((high - low) / (part * decade) <= 6.5) step = part * decade;
        json all = json::array();
        for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
            all.push_back({{"at", coordinate((*this)(k * step))}, {"label", fmt::format("{:g}", k * step + 0.0)}});
        return all;
    }
};

/// At least 80 points, the ends, and both sides of a jump of more than 3; the pen is lifted where a value is not finite.
std::string formula_path(const FormulaSeries& of, const LinearAxis& x, const LinearAxis& y) {
    std::string path;
    bool down         = false;
    const auto stride = std::max<std::size_t>(1, of.x.size() / 80);
    const auto height = [&](std::size_t k) { return y(of.formula[k]); };
    const auto jumps  = [&](std::size_t k) { return std::abs(height(k) - height(k - 1)) > 3; };
    for (std::size_t k = 0; k < of.x.size(); ++k) {
        if (!std::isfinite(of.formula[k])) {
            down = false;
            continue;
        }
        const bool at_end = !down || k + 1 == of.x.size() || !std::isfinite(of.formula[k + 1]);
        if (!at_end && k % stride != 0 && !jumps(k) && !jumps(k + 1)) continue;
        path += fmt::format("{}{:.1f} {:.1f}", down ? 'L' : 'M', x(of.x[k]), height(k));
        down = true;
    }
    return path;
}

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

json formula_chart(const std::vector<FormulaSeries>& series) {
    constexpr double bottom = 220, kDots = 40, kOff = 0.02;
    double least_x = HUGE_VAL, most_x = -HUGE_VAL, least = 0, most = 0;
    for (const FormulaSeries& s : series) {
        for (const double at : s.x) least_x = std::min(least_x, at), most_x = std::max(most_x, at);
        for (const auto* values : {&s.measured, &s.formula})
            for (const double value : *values)
                if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
    }
    const LinearAxis x(least_x, most_x, kLeft, kRight), y(least, most, bottom, kTop);
    json lines = json::array();
    for (std::size_t i = 0; i < series.size(); ++i) {
        const FormulaSeries& s = series[i];
        std::string dots;
        const auto stride = static_cast<std::size_t>(std::ceil(static_cast<double>(s.measured.size()) / kDots));
        // In turns, so that no curve covers another, and wherever the formula says nothing or something else.
        const auto shown = [&](std::size_t k) {
            return k % stride == i % stride || !(std::abs(s.measured[k] - s.formula[k]) <= kOff * (most - least));
        };
        for (std::size_t k = 0; k < s.measured.size(); ++k)
            if (shown(k) && std::isfinite(s.measured[k]))
                dots += fmt::format("M{:.1f} {:.1f}h0", x(s.x[k]), y(s.measured[k]));
        lines.push_back({{"colour", std::to_string(mark_style(i).colour)},
                         {"label", s.label},
                         {"path", formula_path(s, x, y)},
                         {"dots", dots},
                         {"dashed", s.measured.empty()}});
    }
    json view       = frame(bottom + 46, bottom);
    view["x_ticks"] = x.ticks();
    view["y_ticks"] = y.ticks();
    view["lines"]   = std::move(lines);
    return view;
}

}  // namespace umbra
