// The edges at which the number of triangles between a point and a light can change.
//
// An edge is one where its triangles, each with the sign of its orientation as the point sees it, do not cancel: so any
// soup of triangles has a right answer, whether it is closed or not and however it is wound.
//
//        l        Of an edge on the segment from a point p to a point l of the light, p and l are on opposite sides of
//       /         every plane through the edge. So where the whole light is on one side of a triangle's plane, the sign
//    --q--        is known for every point before that edge is looked at; where this makes all triangles of an edge
//     /           cancel, no point sees it as a silhouette edge before this light.
//    p
//
// This work is based on:
// Samuli Laine, Timo Aila, Ulf Assarsson, Jaakko Lehtinen, Tomas Akenine-Moeller. Soft Shadow Volumes for Ray Tracing.
// 2005
// Byungmoon Kim, Kihwan Kim, Greg Turk. A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters. 2008
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "umbra/core/render/ray.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/geometry/box_tree.h"
#include "umbra/shadows/light_rays/target.h"
#include "umbra/shadows/soft/shafts.h"

namespace umbra::soft {

/// The triangles that block light and have an area, in ray space, and their edges. Const members may be called from
/// many threads.
class OccluderEdges {
public:
    OccluderEdges(const Scene& scene, const RaySpace& space);

    [[nodiscard]] std::size_t triangles() const { return corners_.size(); }
    [[nodiscard]] bool blocks(TriangleId t) const { return blocks_[t] != 0; }
    [[nodiscard]] vec3 corner(TriangleId t, int k) const { return vertices_[corners_[t][k]]; }
    [[nodiscard]] vec3 vertex(std::uint32_t v) const { return vertices_[v]; }
    [[nodiscard]] std::span<const Edge> edges() const { return edges_; }
    [[nodiscard]] std::span<const EdgeUse> uses(std::uint32_t first, std::uint32_t count) const {
        return {uses_.data() + first, count};
    }

    /// +1 where p lies on the side of the triangle's plane that its normal points to, -1 on the other, 0 in the plane.
    /// Exact.
    [[nodiscard]] int side_of(TriangleId t, vec3 p) const;

    /// Whether the triangle's point (1 - u - v, u, v) lies within `distance` of one of its edges.
    [[nodiscard]] bool is_next_to_edge(TriangleId t, float u, float v, double distance) const;

    /// Rounded; 0 where the triangle is so thin that rounding might turn it.
    [[nodiscard]] vec3 unit_normal(TriangleId t) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    std::vector<vec3> vertices_;  ///< welded
    std::vector<uvec3> corners_;
    std::vector<std::uint8_t> blocks_;
    std::vector<Edge> edges_;  ///< of triangles that block
    std::vector<EdgeUse> uses_;
};

/// An edge that may be a silhouette edge before one light.
struct LightEdge {
    vec3 a{0}, b{0};                     ///< ray space
    std::uint32_t first = 0, count = 0;  ///< its triangles: a run of uses
    /// Where it has two: their unit normals, rounded, the second one so turned that a point sees a silhouette edge
    /// where it is on different sides of both. Else 0, and of triangles that are too thin to say.
    vec3 normal[2]{vec3(0), vec3(0)};
    int forward = 1;  ///< +1 where its first triangle runs it from a to b, else -1
};

/// An edge in some of eight shafts: bit k is for lane k.
struct ShaftEdge {
    std::uint32_t edge  = 0;
    std::uint32_t lanes = 0;            ///< that may see it as a silhouette edge in their shaft
    std::uint32_t plus = 0, minus = 0;  ///< those that see a change of +2 or -2 there (LightEdges::change_at)
};

/// The edges that count before one area light. Const members may be called from many threads.
class LightEdges {
public:
    /// `edges` must outlive this object.
    LightEdges(const OccluderEdges& edges, const rays::Target& light);

    [[nodiscard]] const LightEdge& edge(std::uint32_t e) const { return edges_[e]; }

    /// Writes the edges that may lie in some of the shafts: all of those, and some that only come close.
    void gather(const Shafts& shafts, std::vector<ShaftEdge>& found) const;

    /// By how much more triangles lie to the left of the edge from a to b than to its right, as p sees it, for an edge
    /// that lies between p and the light. `own`, on which p lies, does not count. Exact.
    [[nodiscard]] int change_at(const LightEdge& edge, vec3 p, TriangleId own) const;

    /// Triangles that come so close to the light that rays may end before they reach them.
    [[nodiscard]] std::span<const TriangleId> near_light() const { return near_light_; }

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    const OccluderEdges* occluders_;
    std::vector<std::int8_t> side_;  ///< of each triangle: the side that all of the light is on, 0 where it has none
    std::vector<LightEdge> edges_;
    std::optional<BoxTree> tree_;  ///< of the edges
    std::vector<TriangleId> near_light_;
};

}  // namespace umbra::soft
