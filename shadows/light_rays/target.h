// A light as shadow rays see it.
#pragma once

#include "umbra/core/render/ray.h"
#include "umbra/core/scene/lights.h"
#include "umbra/shadows/light_rays/near_light.h"

namespace umbra::rays {

/// Rays end before the light; what is beyond is for NearLight.
inline constexpr float kTraced = 1 - static_cast<float>(kUntraced);

/// The light in ray space. Rays to a light whose farthest point is at distance D run in units of `unit`, a power of two
/// near D where D is far beyond the scene and 1 else, so that nothing over- or underflows.
struct Target {
    LightKind kind = LightKind::point;
    double unit    = 1;
    float per_unit = 1;         ///< 1 / unit; 0 where the scene is a point for the light
    float reach    = kTraced;   ///< tfar: where rays end, in ray space
    vec3 centre{0};             ///< in units; directional: the unit vector to the light
    vec3 axis_u{0}, axis_v{0};  ///< in units: rectangle: half edges; disk: perpendicular radii
    dvec3 sphere{0};            ///< sphere: centre and radius, not in units
    double radius = 0;
};

[[nodiscard]] Target make_target(const Light& light, const RaySpace& space);

}  // namespace umbra::rays
