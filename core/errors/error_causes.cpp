#include "umbra/core/errors/error_causes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
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

/// How high the occluder is above the plane through p with unit normal n: where the segment to a hard light meets it.
double height_of_occluder(const Light& light, dvec3 p, dvec3 n, dvec3 a, dvec3 b, dvec3 c) {
    const dvec3 of_triangle = glm::cross(b - a, c - a);
    if (!is_area(light.kind)) {
        const dvec3 way   = light.kind == LightKind::directional ? -dvec3(light.direction) : dvec3(light.position) - p;
        const double sink = glm::dot(of_triangle, way);
        if (sink != 0) return std::abs(glm::dot(of_triangle, a - p) / sink * glm::dot(n, way));
    }
    return distance_to_triangle(p, a, b, c);
}

/// Enough of an object's vertices to know how far it reaches in any direction.
class Reach {
public:
    Reach(const Scene& scene, const Object& object) {
        std::vector<std::uint32_t> vertices;
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
            for (int k = 0; k < 3; ++k) vertices.push_back(scene.triangles[t][k]);
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        if (vertices.size() > kDirections) vertices = extremes(scene, vertices);
        for (const std::uint32_t v : vertices) positions_.emplace_back(scene.positions[v]);
    }

    /// The highest of them above the plane through p with normal n; 0 where none is above it.
    [[nodiscard]] double highest(dvec3 p, dvec3 n) const {
        double height = 0;
        for (const dvec3& v : positions_) height = std::max(height, glm::dot(n, v - p));
        return height;
    }

private:
    /// Directions some 14 degrees apart: the farthest vertex along one of them is at most a hundredth of the object's
    /// size short of the farthest along any direction.
    static constexpr std::size_t kDirections = 256;

    static std::vector<std::uint32_t> extremes(const Scene& scene, const std::vector<std::uint32_t>& vertices) {
        std::vector<std::uint32_t> found(kDirections);
        parallel_ranges(kDirections, 8, [&](std::size_t begin, std::size_t end) {
            for (std::size_t d = begin; d < end; ++d) {
                // A spiral from pole to pole with equal areas. [Helmut Vogel, A Better Way to Construct the Sunflower
                // Head, 1979]
                const double z = 1 - (2 * static_cast<double>(d) + 1) / kDirections, r = std::sqrt(1 - z * z),
                             turn = 2.399963229728653 * static_cast<double>(d);
                const dvec3 towards(r * std::cos(turn), r * std::sin(turn), z);
                double farthest = -std::numeric_limits<double>::infinity();
                for (const std::uint32_t v : vertices)
                    if (const double along = glm::dot(towards, dvec3(scene.positions[v])); along > farthest)
                        farthest = along, found[d] = v;
            }
        });
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

    std::vector<dvec3> positions_;
};

}  // namespace

std::vector<std::uint32_t> points_of_class(const ClassPlane& classes, ErrorClass c) {
    std::vector<std::uint32_t> which;
    for (std::size_t i = 0; i < classes.size(); ++i)
        if (classes[i] == c) which.push_back(static_cast<std::uint32_t>(i));
    return which;
}

void mark_terminator(ClassPlane& classes, const Scene& scene, const PointBatch& points, LightId light) {
    if (scene.normals.empty()) return;
    parallel_ranges(classes.size(), 4096, [&](std::size_t begin, std::size_t end) {
        TriangleId flat = kNoTriangle;  // the latest whose corners have its own normal: neighbours lie on it too
        dvec3 flat_face(0);
        for (std::size_t i = begin; i < end; ++i) {
            ErrorClass& c = classes[i];
            if (c == ErrorClass::no_surface || c == ErrorClass::unshadowed || c == ErrorClass::not_judged ||
                c == ErrorClass::undefined || c == ErrorClass::on_boundary)
                continue;
            const dvec3 face = points.normal(i);
            if (points.triangle[i] == flat && face == flat_face) continue;  // most scenes' points
            const auto corners = corner_normals(scene, points.triangle[i], face);
            if (corners[0] == face && corners[1] == face && corners[2] == face) {
                flat      = points.triangle[i];
                flat_face = face;
                continue;
            }
            const bool facet   = c != ErrorClass::away;
            const dvec3 normal = shading_normal(scene, points, i);
            if (glm::length(normal - face) <= kSameNormal) continue;
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
    const Light& l = scene.lights[light];
    std::map<std::uint32_t, Reach> reaches;  // of the objects that are named
    for (std::size_t k = 0; k < which.size(); ++k) {
        if (who[k] == kNoTriangle) continue;
        const std::uint32_t object = scene.triangle_object[who[k]];
        const Reach& reach         = reaches.try_emplace(object, scene, scene.objects[object]).first->second;
        const dvec3 p(points.position(which[k])), n(points.normal(which[k]));
        const double height = height_of_occluder(l, p, n, dvec3(scene.vertex(who[k], 0)),
                                                 dvec3(scene.vertex(who[k], 1)), dvec3(scene.vertex(who[k], 2)));
        double whole        = reach.highest(p, n);
        if (l.kind != LightKind::directional) whole = std::min(whole, glm::dot(n, dvec3(l.position) - p));
        classes[which[k]] = height <= kContact * whole ? ErrorClass::detachment : ErrorClass::leak;
    }
}

}  // namespace umbra
