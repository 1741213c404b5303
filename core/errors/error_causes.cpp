#include "umbra/core/errors/error_causes.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/errors/shadow_edges.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

/// Normals closer than this are equal except for the rounding of floats: a flat floor has no terminator, not even under
/// a light in its plane.
constexpr double kSameNormal = 1e-6;

/// Is any part of the light in front of the plane through p with unit normal n?
bool faces(const Light& light, dvec3 p, dvec3 n) {
    if (light.kind == LightKind::directional) return glm::dot(n, -dvec3(light.direction)) > 0;
    double reach = 0;  // of the light, along n
    switch (light.kind) {
        case LightKind::rectangle:
            reach = 0.5 * (std::abs(glm::dot(n, dvec3(light.edge_u))) + std::abs(glm::dot(n, dvec3(light.edge_v))));
            break;
        case LightKind::disk:
            reach =
                static_cast<double>(light.radius) * glm::length(glm::cross(n, glm::normalize(dvec3(light.direction))));
            break;
        case LightKind::sphere: reach = static_cast<double>(light.radius); break;
        default: break;
    }
    return glm::dot(n, dvec3(light.position) - p) > -reach;
}

bool share_a_corner(const Scene& scene, TriangleId s, TriangleId t) {
    for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
            if (scene.vertex(s, j) == scene.vertex(t, k)) return true;
    return false;
}

/// How far the occluder is from p: along the way to a hard light, which meets it.
double distance_to_occluder(const Light& light, dvec3 p, dvec3 a, dvec3 b, dvec3 c) {
    const dvec3 n = glm::cross(b - a, c - a);
    if (!is_area(light.kind)) {
        const dvec3 way   = light.kind == LightKind::directional ? -dvec3(light.direction) : dvec3(light.position) - p;
        const double sink = glm::dot(n, way);
        if (sink != 0) return std::abs(glm::dot(n, a - p) / sink) * glm::length(way);
    }
    return distance_to_triangle(p, a, b, c);
}

}  // namespace

std::vector<std::uint32_t> points_of_class(const ClassPlane& classes, ErrorClass c) {
    std::vector<std::uint32_t> which;
    for (std::size_t i = 0; i < classes.size(); ++i)
        if (classes[i] == c) which.push_back(static_cast<std::uint32_t>(i));
    return which;
}

void mark_terminator(ClassPlane& classes, const Scene& scene, const PointBatch& points, LightId light) {
    parallel_ranges(classes.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ErrorClass& c = classes[i];
            if (c == ErrorClass::no_surface || c == ErrorClass::not_judged || c == ErrorClass::undefined ||
                c == ErrorClass::on_boundary)
                continue;
            const bool facet   = c != ErrorClass::away;
            const dvec3 normal = shading_normal(scene, points, i);
            if (glm::length(normal - dvec3(points.normal(i))) <= kSameNormal) continue;
            if (faces(scene.lights[light], dvec3(points.position(i)), normal) == facet) continue;
            c = !facet                   ? ErrorClass::terminator_away
                : c == ErrorClass::right ? ErrorClass::terminator
                                         : ErrorClass::terminator_wrong;
        }
    });
}

void mark_penumbra(ClassPlane& classes, const Scene& scene, LightId light, const VisibilityPlane& reference) {
    if (!is_area(scene.lights[light].kind)) return;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        const bool interior = classes[i] == ErrorClass::false_shadow || classes[i] == ErrorClass::false_light;
        if (interior && is_penumbra(reference.s[i])) classes[i] = ErrorClass::penumbra;
    }
}

void mark_acne(ClassPlane& classes, const Scene& scene, const PointBatch& points, std::span<const std::uint32_t> which,
               std::span<const TriangleId> who) {
    for (std::size_t k = 0; k < which.size(); ++k) {
        const TriangleId own = points.triangle[which[k]];
        if (who[k] == kNoTriangle || who[k] == own || share_a_corner(scene, own, who[k]))
            classes[which[k]] = ErrorClass::acne;
    }
}

void mark_detachment(ClassPlane& classes, const Scene& scene, const PointBatch& points, LightId light,
                     std::span<const std::uint32_t> which, std::span<const TriangleId> who) {
    for (std::size_t k = 0; k < which.size(); ++k) {
        if (who[k] == kNoTriangle) continue;
        const dvec3 p(points.position(which[k]));
        const double distance = distance_to_occluder(scene.lights[light], p, dvec3(scene.vertex(who[k], 0)),
                                                     dvec3(scene.vertex(who[k], 1)), dvec3(scene.vertex(who[k], 2)));
        classes[which[k]] =
            distance <= kContact * pixel_span(points, which[k]) ? ErrorClass::detachment : ErrorClass::leak;
    }
}

}  // namespace umbra
