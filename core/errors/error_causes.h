// Why points are wrong: from the scene, and from the triangles that method and reference hold responsible.
#pragma once

#include <span>
#include <vector>

#include "umbra/core/errors/error_classes.h"

namespace umbra {

/// The points of one class, in order.
[[nodiscard]] std::vector<std::uint32_t> points_of_class(const ClassPlane& classes, ErrorClass c);

/// Sets points apart at which the facet (the triangle, exactly) and the shading normal (which the sum uses, in double)
/// disagree on whether any part of the light is in front of them: the smoother a mesh pretends to be, the more.
/// What of them was wrong becomes `terminator_wrong`: there the sum multiplies S_j with 0.
void mark_terminator(ClassPlane& classes, const Scene& scene, const PointBatch& points, LightId light);

/// Interior errors in an area light whose reference has a penumbra there become `penumbra`: a method without penumbrae
/// is wrong there either way, whatever triangle it blames. Lights without an area have none.
void mark_penumbra(ClassPlane& classes, const Scene& scene, LightId light, const VisibilityPlane& reference);

/// `who[k]` is the triangle that the method blames for the shadow at point which[k], a `false_shadow`. That is acne
/// where it is the point's own triangle, has a corner at the position of one of its corners (in bit-equal coordinates),
/// or where the method could name none.
void mark_acne(ClassPlane& classes, const Scene& scene, const PointBatch& points, std::span<const std::uint32_t> which,
               std::span<const TriangleId> who);

/// `who[k]` is the triangle that the reference names as the occluder nearest to point which[k], a `false_light`. The
/// point lies at a contact where that triangle is no farther than kContact pixels: detachment, else a leak. Points
/// whose occluder has no name stay `false_light`.
///
/// The distance is in units of what a pixel spans at the point's depth, across the line of sight. To a light without an
/// area it is taken along the segment to the light, so that it does not change where a triangle is split; a depth bias
/// of that much is what loses the shadow. Area lights have many such segments, and the triangle's own distance is
/// taken.
///
///          light \         occluder on its receiver: along the segment to the light the occluder is near where
///                 \   |    the receiver is near to where they touch. What a bias of b takes off the shadow are points
///                  \  |    with d < b, next to the contact; a hole in the occluder, or a shadow that is not where it
///        ___________\_|___ should be, shows at any d.
///             p |--d--|
void mark_detachment(ClassPlane& classes, const Scene& scene, const PointBatch& points, LightId light,
                     std::span<const std::uint32_t> which, std::span<const TriangleId> who);

/// What is farther from its occluder than this reads as a hole in the shadow, and not as a gap at its root.
inline constexpr double kContact = 16;  // pixels

}  // namespace umbra
