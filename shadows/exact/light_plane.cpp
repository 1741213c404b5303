#include "umbra/shadows/exact/light_plane.h"

#include "umbra/core/render/sampling.h"

namespace umbra::exact_visibility {
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

double axis_error(const Light& light) {
    // Two normalizations and two cross products: fewer than 16 roundings a component.
    return light.kind == LightKind::disk ? 16 * kUnit * static_cast<double>(light.radius) : 0;
}

ExactAxes exact_axes(const Light& light, const DiskAxes& half) {
    Rational3 u = rational(half.u), v = rational(half.v);
    if (light.kind == LightKind::disk) {
        const Rational3 n      = rational(light.direction);
        const auto put_into_it = [&](Rational3& axis) {
            const Rational over = dot(axis, n) / dot(n, n);
            for (std::size_t k = 0; k < 3; ++k) axis[k] -= over * n[k];
        };
        put_into_it(u);
        put_into_it(v);
    }
    return {std::move(u), std::move(v), rational(light.position)};
}

LightPlane flat_light_plane(const Light& light, const DiskAxes& half, const ExactAxes& exact, const ExactPoint& p) {
    LightPlane plane{.u                  = half.u,
                     .v                  = half.v,
                     .exact_axes         = &exact,
                     .axis_error         = axis_error(light),
                     .centre_from_corner = centre_from_corner(light, p)};
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
    // The rest is of first order in off.
    if (!(d - 4 * off > r) || !tangent_disk(p.from_corner().value, centre.value, r, disk))
        return LightPlane{.rounding = double(kInfinity)};
    // The disk's position depends on d, from p to the sphere's centre. The error of d moves its centre, and its radius
    // r sqrt(d^2 - r^2) / d, whose derivative is below r d / (d^2 - r^2) times the radius over d.
    const double rounding = off * (1 + r * d / ((d - r) * (d + r))) / glm::length(disk.axis_u);
    // Along its normal, the disk moves by less: its centre is at r^2 / d from the sphere's, which changes by no more
    // than d does, and its normal turns by off / d.
    return LightPlane{.u                  = disk.axis_u,
                      .v                  = disk.axis_v,
                      .centre_from_corner = {disk.centre, 0},
                      .rounding           = rounding,
                      .depth_error        = 4 * off};
}

}  // namespace umbra::exact_visibility
