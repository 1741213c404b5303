// Phong's shading for less: the angles of the sum at a pixel from those at few other places. The sum, its attenuation
// and S_j stay those of each pixel.
//
// This work is based on:
// Tom Duff. Smoothly Shaded Renderings of Polyhedral Objects on Raster Displays. 1979
// Gary Bishop, David Weimer. Fast Phong Shading. 1986
// Larry Bergman, Henry Fuchs, Eric Grant, Susan Spach. Image Rendering by Adaptive Refinement. 1986
// Kelvin Harrison, Don Mitchell, Alan Watt. The H-Test, a Method of High Speed Interpolative Shading. 1988
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/sum.h"

namespace umbra {

/// One side of one triangle.
using SideKey = std::pair<TriangleId, std::uint8_t>;
/// The one that a pixel with a surface shows.
[[nodiscard]] inline SideKey side_of(const PointBatch& points, std::size_t i) {
    return {points.triangle[i], points.flipped[i]};
}

/// The angles of every light at every pixel with a surface, and what they took.
struct PictureCosines {
    std::vector<std::vector<LightCosines>> at;  ///< [light][pixel]
    std::size_t evaluations = 0;                ///< places where directions to lights and eye were found
};

/// Duff: directions to lights and eye are those at the middle of the triangle; along a run of pixels of one triangle
/// N.L, N.H and N.V are linear and N.N is quadratic, so that a pixel costs a few additions, a root and a division.
/// Exact for suns and a viewer at infinity. `points` is a raster, faced to all lights.
[[nodiscard]] PictureCosines cosines_by_differences(const Scene& scene, const PointBatch& points);

/// Bishop and Weimer: N.L and R.V or N.H as polynomials of second degree over a triangle, which have the value and the
/// first two derivatives that are true at its middle.
[[nodiscard]] PictureCosines cosines_by_taylor(const Scene& scene, const PointBatch& points);

/// The H-test: N.L is interpolated between the corners of a triangle, and the highlight is computed where one may be.
/// None is where the specular term stays below `least` (of a channel, with I_j = 1) over the whole triangle: the angle
/// between R and V there is at least that at its middle less what L, V and twice N differ from theirs at the corners.
[[nodiscard]] PictureCosines cosines_by_highlight_test(const Scene& scene, const PointBatch& points,
                                                       double least = 1.0 / 255);

}  // namespace umbra
