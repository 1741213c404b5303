// Geometry that several rooms need: axes across a direction, an order of positions, faces of a cube, distances to
// segments and triangles. All in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>

#include "umbra/core/base/math.h"

namespace umbra {

/// Two axes across a direction n: u, v, n are orthonormal and right-handed, to rounding.
struct Axes {
    dvec3 u, v;
};

/// Axes across the unit vector n. They depend on n alone and jump where |n.x| passes 0.6.
[[nodiscard]] inline Axes axes_across(dvec3 n) {
    const dvec3 helper = std::abs(n.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 u      = glm::normalize(glm::cross(helper, n));
    return {u, glm::cross(n, u)};
}

/// Whether a is before b in the order by x, y and z. Both triangles of an edge take its ends in that order, so that
/// both compute the same numbers.
[[nodiscard]] inline bool comes_before(dvec3 a, dvec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// A direction as face 0 to 5 of a cube has it: x, y and the depth along the face's axis. It leads through the face
/// where |x|, |y| <= depth. Exact.
[[nodiscard]] inline dvec3 in_cube_face(int face, dvec3 d) {
    const int axis = face / 2;
    return {d[(axis + 1) % 3], d[(axis + 2) % 3], face % 2 == 0 ? d[axis] : -d[axis]};
}

/// Distance from p to the segment from a to b, which may be one point.
[[nodiscard]] inline double distance_to_segment(dvec3 p, dvec3 a, dvec3 b) {
    const dvec3 d        = b - a;
    const double squared = glm::dot(d, d);
    const double t       = squared > 0 ? std::clamp(glm::dot(p - a, d) / squared, 0.0, 1.0) : 0.0;
    return glm::length(a + t * d - p);
}

/// Distance from p to the nearest point of the triangle (a, b, c), which may be degenerate.
[[nodiscard]] inline double distance_to_triangle(dvec3 p, dvec3 a, dvec3 b, dvec3 c) {
    const dvec3 n     = glm::cross(b - a, c - a);
    const auto within = [&](dvec3 from, dvec3 to) { return glm::dot(glm::cross(to - from, p - from), n) >= 0; };
    if (glm::dot(n, n) > 0 && within(a, b) && within(b, c) && within(c, a))
        return std::abs(glm::dot(p - a, n)) / glm::length(n);
    return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

}  // namespace umbra
