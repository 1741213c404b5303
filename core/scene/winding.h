// How often an object's surface winds around a point.
#pragma once

#include "umbra/core/scene/scene.h"

namespace umbra {

/// The winding number of a closed object: 1 or -1 inside a simple body, 0 outside, up to rounding, about 1e-12. A point
/// on the surface gives something between. Parallel; the same for any number of threads. [Adriaan van Oosterom, Jan
/// Strackee, The Solid Angle of a Plane Triangle, 1983]
[[nodiscard]] double winding_number(const Scene& scene, const Object& object, dvec3 point);

}  // namespace umbra
