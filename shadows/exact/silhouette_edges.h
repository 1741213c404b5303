// The edges of a scene at which the number of triangles over a light can change, and, for one point, those at which it
// does: the silhouette edges of everything between the point and the light.
//
// An edge is one where its triangles, each with the sign of its orientation as the point sees it, do not cancel. These
// signs are exact.
//
// This work is based on:
// Samuli Laine et al. Soft Shadow Volumes for Ray Tracing. 2005
#pragma once

#include <array>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/shadows/exact/light_space.h"
#include "umbra/shadows/exact/normal_cone.h"
#include "umbra/shadows/exact/occluders.h"
#include "umbra/shadows/exact/viewpoint.h"

namespace umbra::exact_visibility {

/// An edge that may be a silhouette edge.
struct CandidateEdge : Edge {
    vec3 at{0};                        ///< a
    vec3 normal[2]{vec3(0), vec3(0)};  ///< where it has one triangle or two: normal_unless_thin, turned
};

/// A candidate and its change as the point sees it with the world's orientation. Not 0.
struct SilhouetteEdge {
    std::uint32_t candidate;
    int change;
};

/// Edges that may be silhouette edges for some of several points. Coordinates are relative to one of these, rounded to
/// float, in a list each, so that a loop takes eight edges at a time.
struct EdgeGroup {
    dvec3 origin{0};
    std::vector<std::uint32_t> edges{};
    std::array<std::vector<float>, 3> a{}, b{};           ///< both ends
    std::array<std::vector<float>, 3> first{}, second{};  ///< turned normals of two triangles; 0 where there is
                                                          ///< none, or it is thin

    // For one point.
    std::vector<std::int32_t> out{};                       ///< 1: surely not a silhouette edge before the light
    std::vector<std::uint32_t> left{};                     ///< those that may be a silhouette edge,
    std::array<std::vector<float>, 3> left_a{}, left_b{};  ///< and their ends
};

class SilhouetteEdges {
public:
    /// `occluders` must outlive this object.
    explicit SilhouetteEdges(const Occluders& occluders);

    /// All silhouette edges that may lie before the light and within |x|, |y| <= `reach` of its plane, for one point.
    void gather(const Viewpoint& viewpoint, const FloatSpace& space, double reach,
                std::vector<SilhouetteEdge>& found) const;

    /// Candidates for several points that lie together: for the point of `viewpoint` and for all at most `around` from
    /// it in every coordinate. `region`: between the first one and all that any of them sees of the light and of the
    /// square around it. False where there are more than `most`.
    [[nodiscard]] bool gather_around(const Viewpoint& viewpoint, BoxTree::Region region, double around,
                                     std::size_t most, EdgeGroup& group) const;
    /// As `gather`, among the candidates of a group, for one of its points.
    void pick(const Viewpoint& viewpoint, const FloatSpace& space, double reach, EdgeGroup& group,
              std::vector<SilhouetteEdge>& found) const;

    [[nodiscard]] const CandidateEdge& candidate(std::uint32_t k) const { return edges_[k]; }
    [[nodiscard]] std::size_t candidates() const { return edges_.size(); }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    [[nodiscard]] std::vector<Box> find_candidates();
    [[nodiscard]] std::span<const PackedUse> uses(const Edge& edge) const {
        return occluders_.edges.uses(edge.first, edge.count);
    }
    [[nodiscard]] bool continue_each_other(const CandidateEdge& edge) const;
    [[nodiscard]] NormalCone cone_of(const CandidateEdge& edge) const;
    [[nodiscard]] int change_at(const Viewpoint& viewpoint, const CandidateEdge& edge) const;

    const Occluders& occluders_;
    std::vector<CandidateEdge> edges_{};  ///< in the order of the tree
    BoxTree tree_;                        ///< of the edges
    std::vector<NormalCone> cones_;  ///< one a node: normals of its triangles, so turned that the two of an edge see
                                     ///< the point from one side unless it is a silhouette edge
};

}  // namespace umbra::exact_visibility
