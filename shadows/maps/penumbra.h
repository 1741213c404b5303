// How large an area light is, and how wide the penumbra that it has behind an occluder is in a map.
#pragma once

#include "umbra/shadows/maps/light_views.h"

namespace umbra {

/// Radius of a disk that has the area of the light, as large as a sphere looks; world units.
[[nodiscard]] double disk_radius(const Light& light);

/// Half sides, along x and y of the frame, of the rectangle whose points are spread about its centre as those of the
/// light are about its own, seen along (direction, 1) in light space: standard deviations agree. Of a rectangle light
/// whose edges run along x and y that is the light itself. World units, in the plane through the light's centre that
/// is parallel to the map.
[[nodiscard]] dvec2 rectangle_as(const LightFrame& frame, const Light& light, dvec2 direction);

/// How far from the line to a light's centre the lines from a point at `depth` to its rim pass the depth z, in samples
/// of a perspective view's map. `size` is half of the light's width; what is nearer than the near plane counts as on
/// it. No less than half a sample, and no more than `most`. Of the penumbra of a half-plane at z, half of the width.
[[nodiscard]] dvec2 penumbra_reach(const MapView& view, dvec2 size, double z, double depth, double most);

}  // namespace umbra
