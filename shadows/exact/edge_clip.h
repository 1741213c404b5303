// Cuts projected edges off around the light.
//
//      .-------------------.  reach     What lies outside of |x|, |y| <= reach covers nothing of the light. An edge
//      |    .---------.    |            that leaves the square ends on its rim; where it does so on the left, the sweep
//   ---+----+---*     |    |            counts it in and out (Covering::add), elsewhere the gap is of no consequence.
//      |    |  light  |    |
//      |    '---------'    |
//      '-------------------'
#pragma once

#include "umbra/shadows/exact/covering.h"
#include "umbra/shadows/exact/numerators.h"

namespace umbra::exact_visibility {

/// Chosen: so far outside the light, |x|, |y| <= 1, that no rounding of a cut reaches it.
inline constexpr double kCutReach = 1 + 1.0 / 16;

/// Where edges are looked for: beyond kCutReach, so that no rounding of a test loses one that is cut there.
inline constexpr double kGatherReach = 1 + 1.0 / 8;

template <class T>
struct ClippedEdge {
    bool empty = true;  ///< nothing of the edge is left, and the rest means nothing
    typename Covering<T>::Point from{}, to{};
    bool from_left = false, to_left = false;  ///< cut off on the square's left side
    double off = 0;                           ///< how far rounding may have moved an end in x and in y
};

/// For the edge from a to b, and the square |x|, |y| <= around.
template <class T>
Filtered<ClippedEdge<T>> clip_around_light(const Numerators<T>& a, const Numerators<T>& b, double around) {
    const T reach(around);
    const T inside_a[] = {a.x + reach * a.w, reach * a.w - a.x, a.y + reach * a.w, reach * a.w - a.y};
    const T inside_b[] = {b.x + reach * b.w, reach * b.w - b.x, b.y + reach * b.w, reach * b.w - b.y};
    double error       = 0;
    if constexpr (std::is_same_v<T, double>) {
        const double size =
            std::max({std::abs(a.x), std::abs(a.y), std::abs(a.w), std::abs(b.x), std::abs(b.y), std::abs(b.w)});
        error = std::max(a.error, b.error) + 8 * kUnit * size;
        // Next to the point itself an end's side of the square may be noise, far from the point it does not matter.
        const auto lost = [&](const T(&inside)[4], double w) {
            if (w > 16 * error) return false;
            for (const T& d : inside)
                if (std::abs(d) <= (around + 2) * error) return true;
            return false;
        };
        if (lost(inside_a, a.w) || lost(inside_b, b.w)) return kUnsure;
    }
    T from(0), to(1);
    double doubt = 0;                // of from and to
    int cut_from = -1, cut_to = -1;  // side of the square; 0: left
    for (int k = 0; k < 4; ++k) {
        const bool out_a = inside_a[k] <= 0, out_b = inside_b[k] <= 0;
        if (out_a && out_b) return ClippedEdge<T>{};
        if (!out_a && !out_b) continue;
        const T t = inside_a[k] / (inside_a[k] - inside_b[k]);
        if constexpr (std::is_same_v<T, double>)
            doubt = std::max(doubt, 4 * (around + 2) * error / std::abs(inside_a[k] - inside_b[k]));
        if (out_a && t >= from) from = t, cut_from = k;
        if (out_b && t <= to) to = t, cut_to = k;
    }
    if constexpr (std::is_same_v<T, double>)
        if (std::abs(from - to) <= doubt) return kUnsure;
    if (from >= to) return ClippedEdge<T>{};
    const Numerators<T> low  = cut_from < 0 ? a : between(a, b, from);
    const Numerators<T> high = cut_to < 0 ? b : between(a, b, to);
    double off               = 0;
    if constexpr (std::is_same_v<T, double>) {
        // |x|, |y| <= kCutReach, say: a quotient is off by less than 3 errors over w; an end that is cut, by its cut,
        // too. That w exceeds 16 errors makes such first-order bounds hold with a factor to spare.
        const double w = std::min(low.w, high.w);
        if (!(w > 16 * error)) return kUnsure;
        off = 8 * error / w + 2 * kUnit;
    } else {
        if (low.w == 0 || high.w == 0) return ClippedEdge<T>{};  // through the surface point: projected to one point
    }
    return ClippedEdge<T>{
        false, {low.x / low.w, low.y / low.w}, {high.x / high.w, high.y / high.w}, cut_from == 0, cut_to == 0, off};
}

}  // namespace umbra::exact_visibility
