// A light as shadow rays see it.
#pragma once

#include "umbra/core/render/ray.h"
#include "umbra/core/scene/lights.h"

namespace umbra::rays {

/// The light in ray space. Rays to a light at distance D run in units of `unit`, a power of two near D where D is far
/// beyond the scene and 1 else, so that nothing over- or underflows.
struct Target {
    LightKind kind = LightKind::point;
    float unit     = 1;
    vec3 centre{0};             ///< in units; directional: the unit vector to the light
    vec3 axis_u{0}, axis_v{0};  ///< in units: rectangle: half edges; disk: perpendicular radii
    dvec3 sphere{0};            ///< sphere: centre and radius, not in units
    double radius = 0;
};

[[nodiscard]] Target make_target(const Light& light, const RaySpace& space);

}  // namespace umbra::rays
