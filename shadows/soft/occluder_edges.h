// The edges at which the number of triangles between a point and a light can change.
//
// Triangles have the sign of their orientation as the point sees it (geometry/edges.h).
//
//        l        Of an edge on the segment from a point p to a point l of the light, p and l are on opposite sides of
//       /         every plane through the edge. So where the whole light is on one side of a triangle's plane, the sign
//    --q--        is known for every point before that edge is looked at; where this makes all triangles of an edge
//     /           cancel, no point sees it as a silhouette edge before this light.
//    p
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/math.h"
#include "umbra/core/base/rounding.h"
#include "umbra/core/render/ray.h"
#include "umbra/shadows/geometry/box_tree.h"
#include "umbra/shadows/geometry/edges.h"
#include "umbra/shadows/light_rays/target.h"

namespace umbra::soft {

/// Which of eight points see a plane from which side, as far as floats can tell: bit k is for lane k.
struct Sides {
    std::uint32_t front = 0, back = 0;  ///< where neither is set floats cannot tell
};

/// Convex regions in ray space, one a lane: where all planes are positive. Lanes that were not set are empty.
class Shafts {
public:
    static constexpr std::size_t kPlanes = 5;

    Shafts() {
        for (float& x : offset_[0]) x = -kInfinity;
    }

    /// The point that a lane's shaft comes from.
    void set_point(std::size_t lane, vec3 o) { o_x_[lane] = o.x, o_y_[lane] = o.y, o_z_[lane] = o.z; }

    /// On which side of the plane through `on` each point is. `normal`: rounded from a unit vector, or zero, on neither
    /// side of which any point is.
    [[nodiscard]] Sides sides_of(vec3 normal, vec3 on) const {
        // Coordinates differ by 4 at most: of the normal each is off by 2^-22, and products and sums by as much.
        constexpr float sure = 0x1p-17f;
        std::int32_t front[kLanes], back[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) {
            const float above = normal.x * (o_x_[k] - on.x) + normal.y * (o_y_[k] - on.y) + normal.z * (o_z_[k] - on.z);
            front[k] = above > sure ? 1 : 0, back[k] = above < -sure ? 1 : 0;
        }
        return {bits(front), bits(back)};
    }

    /// Plane `plane` of a lane: dot(normal, q - from) + offset >= 0.
    void set(std::size_t lane, std::size_t plane, dvec3 normal, dvec3 from, double offset) {
        // Coordinates are within 2 each way. A normal's component is rounded, and so are its product, and three sums.
        const double size  = sum_of_magnitudes(normal);
        const double slack = 0x1p-19 * (4 * size + std::abs(offset));
        x_[plane][lane] = static_cast<float>(normal.x), y_[plane][lane] = static_cast<float>(normal.y),
        z_[plane][lane]      = static_cast<float>(normal.z);
        offset_[plane][lane] = static_cast<float>(offset - glm::dot(normal, from) + slack);
    }

    /// The lanes whose region may meet it.
    [[nodiscard]] std::uint32_t meeting(const Box& box) const {
        const vec3 c = 0.5f * (box.min + box.max), h = box.max - c;
        std::int32_t inside[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) inside[k] = 1;
        for (std::size_t p = 0; p < kPlanes; ++p)
            for (std::size_t k = 0; k < kLanes; ++k) {
                const float middle = x_[p][k] * c.x + y_[p][k] * c.y + z_[p][k] * c.z + offset_[p][k];
                const float reach  = std::abs(x_[p][k]) * h.x + std::abs(y_[p][k]) * h.y + std::abs(z_[p][k]) * h.z;
                inside[k] &= middle + reach >= 0 ? 1 : 0;
            }
        return bits(inside);
    }
    [[nodiscard]] std::uint32_t meeting(vec3 a, vec3 b) const {
        std::int32_t inside[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) inside[k] = 1;
        for (std::size_t p = 0; p < kPlanes; ++p)
            for (std::size_t k = 0; k < kLanes; ++k) {
                const float at_a = x_[p][k] * a.x + y_[p][k] * a.y + z_[p][k] * a.z + offset_[p][k];
                const float at_b = x_[p][k] * b.x + y_[p][k] * b.y + z_[p][k] * b.z + offset_[p][k];
                inside[k] &= ((at_a >= 0) | (at_b >= 0)) ? 1 : 0;
            }
        return bits(inside);
    }

private:
    static std::uint32_t bits(const std::int32_t (&inside)[kLanes]) {
        std::uint32_t found = 0;
        for (std::size_t k = 0; k < kLanes; ++k) found |= static_cast<std::uint32_t>(inside[k]) << k;
        return found;
    }

    float o_x_[kLanes]{}, o_y_[kLanes]{}, o_z_[kLanes]{};
    float x_[kPlanes][kLanes]{}, y_[kPlanes][kLanes]{}, z_[kPlanes][kLanes]{}, offset_[kPlanes][kLanes]{};
};

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
