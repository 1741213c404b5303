// How a light falls off with the distance, as an expression that loops over points can be made vector code of. Internal
// to core.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "umbra/core/scene/lights.h"

namespace umbra {

inline constexpr double kLargestFactor = 1e30;  ///< keeps f_att, and products with it, finite

/// attenuation_factor, which is a float, of a distance that is one.
[[nodiscard]] inline double attenuation_at(const Attenuation& a, double distance) {
    const double denominator = a.c1 + a.c2 * distance + a.c3 * distance * distance;
    // Positive coefficients make a zero denominator possible only at distance 0 with c1 = 0: the limit is capped, so
    // that the sum stays finite and still falls monotonically.
    const double factor = denominator > 0 ? 1 / denominator : static_cast<double>(std::numeric_limits<float>::max());
    const double capped = static_cast<double>(static_cast<float>(std::min(factor, a.clamp ? 1.0 : kLargestFactor)));
    return distance == HUGE_VAL ? 1 : capped;  // a light at infinity is not attenuated
}

}  // namespace umbra
