// Signs that must not be wrong: CGAL's exact predicates, for the scene's float positions.
#pragma once

#include "umbra/core/base/math.h"

namespace umbra {

/// +1 where q lies on the side that the normal cross(b - a, c - a) points to, -1 on the other, 0 in the plane. Exact.
[[nodiscard]] int side_of_plane(vec3 a, vec3 b, vec3 c, vec3 q);

/// Sign of dot(cross(b - a, c - a), d). Exact.
[[nodiscard]] int side_of_direction(vec3 a, vec3 b, vec3 c, vec3 d);
[[nodiscard]] int side_of_direction(vec3 a, vec3 b, vec3 c, dvec3 d);

/// Whether (1-u-v) a + u b + v c lies in a sphere or on it. Exact.
[[nodiscard]] bool lies_in_sphere(vec3 a, vec3 b, vec3 c, float u, float v, vec3 centre, float radius);

}  // namespace umbra
