// How far surface points are off the pixels that saw them.
#pragma once

#include <cstddef>

#include "umbra/core/render/points.h"

namespace umbra {

/// Points of a raster batch that are not where their pixels are. A point's barycentrics are floats, so that it may lie
/// 2^-24 of its triangle off the place that the eye ray met, and on a triangle of a million pixels that shows.
struct OffPixel {
    std::size_t points = 0;  ///< whose projection is more than half a pixel, along either axis, off the pixel's centre
    double worst       = 0;  ///< of all points, pixels
};
[[nodiscard]] OffPixel off_pixel(const Scene& scene, const PointBatch& points);

}  // namespace umbra
