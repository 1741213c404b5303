// Directions of mirrored and refracted rays.
#pragma once

#include <cmath>
#include <optional>

#include "umbra/core/base/math.h"

namespace umbra {

/// The direction in which a perfect mirror sends a ray on: d - 2 (d.n) n. `d` and `n` are unit vectors in one space; n
/// may have either sign. Unit to rounding.
[[nodiscard]] inline dvec3 mirrored(dvec3 d, dvec3 n) { return d - 2 * glm::dot(d, n) * n; }

/// The direction of a ray after a boundary, by Snell's law: sin(out) = ratio sin(in). `d`: unit, towards the boundary;
/// `n`: unit normal on the side from which d comes, d.n <= 0; `ratio`: index of refraction on that side over that
/// beyond, > 0. Unit to rounding. Nothing beyond the critical angle, ratio sin(in) > 1: total internal reflection.
[[nodiscard]] inline std::optional<dvec3> refracted(dvec3 d, dvec3 n, double ratio) {
    const double cos_in      = -glm::dot(d, n);
    const double square_sine = ratio * ratio * (1 - cos_in * cos_in);
    if (square_sine > 1) return std::nullopt;
    return ratio * d + (ratio * cos_in - std::sqrt(1 - square_sine)) * n;
}

}  // namespace umbra
