// Where rounding hides which of two is nearer: a triangle, or the disk that stands for a sphere light.
//
//        ----p----           The plane of the disk is rounded, and may lie a little nearer or farther. A triangle that
//            .               crosses it at a small angle, or is flush with it, is before the one plane and beyond the
//     =====-----=====        other over a wide strip.
//     disk  `-._  triangle
//              `-._
#pragma once

#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_visibility {

/// Bound of the area of the light, in half axes, over which that is so of any triangle. 0 for flat lights, whose plane
/// is exact.
[[nodiscard]] double area_in_doubt(const Sight& sight);

/// Whether all of triangle t is before the light's plane wherever rounding may have moved that.
[[nodiscard]] bool surely_before_light(const Sight& sight, TriangleId t);

}  // namespace umbra::exact_visibility
