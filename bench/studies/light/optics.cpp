#include "umbra/bench/studies/light/optics.h"

#include <cmath>

namespace umbra {

dvec3 mirrored(dvec3 d, dvec3 n) { return d - 2 * glm::dot(d, n) * n; }

std::optional<dvec3> refracted(dvec3 d, dvec3 n, double ratio) {
    const double cos_in      = -glm::dot(d, n);
    const double square_sine = ratio * ratio * (1 - cos_in * cos_in);
    if (square_sine > 1) return std::nullopt;
    return ratio * d + (ratio * cos_in - std::sqrt(1 - square_sine)) * n;
}

}  // namespace umbra
