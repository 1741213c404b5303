// The plane of the point's triangle, and the part of the light that is before it.
#pragma once

#include "umbra/shadows/exact/covering.h"
#include "umbra/shadows/exact/disk_caps.h"
#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_visibility {

/// The point (x, y) of the light is at height lx x + ly y + l over the plane, in some positive unit.
template <class T>
struct Horizon {
    T lx, ly, l;
    double error  = 0;  ///< of a height where |x|, |y| <= 1; 0 in rationals
    double normal = 0;  ///< height of a point one unit of length before the plane

    [[nodiscard]] T height(const T& x, const T& y) const { return T(lx * x + ly * y + l); }
    [[nodiscard]] double slope() const { return std::hypot(as_double(lx), as_double(ly)); }
    /// How far rounding may have moved the line of height 0. Infinite where there is none.
    [[nodiscard]] double off() const {
        if (std::is_same_v<T, Rational>) return 0;
        return slope() > 0 ? 4 * error / slope() : double(kInfinity);
    }
};

inline Horizon<double> rounded(const Horizon<double>& horizon) { return horizon; }
inline Horizon<double> rounded(const Horizon<Rational>& h) {
    const double lx = as_double(h.lx), ly = as_double(h.ly), l = as_double(h.l);
    return {lx, ly, l, 4 * kUnit * (std::abs(lx) + std::abs(ly) + std::abs(l)), h.normal};
}

template <class T>
Horizon<T> horizon_of(const Sight& sight);
template <>
Horizon<double> horizon_of<double>(const Sight& sight);
template <>
Horizon<Rational> horizon_of<Rational>(const Sight& sight);

/// Cuts off what lies behind the plane from a convex polygon of the light.
template <class T>
std::vector<LightCorner<T>> before_horizon(const std::vector<LightCorner<T>>& corners, const Horizon<T>& horizon) {
    std::vector<LightCorner<T>> kept;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const LightCorner<T>&p = corners[k], &q = corners[(k + 1) % corners.size()];
        const T hp = horizon.height(p.x, p.y), hq = horizon.height(q.x, q.y);
        if (hp > 0) kept.push_back(p);
        if ((hp > 0) == (hq > 0)) continue;
        const T t = hp / (hp - hq);
        // On the way out the plane's line begins, on the way in the rest of the light's own side.
        kept.push_back({T(p.x + t * (q.x - p.x)), T(p.y + t * (q.y - p.y)), hp > 0 ? -1 : p.cap});
    }
    return kept;
}

/// Leaves open the caps that the line of height 0 may touch.
template <class T>
void touch_caps(const Horizon<T>& horizon, DiskCaps& caps) {
    const double x = as_double(horizon.lx), y = as_double(horizon.ly), slope = horizon.slope();
    if (!(slope > 0)) return;
    // Two units to both sides of the foot of the centre on the line.
    const double distance = -as_double(horizon.l) / slope, nx = x / slope, ny = y / slope;
    caps.touch(distance * nx - 2 * ny, distance * ny + 2 * nx, distance * nx + 2 * ny, distance * ny - 2 * nx);
}

}  // namespace umbra::exact_visibility
