// The edges of triangles, and those at which triangles do not cancel.
//
// An edge has any number of triangles. Each has a sign, such as the side of it that a light is on, and runs the edge
// forward, from a to b, or backward. The change at the edge is the sum of the signs of those that run it forward, less
// that of those that run it backward:
//
//         b
//        /|\           As a light sees it, by how many more triangles lie to the edge's left than to its right.
//    +1 / | \ +1       Here, where both face the light, that is 0. Where one folds back over the other, both lie on one
//       \ | /          side, and the number of triangles over a point changes by two. So any soup of triangles has
//        \|/           right numbers, closed or open, and however it is wound.
//         a
//
// This work is based on:
// Philippe Bergeron. A General Version of Crow's Shadow Volumes. 1986
// Byungmoon Kim, Kihwan Kim, Greg Turk. A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters. 2008
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/scene/topology.h"

namespace umbra {

/// A triangle that runs an edge: an EdgeUse in half its memory.
struct PackedUse {
    std::uint32_t triangle : 31;
    std::uint32_t forward : 1;  ///< from a to b; otherwise from b to a
};

/// An edge at which the triangles do not cancel.
struct ChangeEdge {
    std::uint32_t a = 0, b = 0;  ///< welded vertices, a < b
    std::int32_t change = 0;     ///< not 0
};

/// The change at an edge of these uses; sign(t) is that of triangle t, asked once a use, in their order.
template <class Sign>
[[nodiscard]] int change_of(std::span<const PackedUse> uses, const Sign& sign) {
    int change = 0;
    for (const PackedUse& use : uses) {
        const int s = sign(TriangleId{use.triangle});  // NOLINT(bugprone-signed-char-misuse): a sign
        change += use.forward != 0 ? s : -s;
    }
    return change;
}

/// The normal of a triangle, turned over where that runs the edge backward: of two triangles that a point sees from
/// opposite sides of their turned normals the signs cancel.
[[nodiscard]] inline vec3 turned(vec3 normal, PackedUse use) { return use.forward != 0 ? normal : -normal; }

/// The unit normal, rounded; 0 where the triangle is so thin that rounding might turn it.
[[nodiscard]] vec3 normal_unless_thin(vec3 a, vec3 b, vec3 c);

/// side_of_light of each of the scene's triangles. Parallel.
[[nodiscard]] std::vector<std::int8_t> sides_of_light(const Scene& scene, const Light& light);

/// Edges in the order of a topology, each with those of its triangles that count.
class EdgeList {
public:
    EdgeList() = default;
    /// Vertices are counted from `first_vertex`, triangles over the scene. Triangle t of the topology counts where
    /// left_out[t] is 0, and where there is no such list.
    explicit EdgeList(const Topology& topology, std::uint32_t first_vertex = 0,
                      std::span<const std::uint8_t> left_out = {});

    [[nodiscard]] std::size_t size() const { return std::max<std::size_t>(starts_.size(), 1) - 1; }
    /// Its triangles are a run of uses.
    [[nodiscard]] Edge operator[](std::size_t e) const {
        return {starts_[e].a, starts_[e].b, starts_[e].first, starts_[e + 1].first - starts_[e].first};
    }
    [[nodiscard]] std::span<const PackedUse> uses(std::uint32_t first, std::uint32_t count) const {
        return {uses_.data() + first, count};
    }
    [[nodiscard]] std::span<const PackedUse> uses(std::size_t e) const {
        return {uses_.data() + starts_[e].first, uses_.data() + starts_[e + 1].first};
    }
    template <class Sign>
    [[nodiscard]] int change(std::size_t e, const Sign& sign) const {
        return change_of(uses(e), sign);
    }
    /// The edges at which triangles with these signs do not cancel, after `others`.
    [[nodiscard]] std::vector<ChangeEdge> changes(std::span<const std::int8_t> signs,
                                                  std::vector<ChangeEdge> others = {}) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Start {
        std::uint32_t a, b;
        std::uint32_t first;  ///< of its uses, which end where those of the next edge begin
    };
    std::vector<Start> starts_;  ///< of the edges, and one more
    std::vector<PackedUse> uses_;
};

/// A scene's triangles, welded, and the edges of those that block light and have an area.
struct OccluderMesh {
    /// `of` must outlive this object.
    explicit OccluderMesh(const Scene& of);

    [[nodiscard]] bool blocks(TriangleId t) const { return left_out[t] == 0; }
    [[nodiscard]] bool has_area(TriangleId t) const { return left_out[t] != 1; }
    [[nodiscard]] vec3 position(std::uint32_t vertex) const { return scene.positions[positions[vertex]]; }
    [[nodiscard]] std::size_t memory_bytes() const;

    const Scene& scene;
    std::vector<uvec3> corners;            ///< of each triangle of the scene: welded vertices
    std::vector<std::uint32_t> positions;  ///< of each welded vertex: an index into Scene::positions
    std::vector<std::uint8_t> left_out;  ///< one a triangle: 1 without an area, else 2 where it does not block, else 0
    EdgeList edges;
};

}  // namespace umbra
