#include "umbra/bench/pages/chart_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra::chart {

using nlohmann::json;

namespace {

/// 0.01, 0.1, 1, 10, 100; beyond that 10⁻⁵: short enough to fit beside the axis.
std::string decade(double exponent) {
    return std::abs(exponent) <= 2 ? fmt::format("{:g}", std::pow(10, exponent))
                                   : "10" + superscript(static_cast<int>(exponent));
}

}  // namespace

std::string coordinate(double x) { return fmt::format("{:.1f}", x); }

LogAxis::LogAxis(const std::vector<double>& values, double fallback, double from_, double to_) : from(from_), to(to_) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    low                      = std::floor(std::log10(values.empty() ? fallback : *least));
    high                     = std::max(low + 1, std::ceil(std::log10(values.empty() ? fallback : *most)));
}

double LogAxis::operator()(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }

json LogAxis::ticks() const {
    json all          = json::array();
    const double step = std::ceil((high - low) / 6);
    for (double e = low; e <= high; e += step)
        all.push_back({{"at", coordinate((*this)(std::pow(10, e)))}, {"label", decade(e)}});
    return all;
}

json LogAxis::fine_ticks() const {
    json all = ticks();
    if (high - low > 2) return all;
    for (double e = low; e < high; ++e)
        for (const int k : {2, 5}) {
            const double value = k * std::pow(10, e);
            all.push_back(
                {{"at", coordinate((*this)(value))},
                 {"label", std::abs(e) <= 2 ? fmt::format("{:g}", value) : fmt::format("{}·{}", k, decade(e))}});
        }
    return all;
}

std::string mark_path(std::size_t style, double x, double y) {
    static constexpr std::array<std::string_view, 6> shapes = {
        "m-6 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0z", "m-5.5 -5.5h11v11h-11z", "m0 -7l6.5 11.5h-13z",
        "m0 -7.5l7.5 7.5l-7.5 7.5l-7.5 -7.5z",   "m0 7l6.5 -11.5h-13z",   "m-2 -6h4v4h4v4h-4v4h-4v-4h-4v-4h4z"};
    return fmt::format("M{:.1f} {:.1f}{}", x, y, shapes[mark_style(style).shape]);
}

namespace {
/// Of text 12 high; bytes that continue UTF-8 have none.
double length_of(const std::string& label) {
    double length = 0;
    for (const char c : label) length += (c & 0xc0) == 0x80 ? 0 : 6.1;
    return length;
}
}  // namespace

std::optional<LabelPlaces::Position> LabelPlaces::first_free(const std::vector<Position>& positions, double length) {
    constexpr double rise = 9, fall = 3;
    for (const auto& [begin, baseline] : positions) {
        const Rect box{begin, baseline - rise, begin + length, baseline + fall};
        if (box.x0 < inside_.x0 || box.x1 > inside_.x1 || box.y0 < inside_.y0 || box.y1 > inside_.y1) continue;
        if (std::any_of(taken_.begin(), taken_.end(), [&](const Rect& b) { return b.meets(box); })) continue;
        taken_.push_back(box);
        return std::pair{begin, baseline};
    }
    return std::nullopt;
}

std::optional<std::pair<double, double>> LabelPlaces::place(double left, double right, double y,
                                                            const std::string& label) {
    const double length = length_of(label), middle = right - length / 2;
    return first_free({{right + 11, y + 4},
                       {left - 11 - length, y + 4},
                       {middle, y - 12},
                       {right - length + 6, y - 12},
                       {right - 6, y - 12},
                       {middle, y + 19},
                       {right - length + 6, y + 19},
                       {right - 6, y + 19}},
                      length);
}

std::optional<std::pair<double, double>> LabelPlaces::place_below_left(double x, double y, const std::string& label) {
    const double length = length_of(label);
    return first_free({{x - 6 - length, y + 17},
                       {x - length / 2, y + 19},
                       {x - 11 - length, y + 4},
                       {x + 6, y + 17},
                       {x + 11, y + 4},
                       {x - length / 2, y - 12},
                       {x + 6, y - 10},
                       {x - 12 - length, y + 28},
                       {x - 4 - length / 2, y + 32}},
                      length);
}

json frame(double height, double bottom) {
    return {{"width", fmt::format("{:g}", kWidth)},     {"height", coordinate(height)},
            {"left", fmt::format("{:g}", kLeft)},       {"right", fmt::format("{:g}", kRight)},
            {"top", fmt::format("{:g}", kTop)},         {"middle", coordinate((kLeft + kRight) / 2)},
            {"tick_x", fmt::format("{:g}", kLeft - 6)}, {"bottom", coordinate(bottom)},
            {"labels", coordinate(bottom + 16)},        {"x_title", coordinate(bottom + 38)}};
}

}  // namespace umbra::chart
