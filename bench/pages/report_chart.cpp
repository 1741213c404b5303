#include "umbra/bench/pages/report_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

// The frame of both charts. The ticks' labels, of at most 6 characters, lie between kTitle and kLeft.
constexpr double kWidth = 440, kLeft = 64, kRight = 430, kTop = 14, kLane = 32;

std::string coordinate(double x) { return fmt::format("{:.1f}", x); }

/// 0.01, 0.1, 1, 10, 100; beyond that 10⁻⁵: short enough to fit beside the axis.
std::string decade(double exponent) {
    return std::abs(exponent) <= 2 ? fmt::format("{:g}", std::pow(10, exponent))
                                   : "10" + superscript(static_cast<int>(exponent));
}

/// Whole decades around the values, at least one.
struct LogAxis {
    double low = 0, high = 1;  ///< log10
    double from = 0, to = 1;   ///< coordinates

    LogAxis(const std::vector<double>& values, double fallback, double from_, double to_) : from(from_), to(to_) {
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        low                      = std::floor(std::log10(values.empty() ? fallback : *least));
        high                     = std::max(low + 1, std::ceil(std::log10(values.empty() ? fallback : *most)));
    }
    double operator()(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }
    json ticks() const {
        json all          = json::array();
        const double step = std::ceil((high - low) / 6);
        for (double e = low; e <= high; e += step)
            all.push_back({{"at", coordinate((*this)(std::pow(10, e)))}, {"label", decade(e)}});
        return all;
    }
};

struct Rect {
    double x0, y0, x1, y1;
    bool meets(const Rect& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

std::string mark(std::size_t style, double x, double y) {
    static constexpr std::array<std::string_view, 6> shapes = {
        "m-6 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0z", "m-5.5 -5.5h11v11h-11z", "m0 -7l6.5 11.5h-13z",
        "m0 -7.5l7.5 7.5l-7.5 7.5l-7.5 -7.5z",   "m0 7l6.5 -11.5h-13z",   "m-2 -6h4v4h4v4h-4v4h-4v-4h-4v-4h4z"};
    return fmt::format("M{:.1f} {:.1f}{}", x, y, shapes[mark_style(style).shape]);
}

/// A point of the error-time chart in coordinates.
struct PlacedMark {
    double camera_x, x, y;
    double line_from;  ///< where the line that leads to the mark begins: at the axis, or at the mark itself
};

/// Where the label of each mark begins (x) and its baseline (y): right, left, above or below its own mark, where it
/// meets neither marks nor labels; nothing where there is no such position.
class LabelPlaces {
public:
    LabelPlaces(const std::vector<PlacedMark>& marks, double bottom) : bottom_(bottom) {
        for (const PlacedMark& m : marks) {
            for (const double x : {m.camera_x, m.x}) taken_.push_back({x - 8, m.y - 8, x + 8, m.y + 8});
            taken_.push_back({m.line_from, m.y - 2, m.x, m.y + 2});
        }
    }
    std::optional<std::pair<double, double>> place(const PlacedMark& m, const std::string& label) {
        constexpr double character = 6.1, rise = 9, fall = 3;  // of text 12 high
        double length = 0;
        for (const char c : label) length += (c & 0xc0) == 0x80 ? 0 : character;  // bytes that continue UTF-8
        const double middle = m.x - length / 2;
        for (const auto& [x, y] : {std::pair{m.x + 11, m.y + 4},
                                   {m.camera_x - 11 - length, m.y + 4},
                                   {middle, m.y - 12},
                                   {m.x - length + 6, m.y - 12},
                                   {m.x - 6, m.y - 12},
                                   {middle, m.y + 19},
                                   {m.x - length + 6, m.y + 19},
                                   {m.x - 6, m.y + 19}}) {
            const Rect label_box{x, y - rise, x + length, y + fall};
            if (label_box.x0 < kLeft + 2 || label_box.x1 > kRight || label_box.y0 < kTop || label_box.y1 > bottom_)
                continue;
            if (std::any_of(taken_.begin(), taken_.end(), [&](const Rect& r) { return r.meets(label_box); })) continue;
            taken_.push_back(label_box);
            return std::pair{x, y};
        }
        return std::nullopt;
    }

private:
    double bottom_;
    std::vector<Rect> taken_;
};

/// What both templates draw the frame from.
json frame(double height, double bottom) {
    return {{"width", fmt::format("{:g}", kWidth)},     {"height", coordinate(height)},
            {"left", fmt::format("{:g}", kLeft)},       {"right", fmt::format("{:g}", kRight)},
            {"top", fmt::format("{:g}", kTop)},         {"middle", coordinate((kLeft + kRight) / 2)},
            {"tick_x", fmt::format("{:g}", kLeft - 6)}, {"bottom", coordinate(bottom)},
            {"labels", coordinate(bottom + 16)},        {"x_title", coordinate(bottom + 38)}};
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

    LabelPlaces labels(places, bottom);
    json marks = json::array(), lines = json::array();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ChartPoint& p = points[i];
        const PlacedMark& m = places[i];
        json view           = {{"y", coordinate(m.y)},
                               {"x", coordinate(m.x)},
                               {"camera_x", coordinate(m.camera_x)},
                               {"shape", mark(p.style, m.x, m.y)},
                               {"camera_shape", mark(p.style, m.camera_x, m.y)},
                               {"key", mark(p.style, 14, 9)},
                               {"colour", std::to_string(mark_style(p.style).colour)},
                               {"label", p.label}};
        const auto label    = labels.place(m, p.label);
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
            if (s.breaks_at == r) broken = mark(s.style, x(r), at);
            down = true;
        }
        lines.push_back({{"colour", std::to_string(mark_style(s.style).colour)},
                         {"label", s.label},
                         {"path", path},
                         {"dots", dots},
                         {"broken", broken},
                         {"key", mark(s.style, 14, 9)}});
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
