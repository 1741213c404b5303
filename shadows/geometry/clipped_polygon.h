// A convex polygon, or a segment, that planes cut.
//
// This work is based on:
// Ivan Sutherland, Gary Hodgman. Reentrant Polygon Clipping. 1974
#pragma once

#include <array>
#include <cstddef>

namespace umbra {

/// Where the position is computed at which a plane cuts an edge from a to b.
enum class CutFrom : bool {
    first,  ///< from a
    inner   ///< from the corner that is kept: the same from both sides of the edge
};

/// Up to kMost corners: those that it begins with, and one more for each plane.
template <class Vec, std::size_t kMost>
struct ClippedPolygon {
    std::array<Vec, kMost> corners;
    std::size_t count = 0;

    void add(const Vec& corner) {
        if (count < kMost) corners[count++] = corner;
    }
    /// Keeps the positions where at(position), a linear function, is >= 0. A segment stays one.
    template <CutFrom from, class At>
    void cut(const At& at, bool is_segment = false) {
        ClippedPolygon kept;
        for (std::size_t k = 0; k < count; ++k) {
            const Vec &a = corners[k], &b = corners[(k + 1) % count];
            const double at_a = at(a), at_b = at(b);
            if (at_a >= 0) kept.add(a);
            if (is_segment && k == 1) break;  // the way back
            if ((at_a < 0) == (at_b < 0)) continue;
            if (from == CutFrom::inner && at_a < 0)
                kept.add(b + (at_b / (at_b - at_a)) * (a - b));
            else
                kept.add(a + (at_a / (at_a - at_b)) * (b - a));
        }
        *this = kept;
    }
};

}  // namespace umbra
