#include "umbra/core/base/geometry.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/random_bits.h"

namespace umbra {
namespace {

TEST(Geometry, AxesAcrossADirectionAreOrthonormalAndRightHanded) {
    for (const dvec3 d : {dvec3(1, 0, 0), dvec3(0, -1, 0), dvec3(0, 0, 1), dvec3(0.6, 0.8, 0), dvec3(-3, 1, 2)}) {
        const dvec3 n     = glm::normalize(d);
        const Axes across = axes_across(n);
        EXPECT_NEAR(glm::length(across.u), 1, 1e-15);
        EXPECT_NEAR(glm::dot(across.u, n), 0, 1e-15);
        EXPECT_NEAR(glm::length(glm::cross(across.u, across.v) - n), 0, 1e-15);
    }
}

TEST(Geometry, DistanceToATriangle) {
    const dvec3 a(0, 0, 0), b(4, 0, 0), c(0, 3, 0);
    EXPECT_DOUBLE_EQ(distance_to_triangle({1, 1, -2}, a, b, c), 2) << "over its inside";
    EXPECT_DOUBLE_EQ(distance_to_triangle({2, -3, 4}, a, b, c), 5) << "nearest to an edge";
    EXPECT_DOUBLE_EQ(distance_to_triangle({4, 3, 0}, a, b, c), 2.4) << "nearest to the slanted edge";
    EXPECT_DOUBLE_EQ(distance_to_triangle({7, -4, 12}, a, b, c), 13) << "nearest to a corner";
    EXPECT_DOUBLE_EQ(distance_to_triangle({2, 3, 4}, a, b, 0.5 * (a + b)), 5) << "a triangle that is a segment";
    EXPECT_DOUBLE_EQ(distance_to_segment({3, 4, 0}, a, a), 5) << "a segment that is a point";
}

/// The first 16 cells are the quarters of a square of 4 x 4, each in the order of its own quarters.
TEST(Morton, FollowsTheCurve) {
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> cells{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0}, {3, 0},
                                                                     {2, 1}, {3, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3},
                                                                     {2, 2}, {3, 2}, {2, 3}, {3, 3}};
    for (std::size_t k = 0; k < cells.size(); ++k) EXPECT_EQ(morton_code(cells[k].first, cells[k].second), k);
    EXPECT_EQ(morton_code(0xffffffffu, 0), 0x5555555555555555u);
    EXPECT_EQ(morton_code(0, 0x80000000u), 0x8000000000000000u);
    EXPECT_EQ(morton_code(0xffffu, 0xffffu), 0xffffffffu);
}

TEST(Morton, FollowsTheCurveThroughACube) {
    for (std::uint32_t k = 0; k < 4096; ++k) {
        uvec3 cell(0);
        for (unsigned bit = 0; bit < 12; ++bit) cell[static_cast<int>(bit % 3)] |= (k >> bit & 1u) << (bit / 3);
        EXPECT_EQ(morton_code(cell.x, cell.y, cell.z), k);
    }
    EXPECT_EQ(morton_code(0xffffu, 0, 0), 0x249249249249u);
    EXPECT_EQ(morton_code(0, 0xffffu, 0), 0x492492492492u);
    EXPECT_EQ(morton_code(0, 0, 0xffffu), 0x924924924924u);
}

/// The first numbers that SplitMix64 gives for the seed 0, as published with it.
TEST(RandomBits, AreThoseOfSplitMix64) {
    EXPECT_EQ(mixed_bits(0), 0xe220a8397b1dcdafu);
    EXPECT_EQ(mixed_bits(0x9e3779b97f4a7c15u), 0x6e789e6aa1b965f4u);
    EXPECT_EQ(mixed_bits(2 * 0x9e3779b97f4a7c15u), 0x06c45d188009454fu);
}

}  // namespace
}  // namespace umbra
