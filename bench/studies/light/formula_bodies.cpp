#include "umbra/bench/studies/light/formula_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace umbra {

std::optional<Passage> through_sphere(dvec3 origin, dvec3 direction, dvec3 centre, double radius) {
    // a t^2 + 2 b t + c = 0
    const dvec3 from = origin - centre;
    const double a = glm::dot(direction, direction), b = glm::dot(from, direction);
    const double c            = glm::dot(from, from) - radius * radius;
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return std::nullopt;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    if (q == 0) return Passage{0, 0};  // touches at the origin
    const auto [near, far] = std::minmax({q / a, c / q});
    return Passage{near, far};
}

std::optional<Passage> through_box(dvec3 origin, dvec3 direction, dvec3 least, dvec3 greatest) {
    constexpr double kEver = std::numeric_limits<double>::infinity();
    Passage passage{-kEver, kEver};
    for (int k = 0; k < 3; ++k) {
        if (direction[k] == 0) {
            if (origin[k] < least[k] || origin[k] > greatest[k]) return std::nullopt;
            continue;
        }
        const double one = (least[k] - origin[k]) / direction[k], other = (greatest[k] - origin[k]) / direction[k];
        passage.enter = std::max(passage.enter, std::min(one, other));
        passage.leave = std::min(passage.leave, std::max(one, other));
    }
    if (passage.enter > passage.leave) return std::nullopt;
    return passage;
}

std::optional<double> first_meeting(const std::optional<Passage>& passage, double least) {
    if (!passage) return std::nullopt;
    if (passage->enter > least) return passage->enter;
    if (passage->leave > least) return passage->leave;
    return std::nullopt;
}

}  // namespace umbra
