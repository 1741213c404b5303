#include "umbra/shadows/geometry/edges.h"

#include <string>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/geometry/triangle_tree.h"

namespace umbra {

vec3 normal_unless_thin(vec3 a, vec3 b, vec3 c) {
    constexpr double thin = 1e-6;  // sine of an angle below which a normal, a difference of products, may be noise
    const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a), n = glm::cross(ab, ac);
    const double size = glm::length(n);
    // Products below 1e-290 have lost digits.
    return size > thin * glm::length(ab) * glm::length(ac) && size > 1e-290 ? vec3(n / size) : vec3(0);
}

std::vector<std::int8_t> sides_of_light(const Scene& scene, const Light& light) {
    std::vector<std::int8_t> sides(scene.triangles.size());
    parallel_ranges(sides.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            sides[i] = static_cast<std::int8_t>(side_of_light(scene, light, static_cast<TriangleId>(i)));
    });
    return sides;
}

EdgeList::EdgeList(const Topology& topology, std::uint32_t first_vertex, std::span<const std::uint8_t> left_out) {
    constexpr std::size_t kMost = std::size_t{1} << 31;  // what PackedUse::triangle holds
    if (const std::size_t end = topology.first_triangle + topology.triangles.size(); end > kMost)
        throw MethodError("the scene has at least " + std::to_string(end) + " triangles, expected at most 2147483648");
    starts_.reserve(topology.edges.size() + 1);
    uses_.reserve(topology.uses.size());
    const auto used = [&] { return static_cast<std::uint32_t>(uses_.size()); };
    for (const Edge& e : topology.edges) {
        const std::uint32_t first = used();
        for (std::uint32_t k = e.first; k < e.first + e.count; ++k) {
            const EdgeUse& use = topology.uses[k];
            if (left_out.empty() || left_out[use.triangle] == 0)
                uses_.push_back({(topology.first_triangle + use.triangle) & 0x7fffffffu, use.forward ? 1u : 0u});
        }
        if (used() > first) starts_.push_back({first_vertex + e.a, first_vertex + e.b, first});
    }
    starts_.push_back({0, 0, used()});
}

std::vector<ChangeEdge> EdgeList::changes(std::span<const std::int8_t> signs, std::vector<ChangeEdge> others) const {
    for (std::size_t e = 0; e < size(); ++e)
        if (const int at = change(e, [&](TriangleId t) { return signs[t]; }); at != 0)
            others.push_back({starts_[e].a, starts_[e].b, at});
    return others;
}

std::size_t EdgeList::memory_bytes() const {
    return starts_.capacity() * sizeof(Start) + uses_.capacity() * sizeof(PackedUse);
}

OccluderMesh::OccluderMesh(const Scene& of) : scene(of) {
    Topology topology = find_topology(of, 0, static_cast<std::uint32_t>(of.triangles.size()));
    left_out          = std::move(topology.degenerate);
    for (TriangleId t = 0; t < left_out.size(); ++t)
        if (left_out[t] == 0 && !of.blocks(t)) left_out[t] = 2;
    edges     = EdgeList(topology, 0, left_out);
    corners   = std::move(topology.triangles);
    positions = std::move(topology.position);
}

std::size_t OccluderMesh::memory_bytes() const {
    return corners.capacity() * sizeof(uvec3) + positions.capacity() * sizeof(std::uint32_t) + left_out.capacity() +
           edges.memory_bytes();
}

}  // namespace umbra
