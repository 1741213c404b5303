#include "umbra/shadows/radiosity/form_factor.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace umbra::patches {

double form_factor(dvec3 p, dvec3 n, std::span<const dvec3> polygon) {
    // What is behind p's plane does not count; a convex polygon gains one corner there.
    std::array<dvec3, 16> in_front;
    std::size_t count = 0;
    for (std::size_t k = 0; k < polygon.size() && count + 2 <= in_front.size(); ++k) {
        const dvec3 a = polygon[k] - p, b = polygon[(k + 1) % polygon.size()] - p;
        const double at_a = glm::dot(n, a), at_b = glm::dot(n, b);
        if (at_a >= 0) in_front[count++] = a;
        if ((at_a < 0) != (at_b < 0)) in_front[count++] = a + at_a / (at_a - at_b) * (b - a);
    }
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const dvec3 a = in_front[k], b = in_front[(k + 1) % count], across = glm::cross(a, b);
        const double length = glm::length(across);
        if (length > 0) sum += glm::dot(n, across) / length * std::atan2(length, glm::dot(a, b));
    }
    return std::clamp(std::abs(sum) / (2 * kPi), 0.0, 1.0);
}

}  // namespace umbra::patches
