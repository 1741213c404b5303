// Bodies that rays meet by a formula, without triangles: sphere, box, cylinder, cone and torus.
//
// This work is based on:
// Timothy Kay, James Kajiya. Ray Tracing Complex Scenes. 1986
#pragma once

#include <array>
#include <optional>

#include "umbra/core/base/math.h"

namespace umbra {

/// Where the line origin + t direction is inside a body: enter <= t <= leave, t in lengths of `direction`. Either may
/// be negative, which is behind the origin.
struct Passage {
    double enter = 0, leave = 0;
};

/// Of a sphere: the two roots of |origin + t direction - centre|^2 = radius^2. World space, any length of `direction`
/// above 0, radius > 0. Nothing where the line passes by. The root of larger magnitude is computed first and gives the
/// other, so that neither loses digits where the origin is close to the sphere.
[[nodiscard]] std::optional<Passage> through_sphere(dvec3 origin, dvec3 direction, dvec3 centre, double radius);

/// Of a box with faces across the axes: the largest of the three entries, the smallest of the three exits; nothing
/// where the former is larger. A line that runs along a face's plane is inside of it.
[[nodiscard]] std::optional<Passage> through_box(dvec3 origin, dvec3 direction, dvec3 least, dvec3 greatest);

/// Of a cylinder or a cone around the z axis, from z = -half to half, with its caps. The cone's tip is at z = half, and
/// its base has the radius. Where the quadratic of the side and the slab of the caps overlap.
[[nodiscard]] std::optional<Passage> through_cylinder(dvec3 origin, dvec3 direction, double radius, double half);
[[nodiscard]] std::optional<Passage> through_cone(dvec3 origin, dvec3 direction, double radius, double half);

/// Of a torus around the z axis: circles of radius `minor` whose centres lie on one of radius `major` > `minor`.
/// A line may be inside twice, in order. The roots of (|p|^2 + major^2 - minor^2)^2 = 4 major^2 (x^2 + y^2) lie between
/// those of the derivative, where bisection finds them to the last bit.
struct Passages {
    std::array<Passage, 2> list{};
    int count = 0;
};
[[nodiscard]] Passages through_torus(dvec3 origin, dvec3 direction, double major, double minor);

/// The t at which a ray meets the body: the smallest that is above `least`, entry or exit. Nothing where both are
/// behind. The lecture takes the entry alone and asks that it be above 0, which finds nothing from inside the body.
[[nodiscard]] std::optional<double> first_meeting(const std::optional<Passage>& passage, double least = 0);

}  // namespace umbra
