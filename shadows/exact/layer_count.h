// How many triangles lie over one point of the light, counted with a segment from the surface point to it.
#pragma once

#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_detail {

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
    [[nodiscard]] bool covers_all(TriangleId t) const;

private:
    enum class Extent : std::uint8_t { any, before_light };
    [[nodiscard]] Filtered<bool> lies_over(TriangleId t, double x, double y, Extent extent) const;

    const Projection<Space>& projection_;
};

/// Whether the segment from the surface point to the point (x, y) of the light passes through triangle t. With
/// `before_light`: no, where not all of the triangle is in front of the light's plane.
template <class Space>
Filtered<bool> LayerCount<Space>::lies_over(TriangleId t, double x, double y, Extent extent) const {
    const Sight& sight = projection_.sight();
    const Numerators<T> direction{T(x), T(y), T(1), 0};
    const uvec3 vertex           = sight.occluders.topology.triangles[t];
    const Numerators<T> corner[] = {projection_.project(vertex[0]), projection_.project(vertex[1]),
                                    projection_.project(vertex[2])};
    // Three signs, of the direction and two corners each: all must be as that of the three corners.
    Filtered<int> signs[3];
    for (int k = 0; k < 3; ++k) signs[k] = sign_of(direction, corner[k], corner[(k + 1) % 3]);
    const auto one_is = [&](Filtered<int> s) { return signs[0] == s || signs[1] == s || signs[2] == s; };
    if (one_is(1) && one_is(-1)) return false;
    const int side = projection_.side_of(t);
    if (side == 0 || one_is(-side)) return false;
    if (one_is(kUnsure) || one_is(0)) return kUnsure;

    int before = 0;
    for (int k = 0; k < 3; ++k) {
        const Filtered<bool> beyond = projection_.beyond(vertex[k], corner[k]);
        if (!beyond) return kUnsure;
        before += !*beyond;
    }
    if (before == 3) return true;
    if (before == 0 || extent == Extent::before_light) return false;
    // The segment ends on the light's plane, and has passed the triangle where its two ends are on two sides of it.
    const Numerators<T> end      = projection_.space().on_light(x, y);
    const Filtered<int> end_side = sign_of(corner[0] - end, corner[1] - end, corner[2] - end);
    if (!end_side || *end_side == 0) return kUnsure;
    return *end_side == -side;
}

template <class Space>
bool LayerCount<Space>::covers_all(TriangleId t) const {
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
            if (lies_over(t, x, y, Extent::before_light) != true) return false;
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
    sight.occluders.triangles->visit(BoxTree::Piece{p.rounded(), centre.value + across, 1.0, rounding},
                                     [&](TriangleId t) {
                                         if (t == sight.viewpoint.own() || sight.occluders.casts_nothing[t])
                                             return true;
                                         const Filtered<bool> over = lies_over(t, x, y, Extent::any);
                                         if (!over) {
                                             layers = kUnsure;
                                             return false;
                                         }
                                         if (*over) ++*layers;
                                         if (*over && std::is_same_v<T, double> && covers_all(t)) blocker = t;
                                         return true;
                                     });
    return layers;
}

}  // namespace umbra::exact_detail
