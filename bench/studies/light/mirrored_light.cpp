#include "umbra/bench/studies/light/mirrored_light.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "umbra/bench/studies/light/optics.h"
#include "umbra/bench/studies/light/ray_tree.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// Whether all corners of triangle t have its own unit normal `face`, on either side.
bool is_flat(const Scene& scene, TriangleId t, dvec3 face) {
    for (int k = 0; k < 3 && !scene.normals.empty(); ++k) {
        const dvec3 n(scene.normals[scene.triangles[t][k]]);
        if (n != dvec3(0) && std::abs(glm::dot(n, face)) < 1 - 1e-6) return false;
    }
    return true;
}

/// The direction from p to a light, unit, and the distance.
struct Towards {
    dvec3 direction;
    double distance;
};
Towards towards(const Light& light, dvec3 p) {
    if (light.kind == LightKind::directional)
        return {-glm::normalize(dvec3(light.direction)), static_cast<double>(kInfinity)};
    const dvec3 d = dvec3(light.position) - p;
    return {glm::normalize(d), glm::length(d)};
}

/// Where the path from p over the plane meets it; nothing where the two are not on one side of it.
std::optional<dvec3> place_on_mirror(const MirrorPlane& plane, const Light& light, dvec3 p) {
    const double height = glm::dot(plane.normal, p) - plane.offset;
    if (light.kind == LightKind::directional) {
        const dvec3 d     = mirrored(-glm::normalize(dvec3(light.direction)), plane.normal);
        const double fall = -glm::dot(plane.normal, d);
        if (height == 0 || !(height / fall > 0)) return std::nullopt;
        return p + height / fall * d;
    }
    const dvec3 l(light.position);
    const double above = glm::dot(plane.normal, l) - plane.offset;
    if (!(height * above > 0)) return std::nullopt;
    return p + height / (height + above) * (l - 2 * above * plane.normal - p);
}

/// Whether the light reaches p, on triangle `from` with the unit normal n, over this plane.
bool reaches_over(const MirrorPlane& plane, const RayScene& rays, const Scene& scene, const Light& light, dvec3 p,
                  TriangleId from, dvec3 n) {
    const std::optional<dvec3> mirror = place_on_mirror(plane, light, p);
    if (!mirror || glm::length(*mirror - p) == 0) return false;
    const dvec3 d = glm::normalize(*mirror - p);
    if (glm::dot(d, n) <= 0) return false;
    const TriangleId met = first_by_tree(rays, {p, d, from, n});
    if (met == kNoTriangle || !(scene.material(met).reflect > 0)) return false;
    if (!(std::abs(glm::dot(glm::normalize(area_normal(scene, met)), plane.normal)) > 1 - 1e-6)) return false;
    if (!(falloff(light, vec3(*mirror)) > 0)) return false;
    const Towards on = towards(light, *mirror);
    return first_by_tree(rays, {*mirror, on.direction, met, plane.normal, on.distance * (1 - 1e-5)}) == kNoTriangle;
}

}  // namespace

std::vector<MirrorPlane> mirror_planes(const Scene& scene, std::size_t most) {
    const double near = 1e-6 * static_cast<double>(bounds(scene).diagonal());
    std::vector<MirrorPlane> planes;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        if (!(scene.material(t).reflect > 0)) continue;
        const dvec3 cross   = area_normal(scene, t);
        const double length = glm::length(cross);
        if (!(length > 0) || !is_flat(scene, t, cross / length)) continue;
        const dvec3 normal  = cross / length;
        const double offset = glm::dot(normal, dvec3(scene.vertex(t, 0)));
        const auto same     = std::ranges::find_if(planes, [&](const MirrorPlane& plane) {
            const double turn = glm::dot(plane.normal, normal) < 0 ? -1 : 1;
            return glm::length(plane.normal - turn * normal) < 1e-6 && std::abs(plane.offset - turn * offset) <= near;
        });
        if (same == planes.end())
            planes.push_back({normal, offset, length / 2});
        else
            same->area += length / 2;
    }
    std::ranges::stable_sort(planes, std::ranges::greater(), &MirrorPlane::area);
    planes.resize(std::min(planes.size(), most));
    return planes;
}

std::vector<std::uint8_t> lit_by_mirrors(const RayScene& rays, const Scene& scene, const PointBatch& points,
                                         LightId light, const std::vector<MirrorPlane>& planes) {
    std::vector<std::uint8_t> lit(points.size(), 0);
    parallel_ranges(points.size(), 512, [&](std::size_t begin, std::size_t end) {
        const FlushDenormals flush;
        for (std::size_t i = begin; i < end; ++i) {
            if (points.triangle[i] == kNoTriangle) continue;
            const dvec3 p = exact_position(scene, points, i), n = glm::normalize(dvec3(points.normal(i)));
            lit[i] = std::ranges::any_of(planes, [&](const MirrorPlane& plane) {
                return reaches_over(plane, rays, scene, scene.lights[light], p, points.triangle[i], n);
            });
        }
    });
    return lit;
}

}  // namespace umbra
