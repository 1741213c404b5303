#include "core/lights.h"

#include <algorithm>
#include <cmath>

namespace umbra {

std::string_view to_string(LightKind kind) {
    switch (kind) {
        case LightKind::directional: return "directional";
        case LightKind::point: return "point";
        case LightKind::spot: return "spot";
        case LightKind::rectangle: return "rectangle";
        case LightKind::disk: return "disk";
        case LightKind::sphere: return "sphere";
    }
    return "";
}

ToLight to_light(const Light& light, vec3 p) {
    // In double: a light far away must not lose its direction, nor a tiny scene its distances.
    if (light.kind == LightKind::directional) return {vec3(-glm::normalize(dvec3(light.direction))), kInfinity};
    const dvec3 v         = dvec3(light.position) - dvec3(p);
    const double distance = glm::length(v);
    if (distance == 0) return {vec3(0), 0};
    return {vec3(v / distance), static_cast<float>(distance)};
}

float attenuation_factor(const Attenuation& a, float distance) {
    if (std::isinf(distance)) return 1;  // a light at infinity is not attenuated
    const double d           = distance;
    const double denominator = a.c1 + a.c2 * d + a.c3 * d * d;
    // Positive coefficients make a zero denominator possible only at d = 0 with c1 = 0: the limit is capped, so that
    // the sum stays finite and still falls monotonically.
    const double factor = denominator > 0 ? 1 / denominator : static_cast<double>(std::numeric_limits<float>::max());
    return static_cast<float>(std::min(factor, a.clamp ? 1.0 : 1e30));
}

float spot_factor(const Spot& spot, float cos_angle) {
    const float cos_cutoff = std::cos(spot.cutoff);
    if (cos_angle < cos_cutoff || cos_angle <= 0) return 0;
    switch (spot.falloff) {
        case SpotFalloff::cosine: return std::pow(std::min(cos_angle, 1.0f), spot.exponent);
        case SpotFalloff::zachmann:
            // As the lecture prints it, it goes negative near the rim for n > 1: clamped at 0.
            return std::max(0.0f, (std::pow(std::min(cos_angle, 1.0f), spot.exponent) - cos_cutoff) / (1 - cos_cutoff));
        case SpotFalloff::smooth: {
            const float cos_inner = std::cos(spot.inner);
            const float t = std::clamp((cos_angle - cos_cutoff) / std::max(1e-3f, cos_inner - cos_cutoff), 0.0f, 1.0f);
            return t * t;
        }
    }
    return 0;
}

float falloff(const Light& light, vec3 p) {
    const ToLight to = to_light(light, p);
    if (light.range > 0 && to.distance > light.range) return 0;
    float factor = attenuation_factor(light.attenuation, to.distance);
    if (light.kind == LightKind::spot)
        factor *= spot_factor(light.spot, -glm::dot(glm::normalize(light.direction), to.direction));
    return factor;
}

}  // namespace umbra
