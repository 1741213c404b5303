// Scenes changed in ways that leave every S_j as it was, or change it by a known rule: metamorphic relations.
//
// Nothing is rendered again. A surface point is named exactly by its triangle and barycentrics, and the same points are
// asked for in the changed scene, by the names they have there.
// [T. Y. Chen, S. C. Cheung, S. M. Yiu, Metamorphic Testing: A New Approach for Generating Next Test Cases, 1998]
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// A scene and the points that S_j is asked for.
struct Question {
    Scene scene;
    PointBatch points;
};

/// A changed scene, and where everything went. S_j of light j at point i before is, afterwards, the sum of
/// weight * S at point[i] over lights[j].
struct Changed {
    Question after;
    std::vector<std::size_t> point;
    struct Part {
        LightId light = 0;
        float weight  = 1;
    };
    std::vector<std::vector<Part>> lights;
    bool exact = true;  ///< no vertex, light or barycentric was rounded: both scenes are the same in exact numbers
};

/// The scene with its numbers made coarse, so that much can be done to it without rounding, and the points that its
/// camera sees in a raster of that size.
///   vertices            multiples of 2^-22 of a power of two above the largest coordinate: midpoints, threefold scale
///                       and moves by the scene's own size stay floats
///   lights              positions and edges likewise, of 2^-18
///   barycentrics        odd multiples of 2^-13 for u and v, none of the three 0 or one half: no point lies on an edge
///                       of its triangle, nor of the parts that the triangle is split into
[[nodiscard]] Question dyadic(Scene scene, int width, int height);

/// The same with all lights taken as points: area lights at their centres, spots as they are.
[[nodiscard]] Question with_point_lights(const Question& from);
/// The same with every point or spot light made a rectangle that faces the scene, an eighth of its distance wide.
[[nodiscard]] Question with_rectangles(const Question& from);

// ---- rigid motion, scale -------------------------------------------------------------------------------------------
[[nodiscard]] Changed axes_cycled(const Question& from);  ///< (x, y, z) becomes (z, x, y): a turn by 120 degrees. Exact
[[nodiscard]] Changed quarter_turn(const Question& from);  ///< about y. Exact
[[nodiscard]] Changed moved(const Question& from);         ///< by about its own size. Exact unless a light is far away
[[nodiscard]] Changed turned_and_moved(const Question& from);       ///< by angles and lengths that round every vertex
[[nodiscard]] Changed scaled(const Question& from, double factor);  ///< exact for powers of two and for 3
[[nodiscard]] Changed mirrored(
    const Question& from);  ///< in x; triangles keep their outside, the picture turns over. Exact

// ---- order ---------------------------------------------------------------------------------------------------------
[[nodiscard]] Changed triangles_shuffled(const Question& from);  ///< within their objects, positions too. Exact
[[nodiscard]] Changed objects_reversed(const Question& from);    ///< exact
[[nodiscard]] Changed lights_reversed(const Question& from);     ///< exact

// ---- parts ---------------------------------------------------------------------------------------------------------
/// Of three triangles one is cut in two from the middle of an edge, its neighbours not (T-junctions), one in three from
/// a point within. Exact.
[[nodiscard]] Changed triangles_split(const Question& from);
/// Each triangle in four, by the middles of its edges. Exact.
[[nodiscard]] Changed subdivided(const Question& from);
/// Each rectangle light in four parts, a quarter and three quarters one way, halves the other way. Other lights stay.
/// Exact unless a light is far away.
[[nodiscard]] Changed rectangles_split(const Question& from);

// ---- size of lights ------------------------------------------------------------------------------------------------
/// Point and spot lights become rectangles, disks and spheres in turn, `share` of their distance from the scene's
/// centre wide. Others stay.
[[nodiscard]] Changed lights_grown(const Question& from, double share);

/// The same scene, asked for only the points for which `keep` says so, each at its old index among entries that are no
/// point. With the raster or without.
[[nodiscard]] Question asked_for_some(const Question& from, const std::vector<std::uint8_t>& keep, bool with_raster);

}  // namespace umbra
