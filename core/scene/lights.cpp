#include "umbra/core/scene/lights.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/scene/attenuation.h"
#include "umbra/core/scene/names.h"
#include "umbra/core/scene/photometry.h"

namespace umbra {

std::string_view to_string(LightKind kind) { return name_of(kind); }

bool lights_object(const Light& light, std::string_view object) {
    return std::none_of(light.except.begin(), light.except.end(), [&](const std::string& name) {
        return object == name || (object.starts_with(name) && object[name.size()] == '/');
    });
}

LightPose pose_of(const Light& light) {
    return {light.position, light.direction, light.edge_u, light.edge_v, light.along};
}

void set_pose(Light& light, const LightPose& pose) {
    light.position  = pose.position;
    light.direction = pose.direction;
    light.edge_u    = pose.edge_u;
    light.edge_v    = pose.edge_v;
    light.along     = pose.along;
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
    return static_cast<float>(attenuation_at(a, static_cast<double>(distance)));
}

namespace {

/// In double: a cosine near 1 that is off by one float step is off by 6 % once it is raised to 1e6.
float spot_factor_of(const Spot& spot, double cos_angle) {
    const double cos_cutoff = std::cos(static_cast<double>(spot.cutoff));
    if (cos_angle < cos_cutoff || cos_angle <= 0) return 0;
    const auto power = [&] { return std::pow(std::min(cos_angle, 1.0), static_cast<double>(spot.exponent)); };
    switch (spot.falloff) {
        case SpotFalloff::cosine: return static_cast<float>(power());
        case SpotFalloff::zachmann:
            // As the lecture prints it, it goes negative near the rim for n > 1: clamped at 0.
            return static_cast<float>(std::max(0.0, (power() - cos_cutoff) / (1 - cos_cutoff)));
        case SpotFalloff::smooth: {
            const double cos_inner = std::cos(static_cast<double>(spot.inner));
            if (cos_angle >= cos_inner) return 1;
            const double t = (cos_angle - cos_cutoff) / (cos_inner - cos_cutoff);
            return static_cast<float>(t * t);
        }
    }
    return 0;
}

}  // namespace

float spot_factor(const Spot& spot, float cos_angle) { return spot_factor_of(spot, static_cast<double>(cos_angle)); }

float falloff(const Light& light, vec3 p) {
    const ToLight to = to_light(light, p);
    if (light.range > 0 && to.distance > light.range) return 0;
    float factor = attenuation_factor(light.attenuation, to.distance);
    if (light.kind == LightKind::spot) {
        if (to.distance == 0) return 0;  // in no direction from it
        const dvec3 from_light = glm::normalize(dvec3(p) - dvec3(light.position));
        factor *= spot_factor_of(light.spot, glm::dot(glm::normalize(dvec3(light.direction)), from_light));
    }
    if (light.photometry) {
        if (to.distance == 0) return 0;  // in no direction from it
        const double intensity =
            intensity_towards(*light.photometry, dvec3(light.direction), dvec3(light.along), -dvec3(to.direction));
        factor = static_cast<float>(std::min(static_cast<double>(factor) * intensity, kLargestFactor));
    }
    return factor;
}

}  // namespace umbra
