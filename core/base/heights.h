// Heights over the plane of a triangle (a, b, c): on which side of it figures lie, and its normal, however thin the
// triangle is. Decided in double where a bound on the error allows it, else in rationals.
#pragma once

#include "umbra/core/base/math.h"

namespace umbra {

/// Signs of the least and of the greatest height of a figure, in the direction of the normal cross(b - a, c - a).
/// Exact. Both are 0 where the triangle has no area.
struct HeightSigns {
    int low = 0, high = 0;
};

/// Corners at centre +- edge_u / 2 +- edge_v / 2.
[[nodiscard]] HeightSigns heights_of_rectangle(vec3 a, vec3 b, vec3 c, vec3 centre, vec3 edge_u, vec3 edge_v);

/// Around `axis`, which has any length > 0.
[[nodiscard]] HeightSigns heights_of_disk(vec3 a, vec3 b, vec3 c, vec3 centre, vec3 axis, float radius);

[[nodiscard]] HeightSigns heights_of_sphere(vec3 a, vec3 b, vec3 c, vec3 centre, float radius);

/// cross(b - a, c - a), normalised after it was computed exactly. Zero where the triangle has no area.
[[nodiscard]] dvec3 unit_normal(vec3 a, vec3 b, vec3 c);

}  // namespace umbra
