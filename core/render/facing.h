// On which side of a surface point's plane a light is.
#pragma once

#include <cstddef>

#include "umbra/core/render/points.h"

namespace umbra {

/// On which side of the triangle a, b, c a light's centre is, or a directional light's source: +1 where the triangle's
/// winding faces it, -1 on the other side, 0 in its plane and where the triangle has no area. Exact.
[[nodiscard]] int side_of_light(const Light& light, vec3 a, vec3 b, vec3 c);

/// Whether some of triangle t is on one side of the plane of triangle `own`, +1 where its winding faces: a triangle
/// that is not on the light's side hides nothing of it. Exact.
[[nodiscard]] bool rises_over(const Scene& scene, TriangleId t, TriangleId own, int side);

/// `facing` of a point of triangle t, as its object takes it.
[[nodiscard]] Facing as_received(const Scene& scene, TriangleId t, Facing facing);

/// Which part of the light a point of triangle t sees, whose normal is `flipped` against the triangle's winding. Exact.
[[nodiscard]] Facing facing_of(const Scene& scene, LightId light, TriangleId t, bool flipped);

/// Whether point i lies in a sphere light or on it. Exact.
[[nodiscard]] bool lies_in_light(const Scene& scene, const PointBatch& points, LightId light, std::size_t i);

/// The facing of point i, whose triangle has `of_triangle`: a sphere light that the point lies in shines on it past all
/// occluders. Exact.
[[nodiscard]] inline Facing facing_at(const Scene& scene, const PointBatch& points, LightId light, std::size_t i,
                                      Facing of_triangle) {
    const bool may_lie_in = of_triangle == Facing::partly && scene.lights[light].kind == LightKind::sphere;
    return may_lie_in && lies_in_light(scene, points, light, i) ? Facing::unshadowed : of_triangle;
}

/// centre_is_behind where the plane of point i cuts the light.
[[nodiscard]] bool centre_of_cut_light_is_behind(const Scene& scene, const PointBatch& points, LightId light,
                                                 std::size_t i);

/// Whether the centre of an area light that the plane of point i cuts is behind that plane, or in it: methods ask this
/// that take an area light as one point, at its centre; their S_j is 0 there. False where the plane does not cut the
/// light. Exact. `points.facing[light]` is filled.
[[nodiscard]] inline bool centre_is_behind(const Scene& scene, const PointBatch& points, LightId light, std::size_t i) {
    return points.facing[light][i] == Facing::partly && centre_of_cut_light_is_behind(scene, points, light, i);
}

}  // namespace umbra
