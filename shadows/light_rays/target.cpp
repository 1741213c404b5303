#include "umbra/shadows/light_rays/target.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/render/light_points.h"

namespace umbra::rays {

Target make_target(const Light& light, const RaySpace& space) {
    Target target;
    target.kind = light.kind;
    if (light.kind == LightKind::directional) {
        target.centre = vec3(-glm::normalize(dvec3(light.direction)));
        return target;
    }
    const double scale = space.scale;
    const dvec3 centre = (dvec3(light.position) - dvec3(space.centre)) * scale;
    DiskAxes axes{dvec3(light.edge_u) * 0.5, dvec3(light.edge_v) * 0.5};
    if (light.kind == LightKind::disk) axes = disk_axes(light);
    double farthest = glm::length(centre);
    if (light.kind == LightKind::rectangle || light.kind == LightKind::disk)
        farthest = std::max({farthest, glm::length(axes.u) * scale, glm::length(axes.v) * scale});
    if (farthest > 0x1p20) target.unit = std::exp2(std::floor(std::log2(farthest)));
    target.per_unit = static_cast<float>(1 / target.unit);
    target.reach    = kTraced * static_cast<float>(std::min(target.unit, 0x1p100));
    target.centre   = vec3(centre / target.unit);
    target.sphere   = centre;
    target.radius   = static_cast<double>(light.radius) * scale;
    target.axis_u   = vec3(axes.u * (scale / target.unit));
    target.axis_v   = vec3(axes.v * (scale / target.unit));
    return target;
}

}  // namespace umbra::rays
