// Exact visibility of area lights: how much of a rectangle, disk or sphere light a named surface point sees.
#pragma once

#include <span>
#include <string>

#include "umbra/core/render/points.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/exact/visible_part.h"

namespace umbra::exact_visibility {

/// The geometry, whatever the light.
struct AreaOccluders {
    /// `scene` and `triangles`, the tree of the boxes of its triangles, must outlive this object.
    AreaOccluders(const Scene& scene, const BoxTree& triangles) : occluders(scene, triangles), edges(occluders) {}
    AreaOccluders(const AreaOccluders&)            = delete;
    AreaOccluders& operator=(const AreaOccluders&) = delete;

    const Occluders occluders;
    const SilhouetteEdges edges;

    [[nodiscard]] std::size_t memory_bytes() const { return occluders.memory_bytes() + edges.memory_bytes(); }
};

/// One light among the occluders, to be asked from points.
class ExactArea {
public:
    /// `filtered`: in doubles with a bound on the error, and in rationals where the bound is not small.
    enum class Arithmetic : std::uint8_t { filtered, rational };

    struct Answer {
        float visibility = 0;  ///< visible area of the light over its area, in [0, 1]
        float half_width = 0;  ///< proven: the truth lies within visibility -+ half_width. 0.5 -+ 0.5 where nothing is
                               ///< known: of a sphere light so near, or so far and small, that rounding hides it
        float irradiance = 0;  ///< with Measure::irradiance: that of the visible part of the light over that of all of
                               ///< it before the plane of the point's triangle, in [0, 1]; else undefined
        float irradiance_half_width = 0;      ///< the truth lies within irradiance -+ this
        bool edge_on                = false;  ///< the point lies in the light's plane: nothing to take a fraction of
    };

    /// How an answer came about.
    struct Account {
        Answer answer;
        std::size_t edges      = 0;  ///< silhouette edges that were looked at
        std::size_t open_sides = 0;  ///< triangles of which doubles do not tell on which side the point is
        std::string arithmetic{};    ///< of all else
        std::size_t pieces = 0;      ///< of the visible part
        std::vector<std::vector<dvec2>> outlines{};  ///< its corners in half axes: anticlockwise around a piece,
                                                     ///< clockwise around a hole. Of a round light without those on
                                                     ///< its rim. None where nothing is known of them
    };

    /// The memory of one thread, from point to point. `rational_points` counts those that doubles could not answer,
    /// `steps` the work, in units of about 100 ns.
    struct Workspace {
        CoplanarTriangles coplanar;
        std::vector<SilhouetteEdge> silhouette;
        EdgeGroup group;     ///< edges for all points of a group
        TrianglesOver over;  ///< triangles for all of them
        bool in_group             = false;
        std::size_t most_together = PointTile::kPoints;  ///< for more points a search has failed lately, which costs
                                                         ///< as much as one that succeeds
        std::vector<TriangleId> between;
        PartialCovering<double> in_double;
        PartialCovering<Rational> in_rationals;
        TriangleId blocker            = kNoTriangle;  ///< hid the whole light of an earlier point
        std::uint64_t rational_points = 0, steps = 0;
    };

    /// `light` is aimed among these occluders. Both must outlive this object, which refers to them.
    ExactArea(const AreaOccluders& among, const AimedLight& light, Arithmetic arithmetic,
              Measure measure = Measure::area)
        : occluders_(among.occluders), edges_(among.edges), light_(light), arithmetic_(arithmetic), measure_(measure) {}

    /// Calls see(i) for all these points of the batch, in any order; changes the order of `which`. Points that lie
    /// together have one search: while it runs, `seen` may be called with this workspace for i alone.
    template <class See>
    void for_all(const PointBatch& points, std::span<std::uint32_t> which, Workspace& work, const See& see) const {
        work.in_group = which.size() <= work.most_together && look_around(points, which, work);
        if (work.in_group)
            work.most_together = std::max(work.most_together, 2 * which.size());
        else if (which.size() <= work.most_together)
            work.most_together = std::max(2 * kFewest, which.size() / 2);
        if (work.in_group || which.size() < 2 * kFewest) {
            for (const std::uint32_t i : which) see(i);
            work.in_group = false;
            work.over.clear();
            return;
        }
        halve(points, which);
        for_all(points, which.first(which.size() / 2), work, see);
        for_all(points, which.subspan(which.size() / 2), work, see);
    }

    /// For a point of triangle `own`; `partly`: the triangle's plane cuts the light; `turn`: -1 where the side that
    /// sees is against the triangle's winding, else 1. From any thread, each with a workspace of its own.
    [[nodiscard]] Answer seen(TriangleId own, float u, float v, bool partly, int turn, Workspace& work) const;
    /// The same, and how it came about. Need not be fast.
    [[nodiscard]] Account account(TriangleId own, float u, float v, bool partly, int turn) const;

    /// The visible fraction of a rectangle light through occluders that let a part of the light through, per channel,
    /// where `seen` is the answer without them. The error is below 1e-9. Nothing where that takes more than kMostCells
    /// cells.
    [[nodiscard]] std::optional<vec3> seen_through(TriangleId own, float u, float v, bool partly, int turn,
                                                   const Answer& seen, Workspace& work) const;

private:
    static constexpr std::size_t kFewest = 4;  ///< points for which it is worth looking once for all of them

    [[nodiscard]] bool look_around(const PointBatch& points, std::span<const std::uint32_t> which,
                                   Workspace& work) const;
    static void halve(const PointBatch& points, std::span<std::uint32_t> which);
    void find_silhouette(const Viewpoint& viewpoint, const FloatSpace& space, Workspace& work) const;
    [[nodiscard]] Answer seen_in_rough_plane(const Sight& sight, Workspace& work) const;

    const Occluders& occluders_;
    const SilhouetteEdges& edges_;
    const AimedLight& light_;
    Arithmetic arithmetic_;
    Measure measure_;
};

}  // namespace umbra::exact_visibility
