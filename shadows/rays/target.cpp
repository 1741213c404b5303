#include "umbra/shadows/rays/target.h"

#include <cmath>

#include "umbra/shadows/shared/light_points.h"

namespace umbra::rays {

Target make_target(const Light& light, const RaySpace& space) {
    Target target;
    target.kind = light.kind;
    if (light.kind == LightKind::directional) {
        target.centre = vec3(-glm::normalize(dvec3(light.direction)));
        return target;
    }
    const double scale    = space.scale;
    const dvec3 centre    = (dvec3(light.position) - dvec3(space.centre)) * scale;
    const double distance = glm::length(centre);
    if (distance > 0x1p20) target.unit = static_cast<float>(std::exp2(std::floor(std::log2(distance))));
    target.centre = vec3(centre / static_cast<double>(target.unit));
    target.sphere = centre;
    target.radius = static_cast<double>(light.radius) * scale;
    DiskAxes axes{dvec3(light.edge_u) * 0.5, dvec3(light.edge_v) * 0.5};
    if (light.kind == LightKind::disk) axes = disk_axes(light);
    target.axis_u = vec3(axes.u * (scale / static_cast<double>(target.unit)));
    target.axis_v = vec3(axes.v * (scale / static_cast<double>(target.unit)));
    return target;
}

}  // namespace umbra::rays
