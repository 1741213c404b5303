// How many triangles lie over one point of the light, counted with a segment from the surface point to it.
#pragma once

#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_visibility {

template <class Space>
class LayerCount {
public:
    using T = typename Space::Number;

    /// `projection` must outlive this object.
    explicit LayerCount(const Projection<Space>& projection) : projection_(projection) {}

    /// At the point (x, y) of the light. In doubles `blocker` becomes a triangle that hides the whole light, if the
    /// segment meets one.
    [[nodiscard]] Filtered<int> at(double x, double y, TriangleId& blocker) const;

    /// Whether triangle t surely hides the whole light.
    [[nodiscard]] bool covers_all(TriangleId t) const { return covers_all(projected(t)); }

private:
    struct Projected {
        TriangleId triangle;
        uvec3 vertex;
        Numerators<T> corner[3];
    };
    [[nodiscard]] Projected projected(TriangleId t) const {
        const uvec3 v = projection_.sight().occluders.corners[t];
        return {t, v, {projection_.project(v[0]), projection_.project(v[1]), projection_.project(v[2])}};
    }
    [[nodiscard]] Filtered<bool> lies_over(const Projected& t, double x, double y) const;
    [[nodiscard]] static bool leaves_a_side(const Projected& t);
    [[nodiscard]] bool covers_all(const Projected& t) const;

    const Projection<Space>& projection_;
};

/// Whether the segment from the surface point to the point (x, y) of the light passes through triangle t.
template <class Space>
Filtered<bool> LayerCount<Space>::lies_over(const Projected& t, double x, double y) const {
    const Numerators<T> direction{T(x), T(y), T(1), 0};
    const auto& corner = t.corner;
    // Three signs, of the direction and two corners each: all must be as that of the three corners.
    Filtered<int> signs[3];
    for (int k = 0; k < 3; ++k) signs[k] = sign_of(direction, corner[k], corner[(k + 1) % 3]);
    const auto one_is = [&](Filtered<int> s) { return signs[0] == s || signs[1] == s || signs[2] == s; };
    if (one_is(1) && one_is(-1)) return false;
    const int side = projection_.side_of(t.triangle);
    if (side == 0 || one_is(-side)) return false;
    if (one_is(kUnsure) || one_is(0)) return kUnsure;

    int before = 0;
    for (int k = 0; k < 3; ++k) {
        const Filtered<bool> beyond = projection_.beyond(t.vertex[k], corner[k]);
        if (!beyond) return kUnsure;
        before += !*beyond;
    }
    if (before == 3) return true;
    if (before == 0) return false;
    // The segment ends on the light's plane, and has passed the triangle where its two ends are on two sides of it.
    const Numerators<T> end      = projection_.space().on_light(x, y);
    const Filtered<int> end_side = sign_of(corner[0] - end, corner[1] - end, corner[2] - end);
    if (!end_side || *end_side == 0) return kUnsure;
    return *end_side == -side;
}

/// Whether all of its corners surely lie on one side of a side of the light: a point of that is a sum of the corners,
/// none of them less than 0 times.
template <class Space>
bool LayerCount<Space>::leaves_a_side(const Projected& t) {
    int beside = 15;  // one bit a side
    for (const Numerators<T>& c : t.corner) {
        const T error = T(4 * c.error);
        beside &= int{c.w + c.x > error} | int{c.w - c.x > error} << 1 | int{c.w + c.y > error} << 2 |
                  int{c.w - c.y > error} << 3;
    }
    return beside != 0;
}

template <class Space>
bool LayerCount<Space>::covers_all(const Projected& t) const {
    if (leaves_a_side(t)) return false;
    // As lies_over, at all four corners (+-1, +-1, 1) at once.
    int sign = 0;
    for (int k = 0; k < 3; ++k) {
        const Filtered<int> s = sign_over_light(t.corner[k], t.corner[(k + 1) % 3]);
        if (!s || (k > 0 && *s != sign)) return false;
        sign = *s;
    }
    if (projection_.side_of(t.triangle) != sign) return false;
    for (int k = 0; k < 3; ++k)
        if (projection_.beyond(t.vertex[k], t.corner[k]) != false) return false;
    return true;
}

template <class Space>
Filtered<int> LayerCount<Space>::at(double x, double y, TriangleId& blocker) const {
    const Sight& sight    = projection_.sight();
    const ExactPoint& p   = sight.viewpoint.point();
    const Entries centre  = p.to(sight.plane.centre_from_corner);
    const dvec3 across    = x * sight.plane.u + y * sight.plane.v;
    const double rounding = 2 * p.slack() + centre.error + 8 * kUnit * (largest(centre.value) + largest(across));
    Filtered<int> layers  = 0;
    const auto count      = [&](TriangleId t) {
        if (t == sight.viewpoint.own() || !sight.occluders.blocks(t)) return true;
        if (sight.viewpoint.surely_coplanar(t)) return true;
        const Projected seen      = projected(t);
        const Filtered<bool> over = lies_over(seen, x, y);
        if (!over) {
            layers = kUnsure;
            return false;
        }
        if (*over) ++*layers;
        if constexpr (std::is_same_v<T, double>) {
            if (*over && covers_all(seen)) blocker = t;
        }
        return true;
    };
    if (const auto* candidates = sight.over.pick(p, centre.value + across, rounding, x, y)) {
        for (const TriangleId t : *candidates)
            if (!count(t)) break;
    } else {
        sight.occluders.triangles.visit(BoxTree::Piece{p.rounded(), centre.value + across, 1.0, rounding}, count);
    }
    return layers;
}

}  // namespace umbra::exact_visibility
