// Outlines: the edges on a receiver at which the number of shadows over a point changes.
//
// Every triangle that casts a shadow counts once, whichever way it is wound. Along an edge that two of them share,
// their shadows lie on both sides and cancel, or on one side and add up: of a mesh there remain its silhouette and its
// borders, some ten thousand edges of a million triangles.
//
//        +---------+
//       /    1    /|         change of an edge = shadows to its left - shadows to its right (geometry/edges.h)
//      +---------+2|
//      |    2    | |         The count over p is that over a reference point, plus what the edges between them change.
//      |       p | +         p is lit where it is 0.
//      |         |/
//      +---------+
//
// The triangles that the plane cuts and those that come close to the height of the source, whose corners have no place
// on the plane, are left out and cast their shadows one by one (project.h).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "umbra/shadows/geometry/edges.h"
#include "umbra/shadows/planar/project.h"

namespace umbra::planar {

/// The shadow of an edge, in a receiver's coordinates.
struct OutlineEdge {
    dvec2 from{0}, to{0};
    double slack = 0;            ///< how far rounding may have moved an end in x or y
    EdgeFunction side{0, 0, 0};  ///< positive to the left, seen from `from` to `to`
    double doubt  = 0;  ///< a side of at most this magnitude may have the wrong sign, anywhere in Outline::reach
    double change = 0;  ///< shadows to the left less those to the right: a whole number, not 0
};

/// The shadows on one receiver from one source.
struct Outline {
    Reach reach;                     ///< where points may be asked
    std::vector<OutlineEdge> edges;  ///< those that may pass through it
    dvec2 reference{0};              ///< a point in it
    double count = 0;                ///< shadows over that point, of the triangles that the edges bound
    std::vector<Shadows> rest;       ///< of the triangles that the edges leave out

    [[nodiscard]] std::size_t memory_bytes() const;
};

/// Adds to `change` the edge's changes of the count on the way from `from` along x to (to.x, from.y), then along y to
/// `to`, of several points `to`. Where rounding leaves that open, |edge.change| is added to `doubt`.
template <std::size_t lanes>
void add_changes(const OutlineEdge& edge, dvec2 from, const double (&to_x)[lanes], const double (&to_y)[lanes],
                 double (&change)[lanes], double (&doubt)[lanes]) {
    // Most edges are short, and beside the way to all.
    const double low_x  = std::min(edge.from.x, edge.to.x) - edge.slack,
                 high_x = std::max(edge.from.x, edge.to.x) + edge.slack;
    const double low_y  = std::min(edge.from.y, edge.to.y) - edge.slack,
                 high_y = std::max(edge.from.y, edge.to.y) + edge.slack;
    const bool strip_y  = from.y >= low_y && from.y <= high_y;
    int near_x          = 0;
    for (std::size_t k = 0; k < lanes; ++k) near_x |= (to_x[k] >= low_x) & (to_x[k] <= high_x);
    if (!strip_y && near_x == 0) return;

    const EdgeFunction s = edge.side;
    const double first   = s.at(from.x, from.y);
    const bool left = first > 0, near_first = std::abs(first) <= edge.doubt;
    const bool spans_y = (edge.from.y <= from.y) != (edge.to.y <= from.y);
    // As factors: loops without branches become vector code.
    const double along_x = spans_y ? edge.change : 0, doubt_x = strip_y ? std::abs(edge.change) : 0;
    const double size = std::abs(edge.change), was_left = left ? 1 : 0, was_near = near_first ? doubt_x : 0;
    for (std::size_t k = 0; k < lanes; ++k) {
        const double turn = s.at(to_x[k], from.y), last = s.at(to_x[k], to_y[k]);
        const double turn_left = turn > 0 ? 1.0 : 0.0, last_left = last > 0 ? 1.0 : 0.0;
        const double along_y = (edge.from.x <= to_x[k]) != (edge.to.x <= to_x[k]) ? edge.change : 0.0;
        change[k] += along_x * (turn_left - was_left) + along_y * (last_left - turn_left);
        const double near_turn = std::abs(turn) <= edge.doubt ? 1.0 : 0.0;
        const double near_last = std::abs(last) <= edge.doubt ? 1.0 : 0.0;
        const double strip_x   = to_x[k] >= low_x && to_x[k] <= high_x ? size : 0.0;
        doubt[k] += was_near + near_turn * doubt_x + strip_x * (near_turn + near_last);
    }
}

/// Places in a box, as fractions of its sides, of which one is, as good as always, away from all edges.
inline constexpr std::array<std::array<double, 2>, 4> kPlaces{
    {{0.5012893, 0.4970367}, {0.4571811, 0.5370713}, {0.5320179, 0.4679841}, {0.3819571, 0.6180713}}};

/// The outlines on all receivers from all sources: [source][receiver].
using LightOutlines = std::vector<std::vector<Outline>>;
[[nodiscard]] std::size_t memory_bytes(const LightOutlines& outlines);

/// Projects from every source onto every receiver: outlines where there is the scene's `mesh`, empty ones where the
/// source is not above a receiver; else every triangle for itself (Outline::rest). Throws UsageError where several
/// sources' shadows take more than `memory_limit` bytes: how many would fit. One source is never refused. In use there
/// may be one source's shadows more than the limit for a moment.
[[nodiscard]] LightOutlines project(const Occluders& occluders, const OccluderMesh* mesh,
                                    std::span<const Receiver> receivers, std::span<const Source> sources,
                                    double memory_limit);

}  // namespace umbra::planar
