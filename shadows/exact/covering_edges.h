// Fills the covering of the light with all that changes the number of layers over it.
#pragma once

#include <algorithm>

#include "umbra/shadows/exact/covering.h"
#include "umbra/shadows/exact/disk_caps.h"
#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_visibility {

// Edges are cut off around the light:
//
//      .-------------------.  reach     What lies outside of |x|, |y| <= reach covers nothing of the light. An edge
//      |    .---------.    |            that leaves the square ends on its rim; where it does so on the left, the sweep
//   ---+----+---*     |    |            counts it in and out (Covering::add), elsewhere the gap is of no consequence.
//      |    |  light  |    |
//      |    '---------'    |
//      '-------------------'

/// Chosen: so far outside the light, |x|, |y| <= 1, that no rounding of a cut reaches it.
inline constexpr double kCutReach = 1 + 1.0 / 16;

/// Where edges are looked for: beyond kCutReach, so that no rounding of a test loses one that is cut there.
inline constexpr double kGatherReach = 1 + 1.0 / 8;

template <class T>
struct ClippedEdge {
    bool empty = true;  ///< nothing of the edge is left, and the rest means nothing
    typename Covering<T>::Point from{}, to{};
    bool from_left = false, to_left = false;  ///< cut off on the square's left side
    double off = 0;                           ///< how far rounding may have moved an end in x and in y
};

/// For the edge from a to b, and the square |x|, |y| <= around.
template <class T>
Filtered<ClippedEdge<T>> clip_around_light(const Numerators<T>& a, const Numerators<T>& b, double around) {
    const T reach(around);
    const T inside_a[] = {a.x + reach * a.w, reach * a.w - a.x, a.y + reach * a.w, reach * a.w - a.y};
    const T inside_b[] = {b.x + reach * b.w, reach * b.w - b.x, b.y + reach * b.w, reach * b.w - b.y};
    double error       = 0;
    if constexpr (std::is_same_v<T, double>) {
        const double size =
            std::max({std::abs(a.x), std::abs(a.y), std::abs(a.w), std::abs(b.x), std::abs(b.y), std::abs(b.w)});
        error = std::max(a.error, b.error) + 8 * kUnit * size;
        // Next to the point itself an end's side of the square may be noise, far from the point it does not matter.
        const auto lost = [&](const T(&inside)[4], double w) {
            if (w > 16 * error) return false;
            for (const T& d : inside)
                if (std::abs(d) <= (around + 2) * error) return true;
            return false;
        };
        if (lost(inside_a, a.w) || lost(inside_b, b.w)) return kUnsure;
    }
    T from(0), to(1);
    double doubt = 0;                // of from and to
    int cut_from = -1, cut_to = -1;  // side of the square; 0: left
    for (int k = 0; k < 4; ++k) {
        const bool out_a = inside_a[k] <= 0, out_b = inside_b[k] <= 0;
        if (out_a && out_b) return ClippedEdge<T>{};
        if (!out_a && !out_b) continue;
        const T t = inside_a[k] / (inside_a[k] - inside_b[k]);
        if constexpr (std::is_same_v<T, double>)
            doubt = std::max(doubt, 4 * (around + 2) * error / std::abs(inside_a[k] - inside_b[k]));
        if (out_a && t >= from) from = t, cut_from = k;
        if (out_b && t <= to) to = t, cut_to = k;
    }
    if constexpr (std::is_same_v<T, double>)
        if (std::abs(from - to) <= doubt) return kUnsure;
    if (from >= to) return ClippedEdge<T>{};
    const Numerators<T> low  = cut_from < 0 ? a : between(a, b, from);
    const Numerators<T> high = cut_to < 0 ? b : between(a, b, to);
    double off               = 0;
    if constexpr (std::is_same_v<T, double>) {
        // |x|, |y| <= kCutReach, say: a quotient is off by less than 3 errors over w; an end that is cut, by its cut,
        // too. That w exceeds 16 errors makes such first-order bounds hold with a factor to spare.
        const double w = std::min(low.w, high.w);
        if (!(w > 16 * error)) return kUnsure;
        off = 8 * error / w + 2 * kUnit;
    } else {
        if (low.w == 0 || high.w == 0) return ClippedEdge<T>{};  // through the surface point: projected to one point
    }
    return ClippedEdge<T>{
        false, {low.x / low.w, low.y / low.w}, {high.x / high.w, high.y / high.w}, cut_from == 0, cut_to == 0, off};
}

// How wrong the visible area is where the corners of edges are rounded:
//
//        b'----b         Move the ends of an edge from where they belong, a and b, to where they came to lie, a' and
//       /     /          b'. The number of layers over a point changes only while an edge passes over it, so the area
//      /     /           is wrong by at most that under moving edges. An edge whose ends move by at most delta
//     a'----a            in x and in y passes over less than 3 delta length + 8 delta^2. (Ends that are cut off around
//                        the light move along their edge, too, but out there.)

struct Displacement {
    double swept    = 0;  ///< area that the edges pass over
    double by_frame = 0;  ///< the part of it that no other arithmetic changes
    double widest   = 0;  ///< the most that an end moves by itself

    /// The ends move by `own` each by itself, and by `frame` since the light's plane itself is rounded. The layers are
    /// counted and the edges projected in that one plane, so that the two agree whatever `frame` is.
    void move_edge(double own, double frame, double length) {
        const double delta = own + frame;
        swept += 3 * delta * length + 8 * delta * delta;
        by_frame += 3 * frame * length + 8 * frame * frame;
        widest = std::max(widest, own);
    }
};

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
