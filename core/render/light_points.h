// Points of area lights: the parts of a light that samples and explanations are asked at.
#pragma once

#include "umbra/core/base/math.h"
#include "umbra/core/scene/lights.h"

namespace umbra {

/// Perpendicular radii of a disk light, world units; with the light's direction a right-handed frame.
struct DiskAxes {
    dvec3 u, v;
};
[[nodiscard]] DiskAxes disk_axes(const Light& disk);

/// Point k >= 0 of an area light as p sees it, world space: an additive recurrence that fills the light evenly, of a
/// sphere the disk that p sees (its centre where p lies inside). The same for every p, except for spheres.
/// [Martin Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018]
[[nodiscard]] dvec3 light_point(const Light& light, dvec3 p, int k);

}  // namespace umbra
