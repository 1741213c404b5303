// The shadow volumes of one light, seen from a view: their faces as regions of a tree of points.
#pragma once

#include <span>
#include <vector>

#include "umbra/shadows/geometry/exact_point.h"
#include "umbra/shadows/volumes/counting_tree.h"
#include "umbra/shadows/volumes/silhouettes.h"

namespace umbra {

/// The vertices of meshes, seen from a view; all lights use them.
struct SeenVertices {
    SeenVertices(const SilhouetteMeshes& meshes, const ViewFrame& view);

    std::vector<dvec3> at;
    double radius = 0;  ///< of all, from O
};

/// Directions from the light are in the view's frame. Vertex v ends at infinity in direction `far(v)`: v less the
/// light, or the light's direction. On its path there it stays in the plane through O, v and `travel`.
///
/// `orientation`, in all functions: +1 for a triangle taken as wound, -1 for one taken turned over. Functions that add
/// to counts may run in several threads at once.
class SeenVolumes {
public:
    /// `vertices` are those of `meshes`, seen from the tree's view; all must outlive this object.
    SeenVolumes(const SilhouetteMeshes& meshes, const SeenVertices& vertices, const Light& light,
                const CountingTree& tree);

    /// The near cap of a triangle: region and weight of its crossings.
    void add_near_cap(PointCounts& counts, TriangleId t, int orientation, bool depth_fail) const;

    /// The far cap: directions in which a point at infinity lies in the triangle's volume.
    void add_far_cap(PointCounts& counts, TriangleId t, int orientation) const;

    /// The side that an edge extrudes.
    void add_side(PointCounts& counts, const ChangeEdge& e, bool depth_fail) const;

    /// In how many volumes the view's origin lies: by the same planes, and the same rule where it lies in one.
    /// `orientation`: of each triangle, 0 where it bounds no volume.
    [[nodiscard]] std::int32_t count_at_origin(std::span<const std::int8_t> orientation) const;

private:
    /// A triangle as the light sees it, anticlockwise; behind.p + behind_offset > 0 on its far side.
    struct Cap {
        uvec3 corners;
        dvec3 behind;
        double behind_offset = 0, doubt = 0;
        bool origin_behind = false;
    };
    [[nodiscard]] Cap near_cap(TriangleId t, int orientation) const;

    /// A side's plane, its normal out of the volume of a triangle that runs the edge from a to b.
    struct VolumePlane {
        dvec3 normal;
        double offset = 0, doubt = 0;
        bool origin_outside = false;
    };
    [[nodiscard]] VolumePlane side_plane(std::uint32_t a, std::uint32_t b) const;

    /// The plane through O and an edge, made the same for both directions of the edge; `sense` is -1 for the second.
    struct Line {
        dvec3 normal;
        double doubt = 0;
        int sense    = +1;

        [[nodiscard]] HalfSpace side(int which) const { return HalfSpace::side(normal, 0, which, doubt); }
    };
    [[nodiscard]] Line edge(std::uint32_t from, std::uint32_t to) const;
    [[nodiscard]] Line far_edge(std::uint32_t from, std::uint32_t to) const;

    [[nodiscard]] Line end_line(std::uint32_t v) const;

    [[nodiscard]] dvec3 far(std::uint32_t v) const { return at_infinity_ ? travel_ : vertices_[v] + travel_; }
    /// Sum of the lengths of the terms of `far`.
    [[nodiscard]] double far_size(std::uint32_t v) const {
        return glm::length(travel_) + (at_infinity_ ? 0 : glm::length(vertices_[v]));
    }
    [[nodiscard]] bool is_near_origin(double offset, double doubt) const;
    /// Sign of the determinant of b - a, a vector c and O - a. Exact.
    [[nodiscard]] int side_of_origin(vec3 a, vec3 b, const exact_visibility::Rational3& c) const;

    const SilhouetteMeshes& meshes_;
    const Light& light_;
    const dvec3 origin_;
    bool at_infinity_;
    dvec3 travel_;
    const std::vector<dvec3>& vertices_;
    double largest_w_;
    double slack_;  ///< by how much rounding may move n.(X, Y, Z)/Z + nw/Z, for a normal of products of length 1
};

}  // namespace umbra
