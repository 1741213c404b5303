// Exact visibility of area lights: how much of a rectangle, disk or sphere light a named surface point sees.
#pragma once

#include "umbra/shadows/exact/visible_part.h"

namespace umbra::exact_detail {

class ExactArea {
public:
    /// `filtered`: in doubles with a bound on the error, and in rationals where the bound is not small.
    enum class Arithmetic : std::uint8_t { filtered, rational };

    struct Answer {
        float visibility = 0;  ///< visible area of the light over its area, in [0, 1]
        float half_width = 0;  ///< of what is proven: the truth lies within visibility -+ half_width. 0.5 -+ 0.5
                               ///< where nothing is known: a sphere light so near, or so far and small, that
                               ///< rounding hides which part of it the point sees
        float irradiance = 0;  ///< with Measure::irradiance: what arrives from the visible part of the light
                               ///< over what arrives from all of it that is before the plane of the point's
                               ///< triangle, in [0, 1]; else it means nothing
        float irradiance_half_width = 0;      ///< the truth lies within irradiance -+ this
        bool edge_on                = false;  ///< the point lies in the light's plane: nothing to take a fraction of
    };

    /// What one thread needs for itself, from point to point. `rational_points` counts those that doubles could not
    /// answer.
    struct Workspace {
        CoplanarTriangles coplanar;
        std::vector<SilhouetteEdge> silhouette;
        std::vector<TriangleId> between;
        PartialCovering<double> in_double;
        PartialCovering<Rational> in_rationals;
        TriangleId blocker            = kNoTriangle;  ///< hid the whole light of an earlier point
        std::uint64_t rational_points = 0;
    };

    explicit ExactArea(Arithmetic arithmetic, Measure measure = Measure::area)
        : arithmetic_(arithmetic), measure_(measure) {}

    /// `scene` and `triangles`, the tree of the boxes of its triangles, must outlive this object.
    void build(const Scene& scene, const BoxTree& triangles);
    void aim(const Light& light);

    /// For a point of triangle `own`; `partly`: the triangle's plane cuts the light; `turn`: -1 where the side that
    /// sees is against the triangle's winding, else 1. From any thread, each with a workspace of its own.
    [[nodiscard]] Answer seen(TriangleId own, float u, float v, bool partly, int turn, Workspace& work) const;

    /// Of a rectangle light through occluders that let a part of the light through: the visible fraction with what
    /// passes those, per channel, where `seen` is the answer without them. Off by less than 1e-9. Nothing where that
    /// takes more than kMostCells cells.
    [[nodiscard]] std::optional<vec3> seen_through(TriangleId own, float u, float v, bool partly, int turn,
                                                   const Answer& seen, Workspace& work) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    [[nodiscard]] Answer seen_in_rough_plane(const Sight& sight, Workspace& work) const;

    Arithmetic arithmetic_;
    Measure measure_;
    Occluders occluders_;
    SilhouetteEdges edges_;
    AimedLight light_;
};

}  // namespace umbra::exact_detail
