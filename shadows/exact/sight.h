// One point and one light, whatever the arithmetic.
#pragma once

#include "umbra/shadows/exact/aimed_light.h"
#include "umbra/shadows/exact/silhouette_edges.h"
#include "umbra/shadows/exact/triangles_over.h"

namespace umbra::exact_visibility {

struct Sight {
    const Occluders& occluders;
    const SilhouetteEdges& edges;
    const AimedLight& light;
    const LightPlane& plane;  ///< of the light as the point sees it
    const Viewpoint& viewpoint;
    bool partly;          ///< the plane of the point's triangle cuts the light
    int turn;             ///< -1 where the side that sees is against the triangle's winding, else 1
    TrianglesOver& over;  ///< of a group of points that this one may be one of
};

/// The scene's vertices, projected onto the light's plane in one arithmetic.
template <class Space>
class Projection {
public:
    using T = typename Space::Number;

    /// The orientation of `space` must be known. Both must outlive this object.
    Projection(const Sight& sight, const Space& space)
        : sight_(sight), space_(space), orientation_(space.orientation().value()) {}

    [[nodiscard]] const Sight& sight() const { return sight_; }
    [[nodiscard]] const Space& space() const { return space_; }
    [[nodiscard]] int orientation() const { return orientation_; }

    [[nodiscard]] Numerators<T> project(std::uint32_t vertex) const {
        return space_.project(sight_.occluders.position(vertex));
    }
    /// Whether the vertex, q when projected, is in or beyond the light's plane, not before it.
    [[nodiscard]] Filtered<bool> beyond(std::uint32_t vertex, const Numerators<T>& q) const {
        if (const auto side = sight_.light.side_of_vertex(vertex)) return *side * orientation_ >= 0;
        return space_.beyond(q);
    }
    /// The side of triangle t that the point is on, with the orientation of the light's plane. Exact.
    [[nodiscard]] int side_of(TriangleId t) const { return orientation_ * sight_.viewpoint.side_of(t); }

private:
    const Sight& sight_;
    const Space& space_;
    int orientation_;
};

}  // namespace umbra::exact_visibility
