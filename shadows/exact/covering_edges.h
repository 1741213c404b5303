// Fills the covering of the light with all that changes the number of layers over it.
#pragma once

#include "umbra/shadows/exact/disk_caps.h"
#include "umbra/shadows/exact/displacement.h"
#include "umbra/shadows/exact/edge_clip.h"
#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_visibility {

template <class Space>
class CoveringEdges {
public:
    using T = typename Space::Number;

    /// All must outlive this object. `covering` is emptied; `caps` may be null.
    CoveringEdges(const Projection<Space>& projection, Covering<T>& covering, DiskCaps* caps)
        : projection_(projection), covering_(covering), caps_(caps) {
        covering_.clear();
    }

    /// Adds the edges, and how far rounding moves them to `displacement`. False where this arithmetic cannot tell.
    [[nodiscard]] bool add(const std::vector<SilhouetteEdge>& silhouette, Displacement& displacement);

private:
    [[nodiscard]] bool add_edge(const CandidateEdge& edge, int change, Displacement& displacement);
    [[nodiscard]] bool add_chord(TriangleId t, Displacement& displacement);
    [[nodiscard]] bool add_clipped(const Numerators<T>& a, const Numerators<T>& b, int change,
                                   Displacement& displacement);

    const Projection<Space>& projection_;
    Covering<T>& covering_;
    DiskCaps* caps_;
};

template <class Space>
bool CoveringEdges<Space>::add(const std::vector<SilhouetteEdge>& silhouette, Displacement& displacement) {
    const Sight& sight = projection_.sight();
    for (const auto& [edge, change] : silhouette)
        if (!add_edge(sight.edges.candidate(edge), change * projection_.orientation(), displacement)) return false;
    for (const TriangleId t : sight.light.across())
        if (t != sight.viewpoint.own() && !add_chord(t, displacement)) return false;
    return true;
}

/// The part of an edge that is before the light's plane.
template <class Space>
bool CoveringEdges<Space>::add_edge(const CandidateEdge& edge, int change, Displacement& displacement) {
    Numerators<T> a = projection_.project(edge.a), b = projection_.project(edge.b);
    const Filtered<bool> a_beyond = projection_.beyond(edge.a, a), b_beyond = projection_.beyond(edge.b, b);
    if (!a_beyond || !b_beyond) return false;
    if (*a_beyond && *b_beyond) return true;
    if (*a_beyond != *b_beyond) {
        const Filtered<Numerators<T>> cut = at_plane(a, b, projection_.space().height());
        if (!cut) return false;
        (*a_beyond ? a : b) = *cut;
    }
    return add_clipped(a, b, change, displacement);
}

/// Where a triangle passes through the light's plane, its part before the plane ends with an edge in the plane.
template <class Space>
bool CoveringEdges<Space>::add_chord(TriangleId t, Displacement& displacement) {
    const uvec3 vertex      = projection_.sight().occluders.corners[t];
    const Numerators<T> q[] = {projection_.project(vertex[0]), projection_.project(vertex[1]),
                               projection_.project(vertex[2])};
    Filtered<bool> beyond[3];
    for (int k = 0; k < 3; ++k) {
        beyond[k] = projection_.beyond(vertex[k], q[k]);
        if (!beyond[k]) return false;
    }
    if (beyond[0] == beyond[1] && beyond[1] == beyond[2]) return true;
    const int side = projection_.side_of(t);
    if (side == 0) return true;
    Numerators<T> leaves{}, comes_back{};
    for (int k = 0; k < 3; ++k) {
        const int n = (k + 1) % 3;
        if (beyond[k] == beyond[n]) continue;
        // As the edge itself is cut, from its lower vertex, so that the ends are the same to the bit.
        const bool forward = vertex[k] < vertex[n];
        const auto cut     = at_plane(forward ? q[k] : q[n], forward ? q[n] : q[k], projection_.space().height());
        if (!cut) return false;
        (*beyond[n] ? leaves : comes_back) = *cut;
    }
    return add_clipped(leaves, comes_back, side, displacement);
}

template <class Space>
bool CoveringEdges<Space>::add_clipped(const Numerators<T>& a, const Numerators<T>& b, int change,
                                       Displacement& displacement) {
    const Filtered<ClippedEdge<T>> edge = clip_around_light(a, b, kCutReach);
    if (!edge) return false;
    if (edge->empty) return true;
    const double px = as_double(edge->from.x), py = as_double(edge->from.y), qx = as_double(edge->to.x),
                 qy = as_double(edge->to.y);
    const double dx = qx - px, dy = qy - py, length = std::sqrt(dx * dx + dy * dy) * (1 + 0x1p-50);
    displacement.move_edge(edge->off, 2 * projection_.sight().plane.rounding, length);
    if (caps_) caps_->touch(px, py, qx, qy);
    covering_.add(edge->from, edge->to, change, edge->from_left, edge->to_left);
    return true;
}

}  // namespace umbra::exact_visibility
