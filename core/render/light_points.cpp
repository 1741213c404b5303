#include "umbra/core/render/light_points.h"

#include <cmath>

#include "umbra/core/base/geometry.h"
#include "umbra/core/render/sampling.h"

namespace umbra {

DiskAxes disk_axes(const Light& disk) {
    const dvec3 n = glm::normalize(dvec3(disk.direction));
    const dvec3 u = -axes_across(n).u * static_cast<double>(disk.radius);
    return {u, glm::cross(n, u)};
}

dvec3 light_point(const Light& light, dvec3 p, int k) {
    const double x = (k + 1) * 0.7548776662466927, y = (k + 1) * 0.5698402909980532;
    const double a = x - std::floor(x), b = y - std::floor(y);
    const double radius = std::sqrt(a), angle = 2 * kPi * b;
    const dvec3 centre(light.position);
    if (light.kind == LightKind::rectangle)
        return centre + (a - 0.5) * dvec3(light.edge_u) + (b - 0.5) * dvec3(light.edge_v);
    if (light.kind == LightKind::disk) {
        const DiskAxes axes = disk_axes(light);
        return centre + radius * (std::cos(angle) * axes.u + std::sin(angle) * axes.v);
    }
    TangentDisk disk;
    if (!tangent_disk(p, centre, light.radius, disk)) return centre;
    return disk.centre + radius * (std::cos(angle) * disk.axis_u + std::sin(angle) * disk.axis_v);
}

}  // namespace umbra
