#include "umbra/shadows/soft/occluder_edges.h"

#include <algorithm>
#include <cmath>

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

OccluderEdges::OccluderEdges(const Scene& scene, const RaySpace& space) {
    const auto triangles = static_cast<std::uint32_t>(scene.triangles.size());
    Topology topology    = find_topology(scene, 0, triangles);
    corners_             = std::move(topology.triangles);
    vertices_.reserve(topology.position.size());
    for (const std::uint32_t p : topology.position) vertices_.push_back(space.point(scene.positions[p]));
    blocks_.resize(triangles);
    for (TriangleId t = 0; t < triangles; ++t) blocks_[t] = topology.degenerate[t] == 0 && scene.blocks(t);
    for (const Edge& e : topology.edges) {
        Edge edge{e.a, e.b, static_cast<std::uint32_t>(uses_.size()), 0};
        for (std::uint32_t k = e.first; k < e.first + e.count; ++k)
            if (blocks(topology.uses[k].triangle)) uses_.push_back(topology.uses[k]);
        edge.count = static_cast<std::uint32_t>(uses_.size()) - edge.first;
        if (edge.count > 0) edges_.push_back(edge);
    }
}

int OccluderEdges::side_of(TriangleId t, vec3 p) const {
    const vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    // Differences of floats and their products are off by a few roundings of the products' magnitudes.
    const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a), ap = dvec3(p) - dvec3(a);
    const double value = glm::dot(glm::cross(ab, ac), ap);
    const double sure  = 32 * 0x1p-53 * largest(ab) * largest(ac) * largest(ap);
    if (std::abs(value) > sure && sure > 1e-290) return value > 0 ? 1 : -1;
    return side_of_plane(a, b, c, p);
}

bool OccluderEdges::is_next_to_edge(TriangleId t, float u, float v, double distance) const {
    const dvec3 a(corner(t, 0)), ab = dvec3(corner(t, 1)) - a, ac = dvec3(corner(t, 2)) - a, n = glm::cross(ab, ac);
    const double twice = glm::dot(n, n), d = distance * distance;
    // A weight is the distance from the opposite edge over the height there, which is twice the area over the edge.
    const auto next_to = [&](double weight, dvec3 edge) { return weight * weight * twice <= d * glm::dot(edge, edge); };
    return next_to(double(u), ac) || next_to(double(v), ab) || next_to(1 - double(u) - double(v), ac - ab);
}

vec3 OccluderEdges::unit_normal(TriangleId t) const {
    constexpr double thin = 1e-6;  // sine of an angle below which a normal, a difference of products, may be noise
    const dvec3 a(corner(t, 0)), ab = dvec3(corner(t, 1)) - a, ac = dvec3(corner(t, 2)) - a, n = glm::cross(ab, ac);
    const double size = glm::length(n);
    return size > thin * glm::length(ab) * glm::length(ac) && size > 1e-290 ? vec3(n / size) : vec3(0);
}

std::size_t OccluderEdges::memory_bytes() const {
    return vertices_.capacity() * sizeof(vec3) + corners_.capacity() * sizeof(uvec3) + blocks_.capacity() +
           edges_.capacity() * sizeof(Edge) + uses_.capacity() * sizeof(EdgeUse);
}

LightEdges::LightEdges(const OccluderEdges& edges, const rays::Target& light) : occluders_(&edges) {
    const LightHull hull(light);
    // Rays leave 2^-16 of the segment to the light untraced: twice that, whatever the point.
    const double stretch = 2 * rays::kUntraced * (glm::length(hull.centre) + largest(hull.u) + kSceneRadius);
    side_.resize(edges.triangles());
    std::vector<std::uint8_t> is_near(edges.triangles());
    parallel_ranges(side_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto t = static_cast<TriangleId>(i);
            if (!edges.blocks(t)) continue;
            const vec3 a = edges.corner(t, 0), b = edges.corner(t, 1), c = edges.corner(t, 2);
            const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a);
            side_[t]   = hull.side_of_plane_with(glm::cross(ab, ac), a, 8 * 0x1p-53 * largest(ab) * largest(ac));
            is_near[t] = hull.meets(extend(extend(extend(Box{}, a), b), c), stretch);
        }
    });
    for (TriangleId t = 0; t < is_near.size(); ++t)
        if (is_near[t] != 0) near_light_.push_back(t);
    for (const Edge& e : edges.edges()) {
        int change = 0;
        bool known = true;
        for (const EdgeUse& use : edges.uses(e.first, e.count)) {
            known = known && side_[use.triangle] != 0;
            change += use.forward ? side_[use.triangle] : -side_[use.triangle];
        }
        if (known && change == 0) continue;
        LightEdge edge{edges.vertex(e.a), edges.vertex(e.b), e.first, e.count};
        const auto uses = edges.uses(e.first, e.count);
        edge.forward    = uses[0].forward ? 1 : -1;
        if (e.count == 2) {
            edge.normal[0] = edges.unit_normal(uses[0].triangle);
            edge.normal[1] = edges.unit_normal(uses[1].triangle) * (uses[0].forward == uses[1].forward ? -1.0f : 1.0f);
        }
        edges_.push_back(edge);
    }
    std::vector<Box> boxes(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) boxes[e] = extend(extend(Box{}, edges_[e].a), edges_[e].b);
    tree_.emplace(std::move(boxes));
}

void LightEdges::gather(const Shafts& shafts, std::vector<ShaftEdge>& found) const {
    found.clear();
    tree_->visit_entered(
        [&](const Box& box) { return shafts.meeting(box) != 0; },
        [&](std::uint32_t e) {
            const LightEdge& edge = edges_[e];
            const Sides one = shafts.sides_of(edge.normal[0], edge.a), two = shafts.sides_of(edge.normal[1], edge.a);
            std::uint32_t lanes = ~((one.front & two.front) | (one.back & two.back));
            if ((lanes & 0xffu) == 0) return;
            lanes &= shafts.meeting(edge.a, edge.b);
            if (lanes == 0) return;
            const std::uint32_t front = one.front & two.back, back = one.back & two.front;
            found.push_back({e, lanes, edge.forward > 0 ? front : back, edge.forward > 0 ? back : front});
        });
}

int LightEdges::change_at(const LightEdge& edge, vec3 p, TriangleId own) const {
    int change = 0;
    for (const EdgeUse& use : occluders_->uses(edge.first, edge.count)) {
        if (use.triangle == own) continue;
        const int side = side_[use.triangle] != 0 ? -side_[use.triangle] : occluders_->side_of(use.triangle, p);
        change += use.forward ? side : -side;
    }
    return change;
}

std::size_t LightEdges::memory_bytes() const {
    return side_.capacity() + edges_.capacity() * sizeof(LightEdge) + (tree_ ? tree_->memory_bytes() : 0) +
           near_light_.capacity() * sizeof(TriangleId);
}

}  // namespace umbra::soft
