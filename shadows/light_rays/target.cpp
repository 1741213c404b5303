#include "umbra/shadows/light_rays/target.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/predicates.h"
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

namespace {

/// Whether rays to the light pass any triangle in their untraced part. Mostly none does, and the tree finds that at
/// once.
bool may_be_near(const RayScene& rays, vec3 light) {
    const RaySpace& space = rays.space();
    const dvec3 position  = (dvec3(light) - dvec3(space.centre)) * static_cast<double>(space.scale);
    const double distance = glm::length(position);
    // Ray space holds the scene within 2 each way: positions farther than that are far from every triangle.
    constexpr double scene_radius = 4;
    if (distance > 2 * scene_radius) return false;
    const double stretch = kUntraced * (distance + scene_radius);
    return rays.clearance(position, stretch) < stretch;
}

}  // namespace

/// From the origin to the triangle's box, a lower bound of the distance to the triangle.
double NearLight::squared_distance(const Occluder& t) {
    const dvec3 low = glm::min(glm::min(t.a, t.b), t.c), high = glm::max(glm::max(t.a, t.b), t.c);
    const dvec3 gap = glm::max(glm::max(low, -high), dvec3(0));
    return glm::dot(gap, gap);
}

NearLight::NearLight(const Scene& scene, const RayScene& rays, LightId light)
    : scene_(&scene), light_(scene.lights[light].position) {
    const LightKind kind = scene.lights[light].kind;
    const vec3 position  = scene.lights[light].position;
    if (kind != LightKind::point && kind != LightKind::spot) return;
    if (!may_be_near(rays, position)) return;
    const Box box          = bounds(scene);
    const dvec3 farthest   = glm::max(glm::abs(dvec3(box.min) - light_), glm::abs(dvec3(box.max) - light_));
    const double untraced2 = kUntraced * kUntraced * glm::dot(farthest, farthest);
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        if (!scene.blocks(t)) continue;
        const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
        Occluder near{t, dvec3(a) - light_, dvec3(b) - light_, dvec3(c) - light_, 0};
        if (squared_distance(near) > untraced2) continue;
        // A segment that ends in a triangle's plane does not pass through it: triangles of the light's own shape.
        near.light_side = side_of_plane(a, b, c, position);
        if (near.light_side != 0) near_.push_back(near);
    }
}

/// Whether the segment from the light to `p` (less the light's position) passes through the triangle.
bool NearLight::passes_through(const Occluder& t, dvec3 p) {
    const dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    if (glm::dot(normal, p - t.a) * t.light_side >= 0) return false;  // both ends on one side
    const double ab = glm::dot(glm::cross(t.a, t.b), p), bc = glm::dot(glm::cross(t.b, t.c), p),
                 ca = glm::dot(glm::cross(t.c, t.a), p);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

TriangleId NearLight::blocker(const PointBatch& points, std::size_t i) const {
    if (near_.empty()) return kNoTriangle;
    const TriangleId t = points.triangle[i];
    const dvec3 a(scene_->vertex(t, 0)), b(scene_->vertex(t, 1)), c(scene_->vertex(t, 2));
    const dvec3 p = (a - light_) + double(points.u[i]) * (b - a) + double(points.v[i]) * (c - a);
    for (const Occluder& near : near_)
        if (near.triangle != t && passes_through(near, p)) return near.triangle;
    return kNoTriangle;
}

}  // namespace umbra::rays
