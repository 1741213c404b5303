// Points at which slow references are evaluated.
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/render/points.h"

namespace umbra {

/// Indices of pixels with a surface: one, at random but always the same, out of each square tile that has any; about
/// `wanted` of them where all have. `wanted` > 0; the batch has a raster.
[[nodiscard]] std::vector<std::uint32_t> stratified_sample(const PointBatch& points, std::uint64_t wanted);

}  // namespace umbra
