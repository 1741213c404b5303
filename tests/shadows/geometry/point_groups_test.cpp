#include "umbra/shadows/geometry/point_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace umbra {
namespace {

PointBatch batch(int width, int height, bool raster) {
    PointBatch points;
    points.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    if (raster) {
        points.raster.emplace();
        points.raster->width = width, points.raster->height = height;
    }
    return points;
}

TEST(Groups, HoldEachPointOnce) {
    for (const bool raster : {true, false})
        for (const auto& [width, height] : {std::pair{1, 1}, {70, 3}, {200, 131}, {64, 64}, {0, 0}}) {
            const PointBatch points = batch(width, height, raster);
            const auto groups       = grouped(points, 3, [](std::size_t i) { return i % 5; });
            ASSERT_EQ(groups.size(), 3u);
            for (std::size_t g = 0; g < 3; ++g) {
                std::vector<std::uint32_t> sorted(groups[g].begin(), groups[g].end()), expected;
                for (std::uint32_t i = 0; i < points.size(); ++i)
                    if (i % 5 == g) expected.push_back(i);
                if (!raster) {
                    EXPECT_EQ(sorted, expected);
                }
                std::ranges::sort(sorted);
                EXPECT_EQ(sorted, expected) << width << " x " << height;
            }
        }
}

TEST(Groups, KeepNeighboursTogether) {
    const PointBatch points = batch(200, 131, true);
    const auto groups       = grouped(points, 1, [](std::size_t) { return std::size_t{0}; });
    const auto& all         = groups[0];
    // Each 16 that follow one another in a whole square are 4 x 4 pixels.
    for (std::size_t i = 0; i < 1024; i += 16) {
        std::uint32_t left = 200, right = 0, top = 131, bottom = 0;
        for (std::size_t k = i; k < i + 16; ++k) {
            left = std::min(left, all[k] % 200), right = std::max(right, all[k] % 200);
            top = std::min(top, all[k] / 200), bottom = std::max(bottom, all[k] / 200);
        }
        EXPECT_EQ(right - left, 3u);
        EXPECT_EQ(bottom - top, 3u);
    }
}

TEST(Groups, ComeInTheCurvesOrderWherePatchesHaveOneGroup) {
    // Patches larger and smaller than squares of 4 x 4 pixels, and some points that are in no group.
    for (const auto& [width, height] : {std::pair{200, 131}, {71, 35}, {6, 9}, {4, 4}})
        for (const std::uint32_t patch : {1u, 3u, 4u, 8u, 37u, 500u}) {
            const auto of = [&, pitch = static_cast<std::uint32_t>(width)](std::size_t i) -> std::size_t {
                const auto at = static_cast<std::uint32_t>(i);
                return (at % pitch / patch + 2 * (at / pitch / patch)) % 5;
            };
            const PointBatch points = batch(width, height, true);
            std::vector<std::uint32_t> order(points.size());
            std::iota(order.begin(), order.end(), 0u);
            std::ranges::sort(order, {}, [&, pitch = static_cast<std::uint32_t>(width)](std::uint32_t i) {
                return morton_code(i % pitch, i / pitch);
            });
            const auto groups = grouped(points, 3, of);
            for (std::size_t g = 0; g < 3; ++g) {
                std::vector<std::uint32_t> expected;
                std::ranges::copy_if(order, std::back_inserter(expected), [&](std::uint32_t i) { return of(i) == g; });
                EXPECT_TRUE(std::ranges::equal(groups[g], expected))
                    << width << " x " << height << ", patches of " << patch;
            }
        }
}

TEST(Groups, AreTheSameForAnyNumberOfThreads) {
    const PointBatch points = batch(300, 170, true);
    const auto of           = [](std::size_t i) { return i / 7 % 4; };
    const ThreadLimit one(1);
    const auto expected = grouped(points, 4, of);
    {
        const ThreadLimit three(3);
        EXPECT_EQ(grouped(points, 4, of), expected);
    }
}

}  // namespace
}  // namespace umbra
