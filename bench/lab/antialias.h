// Antialiased pictures: the sum at several points of each pixel, averaged in linear light.
//
// S_j planes, errors and image metrics stay at pixel centres; only what people look at is smoothed.
#pragma once

#include <vector>

#include "umbra/core/image/image.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// What commands take for pictures where nobody says otherwise.
inline constexpr int kPictureSamples = 4;

/// Samples along each side of a pixel for `samples` samples a pixel: 1, 4, 9, 16, 25 ... . Throws UsageError for other
/// numbers and for more than 64.
[[nodiscard]] int samples_along_side(int samples);

/// The surface points at `side` x `side` regular subpixel centres of each pixel: a raster of `side` times the size.
/// Throws UsageError where that is more than 2^26 points.
[[nodiscard]] PointBatch subpixel_points(const RayScene& rays, const Scene& scene, int width, int height, int side);

/// The mean of each `side` x `side` pixels: a picture of 1 / side of the size. Both sizes are multiples of `side`.
[[nodiscard]] Image box_filtered(const Image& fine, int side);

/// S_j at subpixels from S_j at pixel centres, for methods that take long: bilinear where the eight pixels around a
/// subpixel's own show the same object as this, have answers, face the light as this does, and S_j bends by at most
/// 1/32 from one to the next. `ask` is filled with the other subpixels of which S_j is asked: they need answers of
/// their own. Both batches are rasters, faced to the light.
[[nodiscard]] VisibilityPlane between_centres(const Scene& scene, const PointBatch& centres,
                                              const VisibilityPlane& at_centres, const PointBatch& subpixels, int side,
                                              LightId light, std::vector<std::uint32_t>& ask);

}  // namespace umbra
