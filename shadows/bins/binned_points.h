// The points of a batch that ask a light, in bins of its image.
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/bins/point_bins.h"

namespace umbra::bins {

struct BinnedPoints {
    PointBins bins{};
    std::vector<std::uint32_t> next_to_light{};  ///< points without a place in the image
    dvec3 reach{0};                              ///< the largest magnitude of each coordinate, less the centre
    bool sorted = false;                         ///< all of them, not those of each tile alone
};

/// Tiles of a raster are binned as they are, unless they overlap in the light's image as leaves of a tree do; then, and
/// without a raster, points are sorted first. `centre`: what positions in bins are less.
[[nodiscard]] BinnedPoints bin_points(const Scene& scene, const PointBatch& points, LightId light,
                                      const LightImage& image, dvec3 centre);

}  // namespace umbra::bins
