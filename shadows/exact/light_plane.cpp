#include "umbra/shadows/exact/light_plane.h"

#include "umbra/core/render/sampling.h"

namespace umbra::exact_detail {
namespace {

/// The centre of the light less the first corner of the point's triangle: one rounding.
Entries centre_from_corner(const Light& light, const ExactPoint& p) {
    const dvec3 centre = dvec3(light.position) - dvec3(p.corner());
    return {centre, kUnit * largest(centre)};
}

}  // namespace

DiskAxes half_axes(const Light& light) {
    if (light.kind == LightKind::disk) return disk_axes(light);
    return {dvec3(light.edge_u) * 0.5, dvec3(light.edge_v) * 0.5};
}

LightPlane flat_light_plane(const Light& light, const DiskAxes& half, const ExactPoint& p) {
    LightPlane plane{half.u, half.v, centre_from_corner(light, p), rational(light.position), 0};
    // Two normalizations and two cross products: fewer than 16 roundings a component.
    if (light.kind == LightKind::disk) plane.rounding = 16 * kUnit;
    return plane;
}

std::optional<LightPlane> sphere_light_plane(const Light& sphere, const ExactPoint& p) {
    const Entries centre = centre_from_corner(sphere, p);
    const double r       = sphere.radius;
    const Entries to     = p.to(centre);
    const double d = glm::length(to.value), off = 2 * to.error + 16 * kUnit * (d + r);
    if (d + off < r) return std::nullopt;
    TangentDisk disk;
    // What follows is of first order in off.
    if (!(d - 4 * off > r) || !tangent_disk(p.from_corner().value, centre.value, r, disk))
        return LightPlane{.rounding = double(kInfinity)};
    // The disk's position depends on d, from p to the sphere's centre. The error of d moves its centre, and its radius
    // r sqrt(d^2 - r^2) / d, whose derivative is below r d / (d^2 - r^2) times the radius over d.
    const double rounding = off * (1 + r * d / ((d - r) * (d + r))) / glm::length(disk.axis_u);
    return LightPlane{disk.axis_u, disk.axis_v, {disk.centre, 0}, std::nullopt, rounding};
}

}  // namespace umbra::exact_detail
