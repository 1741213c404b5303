#include "umbra/core/render/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace umbra {
namespace {

/// How often each point comes, and the most points of any tile.
std::vector<int> visits(const PointBatch& points, std::size_t& most) {
    std::vector<std::atomic<int>> count(points.size());
    std::atomic<std::size_t> largest = 0;
    for_each_tile(points, [&](const PointTile& tile) {
        std::size_t in_tile = 0;
        tile.for_each_run([&](std::size_t first, std::size_t n) {
            EXPECT_GE(n, 1u);
            EXPECT_LE(n, 8u);
            for (std::size_t i = first; i < first + n; ++i) ++count.at(i);
            in_tile += n;
        });
        for (std::size_t seen = largest; in_tile > seen && !largest.compare_exchange_weak(seen, in_tile);) {
        }
    });
    most = largest;
    return {count.begin(), count.end()};
}

TEST(PointTiles, HoldEachPointOnce) {
    for (const std::size_t n : {1, 7, 16, 127, 128, 129, 1000}) {
        PointBatch points;
        points.resize(n);
        std::size_t most = 0;
        EXPECT_EQ(visits(points, most), std::vector<int>(n, 1)) << n << " points without a raster";
        EXPECT_EQ(most, std::min(n, PointTile::kPoints));
    }
    for (const auto& [width, height] : {std::pair{1, 1}, {16, 8}, {17, 9}, {161, 99}, {3, 200}}) {
        PointBatch points;
        points.raster = frame(Camera{}, width, height);
        points.resize(static_cast<std::size_t>(width * height));
        std::size_t most = 0;
        EXPECT_EQ(visits(points, most), std::vector<int>(points.size(), 1)) << width << " x " << height;
        EXPECT_LE(most, PointTile::kPoints);
    }
    std::size_t most = 0;
    EXPECT_TRUE(visits({}, most).empty());
}

}  // namespace
}  // namespace umbra
