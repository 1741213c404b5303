// The plane of an area light, as one surface point sees the light. A rectangle and a disk lie in a plane of their own;
// of a sphere a point sees the disk whose rim is where the cone of its tangents touches the sphere.
#pragma once

#include "umbra/core/render/light_points.h"
#include "umbra/core/scene/lights.h"
#include "umbra/shadows/geometry/exact_point.h"

namespace umbra::exact_visibility {

/// Half axes of a rectangle, perpendicular radii of a disk; of a sphere nothing, since its disk differs from point to
/// point.
[[nodiscard]] DiskAxes half_axes(const Light& light);

/// By how much each component of them may be off from the light's plane, and from their length.
[[nodiscard]] double axis_error(const Light& light);

/// Half axes and centre in rationals: of a disk, whose axes in double leave its plane by a rounding, in the plane
/// itself. From a point in that plane, or next to it, no rounding of the plane is small.
struct ExactAxes {
    Rational3 u, v, centre;
};
[[nodiscard]] ExactAxes exact_axes(const Light& light, const DiskAxes& half);

/// Centre and half axes. For a sphere they are rounded to double once.
struct LightPlane {
    dvec3 u{1, 0, 0}, v{0, 0, 1};
    const ExactAxes* exact_axes = nullptr;  ///< null: u and v are exact, and so is corner + centre_from_corner
    double axis_error           = 0;        ///< of each component of u and v
    Entries centre_from_corner{};           ///< centre less the first corner of the point's triangle
    double rounding = 0;                    ///< how far the light's rim may lie from where it is meant to be, in units
                                            ///< of the half axes
    double depth_error = 0;  ///< how far the plane may lie from there along its normal, in units of length
};

/// The plane in rationals, as `p` sees it.
[[nodiscard]] inline ExactAxes in_rationals(const LightPlane& plane, const ExactPoint& p) {
    if (plane.exact_axes != nullptr) return *plane.exact_axes;
    return {rational(plane.u), rational(plane.v), rational(p.corner()) + rational(plane.centre_from_corner.value)};
}

/// The plane of a rectangle or a disk with these half axes; `exact` must outlive it.
[[nodiscard]] LightPlane flat_light_plane(const Light& light, const DiskAxes& half, const ExactAxes& exact,
                                          const ExactPoint& p);

/// The plane of a sphere. Nothing where p is surely within it; infinite `rounding` where rounding hides whether it is.
[[nodiscard]] std::optional<LightPlane> sphere_light_plane(const Light& sphere, const ExactPoint& p);

}  // namespace umbra::exact_visibility
