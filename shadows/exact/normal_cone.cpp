#include "umbra/shadows/exact/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace umbra::exact_visibility {
namespace {

constexpr float kWidest   = 1.5f;      ///< a little less than a right angle, from which on nothing can be said
constexpr float kOpposite = 0.1f;      ///< sums of two unit vectors that are shorter have no direction to rely on
constexpr float kWidening = 0x1p-20f;  ///< more than the rounding of an angle in float
constexpr double kDoubt   = 1e-5;      ///< more than that of the axis, the sine and the cosine, with a margin

}  // namespace

NormalCone NormalCone::around(vec3 axis, float half_angle) {
    return {axis, half_angle, std::sin(half_angle), std::cos(half_angle)};
}

NormalCone NormalCone::joined(const NormalCone& a, const NormalCone& b) {
    const vec3 sum     = a.axis + b.axis;
    const float length = glm::length(sum);
    if (a.half_angle > kWidest || b.half_angle > kWidest || length < kOpposite) return {};
    const vec3 axis = sum / length;
    // By the chord: near 1 a cosine in float knows an angle to 3e-4 at best.
    const auto reach = [&](const NormalCone& c) {
        return 2 * std::asin(std::min(1.0f, glm::length(axis - c.axis) / 2)) + c.half_angle;
    };
    return around(axis, std::max(reach(a), reach(b)) + kWidening);
}

bool NormalCone::one_sided(const Box& box, dvec3 p, double around) const {
    if (half_angle > kWidest) return false;
    const dvec3 lo(box.min), hi(box.max);
    const dvec3 to_box  = 0.5 * (lo + hi) - p;
    const double square = glm::dot(to_box, to_box), across = std::abs(glm::dot(dvec3(axis), to_box));
    // A weaker condition than the last, without a root.
    if (!(across * across > static_cast<double>(sine) * static_cast<double>(sine) * square * (1 - kDoubt)))
        return false;
    const double distance = std::sqrt(square), radius = 0.5 * glm::length(hi - lo) + around;
    if (!(distance > radius)) return false;
    // The angle between the axis and a segment to any point of the box differs from that of the segment to its centre,
    // and the normal's from the axis: together by at most half_angle + asin(radius / distance).
    const double rest = std::sqrt(square - radius * radius);  // the cosine of the latter times the distance
    if (!(rest > sine * distance)) return false;              // together a right angle or more
    return across > sine * rest + cosine * radius + kDoubt * distance;
}

}  // namespace umbra::exact_visibility
