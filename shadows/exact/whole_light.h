// A square or a disk for the sweep over the edges (covering.h): the parts of edges within it, and areas up to its rim.
//
//            _.--"""--._          Only edges within the light are swept (=). Those to its left (:) change the number of
//      :   .'   /=      '.  /     layers along the rim; those to its right, above and below change nothing.
//      :  /    /=  light  \/
//       : |   /=          /|
#pragma once

#include <algorithm>
#include <cmath>

#include "umbra/shadows/exact/active_edges.h"

namespace umbra::exact_visibility {

/// Part of a segment, from 0 at its lower end to 1 at its upper one; nothing where from >= to.
struct PartWithin {
    double from = 0, to = 0;
    [[nodiscard]] bool empty() const { return !(from < to); }
};

/// |x| <= 1 between the heights -1 and 1.
struct WholeSquare {
    /// The area between x = 0 and the rim on one side, and between two heights.
    [[nodiscard]] static double half_area(double low, double high) { return high - low; }
    /// For a segment at any height: ends have the same side of the rim in all segments that they belong to.
    [[nodiscard]] static PartWithin within(const PlanePoint<double>& low, const PlanePoint<double>& high) {
        const double dx   = high.x - low.x;
        const auto at     = [&](double side) { return std::clamp((side - low.x) / dx, 0.0, 1.0); };
        const bool low_in = std::abs(low.x) < 1, high_in = std::abs(high.x) < 1;
        if (low_in && high_in) return {0, 1};
        if (low_in) return {0, at(high.x < 0 ? -1 : 1)};
        if (high_in) return {at(low.x < 0 ? -1 : 1), 1};
        if ((low.x < 0) == (high.x < 0)) return {};
        return {at(low.x < 0 ? -1 : 1), at(high.x < 0 ? -1 : 1)};
    }
};

/// The unit disk.
struct WholeDisk {
    [[nodiscard]] static double half_area(double low, double high) {
        const auto below = [](double y) { return (y * std::sqrt((1 - y) * (1 + y)) + std::asin(y)) / 2; };
        return below(high) - below(low);
    }
    [[nodiscard]] static PartWithin within(const PlanePoint<double>& low, const PlanePoint<double>& high) {
        const double dx = high.x - low.x, dy = high.y - low.y;
        const auto beyond = [](const PlanePoint<double>& p) { return p.x * p.x + p.y * p.y - 1; };
        const double c = beyond(low), c_high = beyond(high);
        if (c < 0 && c_high < 0) return {0, 1};
        // a t^2 + 2 b t + c = 0 where the line meets the circle.
        const double a = dx * dx + dy * dy, b = low.x * dx + low.y * dy;
        const double quarter = b * b - a * c;
        if (c >= 0 && c_high >= 0 && !(quarter > 0)) return {};
        const double q   = -(b + std::copysign(std::sqrt(std::max(quarter, 0.0)), b));
        const double one = q / a, other = q == 0 ? one : c / q;
        const double from = std::min(one, other), to = std::max(one, other);
        if (c < 0) return {0, std::clamp(to, 0.0, 1.0)};
        if (c_high < 0) return {std::clamp(from, 0.0, 1.0), 1};
        return {std::max(from, 0.0), std::min(to, 1.0)};
    }
};

}  // namespace umbra::exact_visibility
