// Surface points in small blocks, so that neighbouring rays meet the same triangles and find them in the cache.
#pragma once

#include <algorithm>
#include <cstddef>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/points.h"

namespace umbra {

/// A block of a batch's points: up to 16 x 8 pixels of a raster, or up to 128 consecutive points where there is none.
struct PointTile {
    static constexpr std::size_t kWidth = 16, kHeight = 8;
    static constexpr std::size_t kPoints = kWidth * kHeight;  ///< at most

    std::size_t x0 = 0, y0 = 0;         ///< first column and row; without a raster the points fill rows of kWidth
    std::size_t width = 0, height = 0;  ///< of the whole batch
    std::size_t points = 0;             ///< of the whole batch

    /// Calls body(first, count) for the points first .. first + count - 1, row by row in runs of up to eight.
    template <class Body>
    void for_each_run(const Body& body) const {
        for (std::size_t y = y0; y < std::min(y0 + kHeight, height); ++y)
            for (std::size_t x = x0; x < std::min(x0 + kWidth, width); x += 8) {
                const std::size_t first = y * width + x;
                if (first < points) body(first, std::min({std::size_t{8}, width - x, points - first}));
            }
    }

    /// Has the processor load the tile's part of these arrays of the batch: where it is read or written later, it need
    /// not be waited for. A row of a tile is one or two lines of the cache, and the memory behind it belongs to another
    /// tile. Changes no result.
    template <class... Array>
    void load(const Array&... arrays) const {
        for_each_row([&](std::size_t first, std::size_t last) {
            (__builtin_prefetch(arrays.data() + first), ...);
            (__builtin_prefetch(arrays.data() + last), ...);
            keep_call();
        });
    }

    /// The same for memory that is written: it then belongs to this processor alone.
    template <class... Array>
    void load_for_writing(Array&... arrays) const {
        for_each_row([&](std::size_t first, std::size_t last) {
            (__builtin_prefetch(arrays.data() + first, 1), ...);
            (__builtin_prefetch(arrays.data() + last, 1), ...);
            keep_call();
        });
    }

    /// Loads the memory that the tile to the right needs, while this one is worked on.
    template <class... Array>
    void load_next(const Array&... arrays) const {
        PointTile next = *this;
        next.x0 += kWidth;
        next.load(arrays...);
    }

private:
    /// g++ drops calls of functions that only prefetch, as if they did nothing.
    static void keep_call() { asm volatile(""); }

    /// Calls body(first, last) for the first and the last point of each row.
    template <class Body>
    void for_each_row(const Body& body) const {
        if (x0 >= width) return;
        for (std::size_t y = y0; y < std::min(y0 + kHeight, height); ++y)
            if (const std::size_t first = y * width + x0; first < points)
                body(first, std::min({first + kWidth, (y + 1) * width, points}) - 1);
    }
};

/// Calls body(tile) for tiles that hold each point of the batch once, from many threads. A thread takes about `grain`
/// tiles at a time.
template <class Body>
void for_each_tile(const PointBatch& points, const Body& body, std::size_t grain = 8) {
    const bool raster        = points.raster.has_value();
    const std::size_t n      = points.size();
    const std::size_t width  = raster ? points.raster->width : PointTile::kWidth;
    const std::size_t height = raster ? points.raster->height : (n + PointTile::kWidth - 1) / PointTile::kWidth;
    const std::size_t across = (width + PointTile::kWidth - 1) / PointTile::kWidth;
    const std::size_t down   = (height + PointTile::kHeight - 1) / PointTile::kHeight;
    parallel_ranges(across * down, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            body(PointTile{t % across * PointTile::kWidth, t / across * PointTile::kHeight, width, height, n});
    });
}

}  // namespace umbra
