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
/// Those of them that were wrong become `terminator_wrong`: there the sum multiplies S_j with 0.
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
/// point lies at a contact where that occluder is low over it: detachment, else a leak. Points whose occluder has no
/// name stay `false_light`.
///
/// Low means: where the segment to the light meets the triangle, it is no higher above the plane of the point's own
/// triangle than kContact times the occluder's height: that of the highest vertex of the triangle's object, or of the
/// light where that is lower. To an area light there are many segments, and the triangle's distance from the point is
/// compared instead.
///
///          light \         The occluder's foot throws the shadow's root, its top throws the shadow's tip, and
///                 \   |    the height h at which a segment meets the occluder grows evenly from one to the other.
///                  \  |h   A bias takes the shadow off from the root on. A hole in the occluder, or a shadow that
///        ___________\_|___ is not where it should be, shows at any h; an occluder in the air has no small h.
///                   p
/// Both heights are lengths in the world, so that a class does not depend on the size of the picture, the distance of
/// the eye or the unit of lengths.
void mark_detachment(ClassPlane& classes, const Scene& scene, const PointBatch& points, LightId light,
                     std::span<const std::uint32_t> which, std::span<const TriangleId> who);

/// The part of a shadow, from its root, that reads as a gap there when it is lost, and not as a hole in the shadow.
inline constexpr double kContact = 0.5;

}  // namespace umbra
