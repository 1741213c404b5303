// The points of a batch, group by group, so that neighbours in the picture stay together.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <vector>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/raw_vector.h"
#include "umbra/core/render/points.h"

namespace umbra {

namespace point_groups_detail {

inline constexpr std::size_t kSquare   = 32;  ///< pixels: what is read of so few stays in the cache
inline constexpr auto& kPixels         = kMortonSquare<kSquare>;
inline constexpr std::size_t kTogether = 16;

/// Whether four numbers in each of four rows, `pitch` apart, are all the same.
inline bool are_alike(const std::uint16_t* first, std::size_t pitch) {
    const std::uint64_t expected = *first * std::uint64_t{0x0001000100010001};
    std::uint64_t differing      = 0;
    for (std::size_t row = 0; row < 4; ++row) {
        std::uint64_t four = 0;
        std::memcpy(&four, first + row * pitch, sizeof four);
        differing |= four ^ expected;
    }
    return differing == 0;
}

}  // namespace point_groups_detail

/// Indices of the points i with group_of(i) < groups, by group; there may be 65534 groups. With a raster they are in
/// the order of the Morton curve; without one they stand in their own order. `group_of` is called from many threads,
/// once for each point. Parallel; the same for any number of threads.
template <class GroupOf>
std::vector<RawVector<std::uint32_t>> grouped(const PointBatch& points, std::size_t groups, const GroupOf& group_of) {
    using point_groups_detail::kPixels, point_groups_detail::kSquare, point_groups_detail::kTogether,
        point_groups_detail::are_alike;
    constexpr std::size_t block  = kPixels.size();
    constexpr std::uint16_t none = 0xffff;
    const bool raster            = points.raster.has_value();
    const std::size_t width      = raster ? std::max<std::size_t>(points.raster->width, 1) : block;
    const std::size_t height     = (points.size() + width - 1) / width;
    const std::size_t across     = raster ? (width + kSquare - 1) / kSquare : 1;
    const std::size_t blocks     = raster ? across * ((height + kSquare - 1) / kSquare) : height;

    // The group of each point, and how many of each there are in each square. Read row by row, in the order of
    // memory: a task has a row of squares.
    RawVector<std::uint16_t> group(points.size());
    std::vector<std::uint32_t> begin(blocks * groups, 0);
    const std::size_t high = raster ? kSquare : 1, wide = raster ? kSquare : block;  // of a square
    parallel_ranges(blocks / across, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first * high; y < std::min(last * high, height); ++y)
            for (std::size_t x = 0; x < across; ++x) {
                std::uint32_t* const count = begin.data() + (y / high * across + x) * groups;
                const std::size_t end      = std::min({y * width + (x + 1) * wide, (y + 1) * width, points.size()});
                // Neighbours are mostly of one group, and are counted together.
                std::size_t one = groups, run = 0;
                for (std::size_t i = y * width + x * wide; i < end; ++i) {
                    const std::size_t g = group_of(i);
                    group[i]            = g < groups ? static_cast<std::uint16_t>(g) : none;
                    if (g != one) {
                        if (one < groups) count[one] += static_cast<std::uint32_t>(run);
                        one = g, run = 0;
                    }
                    ++run;
                }
                if (one < groups) count[one] += static_cast<std::uint32_t>(run);
            }
    });
    std::vector<std::uint32_t> curve(blocks);  // squares
    std::iota(curve.begin(), curve.end(), 0u);
    if (raster)
        std::ranges::sort(curve, {}, [&](std::uint32_t b) {
            return morton_code(static_cast<std::uint32_t>(b % across), static_cast<std::uint32_t>(b / across));
        });
    std::vector<RawVector<std::uint32_t>> members(groups);
    for (std::size_t g = 0; g < groups; ++g) {
        std::uint32_t all = 0;
        for (const std::uint32_t b : curve) {
            const std::uint32_t here = begin[b * groups + g];
            begin[b * groups + g]    = all;
            all += here;
        }
        members[g].resize(all);
    }
    // Sixteen pixels of a square of 4 x 4, which the curve visits one after the other, go together if they are of one
    // group.
    std::array<std::uint32_t, kTogether> steps{};
    for (std::size_t k = 0; k < kTogether; ++k)
        steps[k] = static_cast<std::uint32_t>(raster ? kPixels[k].y * width + kPixels[k].x : k);
    parallel_ranges(blocks, 8, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b) {
            const std::size_t x0 = b % across * kSquare, y0 = b / across * kSquare;
            std::uint32_t* const next = begin.data() + b * groups;
            const auto put            = [&](std::size_t k) {
                const std::size_t x = x0 + kPixels[k].x, y = y0 + kPixels[k].y;
                const std::size_t i = raster ? y * width + x : b * block + k;
                if (raster ? x >= width || y >= height : i >= points.size()) return;
                if (const std::uint16_t g = group[i]; g != none) members[g][next[g]++] = static_cast<std::uint32_t>(i);
            };
            for (std::size_t k = 0; k < block; k += kTogether) {
                const std::size_t x = x0 + kPixels[k].x, y = y0 + kPixels[k].y;
                const std::size_t i = raster ? y * width + x : b * block + k;
                const bool whole    = raster ? x + 4 <= width && (y + 3) * width + x + 4 <= points.size()
                                             : i + kTogether <= points.size();
                if (!whole || !are_alike(&group[i], raster ? width : 4)) {
                    for (std::size_t j = 0; j < kTogether; ++j) put(k + j);
                    continue;
                }
                const std::uint16_t g = group[i];
                if (g == none) continue;
                std::uint32_t* const to = members[g].data() + next[g];
                for (std::size_t j = 0; j < kTogether; ++j) to[j] = static_cast<std::uint32_t>(i) + steps[j];
                next[g] += kTogether;
            }
        }
    });
    return members;
}

}  // namespace umbra
