// The points of a batch, group by group, so that neighbours in the picture stay together.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/points.h"

namespace umbra::planar {

/// Where the pixels of a square of 64 x 64 lie, in the order of the Morton curve.
struct MortonPixel {
    std::uint8_t x = 0, y = 0;
};
inline constexpr auto kMortonPixels = [] {
    std::array<MortonPixel, 4096> pixels;
    for (std::uint8_t y = 0; y < 64; ++y)
        for (std::uint8_t x = 0; x < 64; ++x) pixels[morton_code(x, y)] = {x, y};
    return pixels;
}();

/// Indices of the points i with group_of(i) < groups, by group. With a raster those of 64 x 64 pixels follow one
/// another, in the order of the Morton curve; without one they stand in their own order. `group_of` is called from many
/// threads, twice for each point. Parallel; the same for any number of threads.
template <class GroupOf>
std::vector<std::vector<std::uint32_t>> grouped(const PointBatch& points, std::size_t groups, const GroupOf& group_of) {
    constexpr std::size_t side = 64, block = kMortonPixels.size();
    const bool raster        = points.raster.has_value();
    const std::size_t width  = raster ? static_cast<std::size_t>(points.raster->width) : block;
    const std::size_t height = (points.size() + width - 1) / std::max<std::size_t>(width, 1);
    const std::size_t across = raster ? (width + side - 1) / side : 1;
    const std::size_t blocks = raster ? across * ((height + side - 1) / side) : height;
    const auto for_each_in   = [&](std::size_t b, const auto& body) {
        if (!raster) {
            for (std::size_t i = b * block; i < std::min((b + 1) * block, points.size()); ++i) body(i);
            return;
        }
        const std::size_t x0 = b % across * side, y0 = b / across * side;
        for (const MortonPixel& at : kMortonPixels) {
            const std::size_t x = x0 + at.x, y = y0 + at.y;
            if (x < width && y < height) body(y * width + x);
        }
    };
    // How many of each group there are before each block, so that all blocks can be written at once.
    std::vector<std::uint32_t> begin(blocks * groups, 0);
    parallel_ranges(blocks, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b)
            for_each_in(b, [&](std::size_t i) {
                if (const std::size_t g = group_of(i); g < groups) ++begin[b * groups + g];
            });
    });
    std::vector<std::vector<std::uint32_t>> members(groups);
    for (std::size_t g = 0; g < groups; ++g) {
        std::uint32_t all = 0;
        for (std::size_t b = 0; b < blocks; ++b) {
            const std::uint32_t here = begin[b * groups + g];
            begin[b * groups + g]    = all;
            all += here;
        }
        members[g].resize(all);
    }
    parallel_ranges(blocks, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b)
            for_each_in(b, [&](std::size_t i) {
                if (const std::size_t g = group_of(i); g < groups)
                    members[g][begin[b * groups + g]++] = static_cast<std::uint32_t>(i);
            });
    });
    return members;
}

}  // namespace umbra::planar
