// The triangle of mixes: which method is fastest where, exactly, since the time of a mix is linear in its shares.
#pragma once

#include <cstddef>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// Shares of the frames in which the camera alone, a light, an object moves; they add up to 1.
using Shares = dvec3;
/// Mean milliseconds of a frame of each of the three movements.
using CornerTimes = dvec3;

/// A convex polygon of mixes in which no other method is faster, and its share of the triangle's area.
struct MixRegion {
    std::size_t method = 0;  ///< index into what was given
    std::vector<Shares> corners;
    double area = 0;  ///< (0, 1]
};

/// One region for each method that is fastest somewhere. Of methods with equal times the first has the region.
[[nodiscard]] std::vector<MixRegion> mix_regions(const std::vector<CornerTimes>& methods);

}  // namespace umbra
