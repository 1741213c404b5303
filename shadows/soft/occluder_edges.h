// The edges at which the number of triangles between a point and a light can change.
//
// Triangles have the sign of their orientation as the point sees it (geometry/edges.h).
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
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "umbra/core/render/ray.h"
#include "umbra/shadows/geometry/box_tree.h"
#include "umbra/shadows/geometry/edges.h"
#include "umbra/shadows/light_rays/target.h"
#include "umbra/shadows/soft/shafts.h"

namespace umbra::soft {

/// The occluders in ray space. Const members may be called from many threads.
struct RayMesh : OccluderMesh {
    RayMesh(const Scene& of, const RaySpace& space);

    [[nodiscard]] vec3 corner(TriangleId t, int k) const { return vertices[corners[t][k]]; }

    /// +1 where p lies on the side of the triangle's plane that its normal points to, -1 on the other, 0 in the plane.
    /// Exact.
    [[nodiscard]] int side_of(TriangleId t, vec3 p) const;

    /// Whether the triangle's point (1 - u - v, u, v) lies within `distance` of one of its edges.
    [[nodiscard]] bool is_next_to_edge(TriangleId t, float u, float v, double distance) const;

    [[nodiscard]] std::size_t memory_bytes() const;

    std::vector<vec3> vertices;  ///< welded
};

/// An edge that may be a silhouette edge before one light.
struct LightEdge {
    vec3 a{0}, b{0};                     ///< ray space
    std::uint32_t first = 0, count = 0;  ///< its triangles: a run of uses
    vec3 normal[2]{vec3(0), vec3(0)};    ///< where it has two: normal_unless_thin, turned
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
    /// `mesh` must outlive this object.
    LightEdges(const RayMesh& mesh, const rays::Target& light);

    [[nodiscard]] const LightEdge& edge(std::uint32_t e) const { return edges_[e]; }

    /// Writes the edges that may lie in some of the shafts: all of those, and some that only come close.
    void gather(const Shafts& shafts, std::vector<ShaftEdge>& found) const;

    /// The change at an edge that lies between p and the light, as p sees it; `own`, on which p lies, does not count.
    /// Exact.
    [[nodiscard]] int change_at(const LightEdge& edge, vec3 p, TriangleId own) const;

    /// Triangles that come so close to the light that rays may end before they reach them.
    [[nodiscard]] std::span<const TriangleId> near_light() const { return near_light_; }

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    const RayMesh* mesh_;
    std::vector<std::int8_t> side_;  ///< of each triangle: the side that all of the light is on, 0 where it has none
    std::vector<LightEdge> edges_;
    std::optional<BoxTree> tree_;  ///< of the edges
    std::vector<TriangleId> near_light_;
};

}  // namespace umbra::soft
