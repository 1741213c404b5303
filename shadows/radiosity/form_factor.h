// Form factors: which share of the light that arrives at a point of a surface can come from one polygon.
//
// This work is based on:
// Johann Lambert. Photometria. 1760
// Cindy Goral, Kenneth Torrance, Donald Greenberg, Bennett Battaile. Modeling the Interaction of Light between Diffuse
// Surfaces. 1984
#pragma once

#include <span>

#include "umbra/core/base/math.h"

namespace umbra::patches {

/// The form factor from a point p of a surface with the unit normal n to a plane polygon, of whichever winding, that
/// nothing hides: the integral of cos(a) cos(b) / (pi r^2) over the part of it that is in front of p, in [0, 1].
/// Lambert's contour integral, in double. 0 where p lies in the polygon's plane. At most 14 corners.
[[nodiscard]] double form_factor(dvec3 p, dvec3 n, std::span<const dvec3> polygon);

}  // namespace umbra::patches
