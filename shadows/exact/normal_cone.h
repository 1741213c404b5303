// Cones that hold the normals of many triangles, and whether a point is on one side of all of them.
//
// This work is based on:
// Pedro Sander et al. Silhouette Clipping. 2000
#pragma once

#include "umbra/core/base/math.h"

namespace umbra::exact_visibility {

/// Axis and half angle. The default one holds every direction; so does each of more than kWidest, whose other members
/// mean nothing.
struct NormalCone {
    vec3 axis{0};
    float half_angle = 4, sine = 0, cosine = 1;  ///< radians

    [[nodiscard]] static NormalCone around(vec3 axis, float half_angle);
    [[nodiscard]] static NormalCone joined(const NormalCone& a, const NormalCone& b);

    /// Whether p, and all that is at most `around` from it, is surely on one side of every plane that meets the box and
    /// whose normal is in the cone.
    [[nodiscard]] bool one_sided(const Box& box, dvec3 p, double around = 0) const;
};

}  // namespace umbra::exact_visibility
