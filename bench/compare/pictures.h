// Pictures of S_j planes and of differences: one fixed colour scale each, so that any two can be compared.
#pragma once

#include <span>

#include "umbra/core/errors/error_classes.h"
#include "umbra/core/image/image.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// Grey: 0 umbra is black, 1 lit is white, linear. No surface: dark blue. Undefined: hatched.
[[nodiscard]] Image visibility_picture(const PointBatch& points, const VisibilityPlane& plane);

/// Signed s - reference: blue false shadow, near-white equal, red false light (ColorBrewer's RdBu, colour-blind safe).
[[nodiscard]] Image difference_picture(const PointBatch& points, LightId light, const VisibilityPlane& plane,
                                       const VisibilityPlane& reference);

/// Each wrong point in the colour of its class (bench/pages/error_palette.h); what is right in a grey that shows the
/// reference's S_j. Points that the light is behind are dark, undefined ones hatched, no surface: dark blue.
[[nodiscard]] Image class_picture(const PointBatch& points, const ClassPlane& classes,
                                  const VisibilityPlane& reference);

/// A FLIP map, 0 black to 1 light yellow (a monotone ramp in lightness after matplotlib's "magma" end points). Points
/// at which some light has no answer are hatched: the reference's pixel stood in for theirs.
[[nodiscard]] Image flip_picture(const PointBatch& points, std::span<const VisibilityPlane> planes,
                                 std::span<const float> map);

}  // namespace umbra
