#include "umbra/shadows/soft/occluder_edges.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"

namespace umbra::soft {
namespace {

double largest(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// A parallelepiped about all that any point sees of a light, in ray space, and about where its rays end.
struct LightHull {
    dvec3 centre{0}, u{0}, v{0}, w{0};
    double slack = 0;  ///< rounding of rays' ends, in every coordinate

    explicit LightHull(const rays::Target& light) {
        constexpr double wider = 1 + 1.0 / 8;  // than the square about the light that edges are cut at
        if (light.kind == LightKind::sphere) {
            // The disk that a point sees lies in the sphere, the square about the disk within the square root of two.
            const double r = 1.5 * wider * light.radius;
            centre = light.sphere, u = {r, 0, 0}, v = {0, r, 0}, w = {0, 0, r};
        } else {
            centre = dvec3(light.centre) * light.unit;
            u = dvec3(light.axis_u) * (light.unit * wider), v = dvec3(light.axis_v) * (light.unit * wider);
        }
        slack = 0x1p-20 * (largest(centre) + largest(u) + largest(v) + 4);
    }

    /// The side of the plane through `on` that all of it is on, 0 where there is none.
    [[nodiscard]] std::int8_t side_of_plane_with(dvec3 normal, dvec3 on, double normal_error) const {
        const double at    = glm::dot(normal, centre - on);
        const double reach = std::abs(glm::dot(normal, u)) + std::abs(glm::dot(normal, v)) +
                             std::abs(glm::dot(normal, w)) + 3 * slack * largest(normal) +
                             3 * normal_error * (largest(centre - on) + largest(u) + largest(v) + largest(w) + slack);
        return static_cast<std::int8_t>(at > reach ? 1 : at < -reach ? -1 : 0);
    }

    /// Whether a box comes within `stretch` of it, each way.
    [[nodiscard]] bool meets(const Box& box, double stretch) const {
        const dvec3 reach = glm::abs(u) + glm::abs(v) + glm::abs(w) + dvec3(stretch + slack);
        return glm::all(glm::lessThanEqual(dvec3(box.min) - centre, reach)) &&
               glm::all(glm::lessThanEqual(centre - dvec3(box.max), reach));
    }
};

constexpr double kSceneRadius = 4;  ///< ray space holds the scene within 2 each way

}  // namespace

RayMesh::RayMesh(const Scene& of, const RaySpace& space) : OccluderMesh(of) {
    vertices.reserve(positions.size());
    for (const std::uint32_t p : positions) vertices.push_back(space.point(of.positions[p]));
}

int RayMesh::side_of(TriangleId t, vec3 p) const {
    const vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    // Differences of floats and their products are off by a few roundings of the products' magnitudes.
    const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a), ap = dvec3(p) - dvec3(a);
    const double value = glm::dot(glm::cross(ab, ac), ap);
    const double sure  = 32 * 0x1p-53 * largest(ab) * largest(ac) * largest(ap);
    if (std::abs(value) > sure && sure > 1e-290) return value > 0 ? 1 : -1;
    return side_of_plane(a, b, c, p);
}

bool RayMesh::is_next_to_edge(TriangleId t, float u, float v, double distance) const {
    const dvec3 a(corner(t, 0)), ab = dvec3(corner(t, 1)) - a, ac = dvec3(corner(t, 2)) - a, n = glm::cross(ab, ac);
    const double twice = glm::dot(n, n), d = distance * distance;
    // A weight is the distance from the opposite edge over the height there, which is twice the area over the edge.
    const auto next_to = [&](double weight, dvec3 edge) { return weight * weight * twice <= d * glm::dot(edge, edge); };
    return next_to(double(u), ac) || next_to(double(v), ab) || next_to(1 - double(u) - double(v), ac - ab);
}

std::size_t RayMesh::memory_bytes() const { return OccluderMesh::memory_bytes() + vertices.capacity() * sizeof(vec3); }

LightEdges::LightEdges(const RayMesh& mesh, const rays::Target& light) : mesh_(&mesh) {
    const LightHull hull(light);
    // Rays leave 2^-16 of the segment to the light untraced: twice that, whatever the point.
    const double stretch = 2 * rays::kUntraced * (glm::length(hull.centre) + largest(hull.u) + kSceneRadius);
    side_.resize(mesh.corners.size());
    std::vector<std::uint8_t> is_near(mesh.corners.size());
    parallel_ranges(side_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto t = static_cast<TriangleId>(i);
            if (!mesh.blocks(t)) continue;
            const vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
            const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a);
            side_[t]   = hull.side_of_plane_with(glm::cross(ab, ac), a, 8 * 0x1p-53 * largest(ab) * largest(ac));
            is_near[t] = hull.meets(extend(extend(extend(Box{}, a), b), c), stretch);
        }
    });
    for (TriangleId t = 0; t < is_near.size(); ++t)
        if (is_near[t] != 0) near_light_.push_back(t);
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
        bool known       = true;
        const int change = mesh.edges.change(e, [&](TriangleId t) {
            known = known && side_[t] != 0;
            return side_[t];
        });
        if (known && change == 0) continue;
        const auto [a, b, first, count] = mesh.edges[e];
        LightEdge edge{mesh.vertices[a], mesh.vertices[b], first, count};
        for (std::uint32_t k = 0; count == 2 && k < 2; ++k) {
            const PackedUse use = mesh.edges.uses(first, count)[k];
            const TriangleId t  = use.triangle;
            edge.normal[k] = turned(normal_unless_thin(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)), use);
        }
        edges_.push_back(edge);
    }
    std::vector<Box> boxes(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) boxes[e] = extend(extend(Box{}, edges_[e].a), edges_[e].b);
    tree_.emplace(std::move(boxes));
}

UMBRA_FOR_EACH_PROCESSOR void LightEdges::gather(const Shafts& shafts, std::vector<ShaftEdge>& found) const {
    found.clear();
    tree_->visit_entered([&](const Box& box) { return shafts.meeting(box) != 0; },
                         [&](std::uint32_t e) {
                             const LightEdge& edge = edges_[e];
                             const Sides one       = shafts.sides_of(edge.normal[0], edge.a),
                                         two       = shafts.sides_of(edge.normal[1], edge.a);
                             std::uint32_t lanes   = ~((one.front & two.back) | (one.back & two.front));
                             if ((lanes & 0xffu) == 0) return;
                             lanes &= shafts.meeting(edge.a, edge.b);
                             if (lanes != 0) found.push_back({e, lanes, one.front & two.front, one.back & two.back});
                         });
}

int LightEdges::change_at(const LightEdge& edge, vec3 p, TriangleId own) const {
    return change_of(mesh_->edges.uses(edge.first, edge.count), [&](TriangleId t) {
        return t == own ? 0 : side_[t] != 0 ? -side_[t] : mesh_->side_of(t, p);
    });
}

std::size_t LightEdges::memory_bytes() const {
    return side_.capacity() + edges_.capacity() * sizeof(LightEdge) + (tree_ ? tree_->memory_bytes() : 0) +
           near_light_.capacity() * sizeof(TriangleId);
}

}  // namespace umbra::soft
