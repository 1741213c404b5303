#include "umbra/bench/pages/report_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace umbra {
namespace {

using nlohmann::json;

constexpr double kWidth = 440, kHeight = 340, kLeft = 58, kRight = 430, kTop = 14, kBottom = 250, kZero = 278;

std::string coordinate(double x) { return fmt::format("{:.1f}", x); }

/// Whole decades around the values, never fewer than one.
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
        for (double e = low; e <= high; e += step) {
            const double value = std::pow(10, e);
            all.push_back({{"at", coordinate((*this)(value))}, {"label", fmt::format("{:g}", value)}});
        }
        return all;
    }
};

struct Rect {
    double x0, y0, x1, y1;
    bool meets(const Rect& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Marks differ in shape as well as in colour, so that they can be told apart in grey.
std::string mark(std::size_t style, double x, double y) {
    static constexpr std::array<std::string_view, 6> shapes = {
        "m-6 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0z", "m-5.5 -5.5h11v11h-11z", "m0 -7l6.5 11.5h-13z",
        "m0 -7.5l7.5 7.5l-7.5 7.5l-7.5 -7.5z",   "m0 7l6.5 -11.5h-13z",   "m-2 -6h4v4h4v4h-4v4h-4v-4h-4v-4h4z"};
    return fmt::format("M{:.1f} {:.1f}{}", x, y, shapes[style % shapes.size()]);
}

}  // namespace

json error_time_chart(const std::vector<ChartPoint>& points) {
    constexpr double least_ms = 1e-4;  // below this a clock says nothing
    std::vector<double> times, errors;
    for (const ChartPoint& p : points) {
        times.push_back(std::max(p.camera_ms, least_ms));
        times.push_back(std::max(p.object_ms, least_ms));
        if (p.error > 0) errors.push_back(p.error);
    }
    const LogAxis x(times, 1, kLeft + 12, kRight - 12), y(errors, 1e-3, kBottom, kTop + 8);

    std::vector<Rect> taken;
    json marks = json::array();
    for (const ChartPoint& p : points) {
        const double height = p.error > 0 ? y(p.error) : kZero;
        const double camera = x(std::max(p.camera_ms, least_ms)), object = x(std::max(p.object_ms, least_ms));
        for (const double at : {camera, object}) taken.push_back({at - 7, height - 7, at + 7, height + 7});
        taken.push_back({camera, height - 2, object, height + 2});
        marks.push_back({{"y", coordinate(height)},
                         {"x", coordinate(object)},
                         {"camera_x", coordinate(camera)},
                         {"shape", mark(p.style, object, height)},
                         {"camera_shape", mark(p.style, camera, height)},
                         {"key", mark(p.style, 14, 9)},
                         {"style", std::to_string(p.style % 6)},
                         {"label", p.label}});
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double px = std::stod(marks[i]["x"].get<std::string>()), py = std::stod(marks[i]["y"].get<std::string>());
        const double length = 6.6 * double(points[i].label.size());
        double best_x = px + 11, best_y = py + 4;
        bool placed = false;
        for (double away = 0; away <= 120 && !placed; away += 8)
            for (const auto& [dx, dy] : {std::pair{11.0, -away},
                                         {-11 - length, -away},
                                         {-length / 2, -14 - away},
                                         {11.0, away},
                                         {-11 - length, away},
                                         {-length / 2, 14 + away}}) {
                const Rect label{px + dx, py + dy - 7, px + dx + length, py + dy + 7};
                if (label.x0 < kLeft || label.x1 > kRight || label.y0 < kTop || label.y1 > kZero + 14) continue;
                if (std::any_of(taken.begin(), taken.end(), [&](const Rect& r) { return r.meets(label); })) continue;
                best_x = px + dx, best_y = py + dy + 4, placed = true;
                taken.push_back(label);
                break;
            }
        marks[i]["label_x"] = coordinate(best_x);
        marks[i]["label_y"] = coordinate(best_y);
    }
    return {{"width", fmt::format("{:g}", kWidth)},
            {"height", fmt::format("{:g}", kHeight)},
            {"x_ticks", x.ticks()},
            {"y_ticks", y.ticks()},
            {"marks", std::move(marks)}};
}

json rung_chart(const std::vector<std::string>& rungs, const std::vector<RungSeries>& series, double limit) {
    constexpr double bottom = 200, lane = 12, least = 1e-4;  // fewer than one point of such pictures
    const LogAxis y({least, 1}, least, bottom, kTop);
    const double lanes_end = bottom + lane * (double(series.size()) + 0.5);
    const double step      = (kRight - kLeft - 24) / std::max(1.0, double(rungs.size()) - 1);
    const auto x           = [&](std::size_t r) { return kLeft + 12 + step * double(r); };

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
            const double at    = share > 0 ? y(std::max(share, least)) : bottom + lane * (double(i) + 1);
            path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", x(r), at);
            dots += fmt::format("M{:.1f} {:.1f}m-2 0a2 2 0 1 0 4 0a2 2 0 1 0 -4 0z", x(r), at);
            if (s.breaks_at == r) broken = mark(s.style, x(r), at);
            down = true;
        }
        lines.push_back({{"style", std::to_string(s.style % 6)},
                         {"label", s.label},
                         {"path", path},
                         {"dots", dots},
                         {"broken", broken},
                         {"key", mark(s.style, 14, 9)}});
    }
    return {{"width", fmt::format("{:g}", kWidth)},
            {"height", coordinate(lanes_end + 46)},
            {"bottom", coordinate(lanes_end)},
            {"zero", coordinate(bottom + lane / 2)},
            {"zero_label", coordinate((bottom + lanes_end) / 2 + 5)},
            {"labels", coordinate(lanes_end + 16)},
            {"unit", coordinate(lanes_end + 38)},
            {"limit", coordinate(y(limit))},
            {"x_ticks", std::move(x_ticks)},
            {"y_ticks", y.ticks()},
            {"lines", std::move(lines)}};
}

}  // namespace umbra
