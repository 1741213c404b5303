// Directions of mirrored and refracted rays.
#pragma once

#include <optional>

#include "umbra/core/base/math.h"

namespace umbra {

/// The direction in which a perfect mirror sends a ray on: d - 2 (d.n) n. `d` and `n` are unit vectors in one space; n
/// may have either sign. Unit to rounding.
[[nodiscard]] dvec3 mirrored(dvec3 d, dvec3 n);

/// The direction of a ray after a boundary, by Snell's law: sin(out) = ratio sin(in). `d`: unit, towards the boundary;
/// `n`: unit normal on the side from which d comes, d.n <= 0; `ratio`: index of refraction on that side over that
/// beyond, > 0. Unit to rounding. Nothing beyond the critical angle, ratio sin(in) > 1: total internal reflection.
[[nodiscard]] std::optional<dvec3> refracted(dvec3 d, dvec3 n, double ratio);

}  // namespace umbra
