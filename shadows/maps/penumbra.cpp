#include "umbra/shadows/maps/penumbra.h"

#include <algorithm>
#include <cmath>

namespace umbra {

double disk_radius(const Light& light) {
    if (light.kind != LightKind::rectangle) return static_cast<double>(light.radius);
    return std::sqrt(glm::length(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v))) / kPi);
}

dvec2 rectangle_as(const LightFrame& frame, const Light& light, dvec2 direction) {
    // Half axes, u and v, of the light's outline: of a parallelogram or of an ellipse.
    dvec3 u = 0.5 * dvec3(light.edge_u), v = 0.5 * dvec3(light.edge_v);
    double spread = 1;
    if (light.kind != LightKind::rectangle) {
        const dvec3 towards = frame.x * direction.x + frame.y * direction.y + frame.z;
        const LightFrame disk =
            looking_along(dvec3(0), light.kind == LightKind::disk ? dvec3(light.direction) : towards, false);
        u = static_cast<double>(light.radius) * disk.x, v = static_cast<double>(light.radius) * disk.y;
        // Along an axis the points of a disk have the variance r^2 / 4, those of a square of half side r have r^2 / 3.
        spread = std::sqrt(0.75);
    }
    const auto along = [&](dvec3 q) {
        const double z = glm::dot(frame.z, q);
        return dvec2(glm::dot(frame.x, q), glm::dot(frame.y, q)) - z * direction;
    };
    const dvec2 a = along(u), b = along(v);
    return spread * dvec2(std::hypot(a.x, b.x), std::hypot(a.y, b.y));
}

dvec2 penumbra_reach(const MapView& view, dvec2 size, double z, double depth, double most) {
    const LightFrame& f    = view.frame;
    const dvec2 per_window = dvec2(view.map.width(), view.map.height()) / (2.0 * f.half);
    const dvec2 wide       = size * (1 / std::max(z, f.near) - 1 / depth) * per_window;
    return glm::clamp(wide, dvec2(0.5), dvec2(std::max(0.5, most)));
}

}  // namespace umbra
