// Exact visibility of area lights: how much of a rectangle, disk or sphere light a named surface point sees.
#pragma once

#include <vector>

#include "umbra/core/scene/lights.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/exact/covering.h"
#include "umbra/shadows/exact/exact_point.h"
#include "umbra/shadows/exact/light_space.h"
#include "umbra/shadows/shared/box_tree.h"
#include "umbra/shadows/shared/light_points.h"

namespace umbra {

class ExactArea {
public:
    enum class Arithmetic : std::uint8_t { filtered, rational };

    struct Answer {
        float visibility = 0;
        float half_width = 0;      ///< of what is proven: the truth lies within visibility -+ half_width
        bool edge_on     = false;  ///< the point lies in the light's plane: nothing to take a share of
    };

    /// What one thread needs for itself.
    struct Workspace {
        Covering<double> in_double;
        Covering<Rational> in_rationals;
        struct Change {
            std::uint32_t edge;
            int change;
        };
        std::vector<Change> changes;
        TriangleId last = kNoTriangle;  ///< hid the whole light of an earlier point
        TriangleId own  = kNoTriangle;  ///< the point's triangle, and which others were found in its plane
        std::vector<std::pair<TriangleId, bool>> in_plane;
        std::vector<std::uint8_t> cap_lit, cap_open;
        std::uint64_t rational_points = 0;  ///< where doubles could not tell
    };

    explicit ExactArea(Arithmetic arithmetic) : arithmetic_(arithmetic) {}

    /// `scene` and `triangles`, the tree of the boxes of its triangles, must outlive this object.
    void build(const Scene& scene, const BoxTree& triangles);
    void aim(const Light& light);

    /// For a point of triangle `own`; `partly`: the triangle's plane cuts the light; `turn`: -1 where the side that
    /// sees is against the triangle's winding, else 1.
    [[nodiscard]] Answer seen(TriangleId own, float u, float v, bool partly, int turn, Workspace& work) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct CastEdge {
        std::uint32_t a = 0, b = 0;          ///< welded vertices, a < b
        std::uint32_t first = 0, count = 0;  ///< its triangles: a run of uses_
        vec3 normal[2]{vec3(0), vec3(0)};    ///< where it has two: their unit normals, rounded; 0 where they are thin
    };
    /// Holds the normals of edges' triangles, so turned that an edge whose two see p from one side casts no shadow.
    struct Cone {
        vec3 axis{0};
        float half_angle = 4, sine = 0, cosine = 1;  ///< beyond a right angle it holds everything, and the rest is idle
    };
    [[nodiscard]] static Cone cone_of(vec3 axis, float half_angle);
    [[nodiscard]] static Cone joined(const Cone& a, const Cone& b);
    [[nodiscard]] Cone cone_of(const CastEdge& edge) const;
    [[nodiscard]] static bool all_alike(const Cone& cone, const Box& box, dvec3 p);

    struct Query;
    template <class Space>
    class Share;

    [[nodiscard]] bool frame_of(const ExactPoint& p, LightPlane& frame) const;
    [[nodiscard]] vec3 at(std::uint32_t vertex) const { return scene_->positions[topology_.position[vertex]]; }
    [[nodiscard]] int face_sign(const Query& query, TriangleId t) const;
    [[nodiscard]] int change_at(const Query& query, const CastEdge& edge) const;
    void gather(const Query& query, const FloatSpace& space) const;

    Arithmetic arithmetic_;
    const Scene* scene_       = nullptr;
    const BoxTree* triangles_ = nullptr;
    Topology topology_;
    std::vector<EdgeUse> uses_;
    std::vector<CastEdge> edges_;
    std::vector<BoxTree> edge_tree_;  ///< one, or none before build
    std::vector<Cone> cones_;         ///< one a node of it

    Light light_;
    dvec3 half_u_{0}, half_v_{0};           ///< rectangle: half edges; disk: perpendicular radii
    std::vector<std::int8_t> plane_side_;   ///< of each welded vertex to the light's plane; a sphere has none
    std::vector<TriangleId> across_light_;  ///< those that may pass through the light
};

}  // namespace umbra
