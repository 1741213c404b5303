#include "umbra/shadows/maps/depth_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

using Triangles = std::vector<uvec3>;

/// Positions in samples: x right, y down, (0, 0) the map's top left corner; z is depth in [0, 1].
dmat4 clip_from_samples(int width, int height) {
    return glm::transpose(
        dmat4(dvec4(2.0 / width, 0, 0, -1), dvec4(0, 2.0 / height, 0, -1), dvec4(0, 0, -1, 1), dvec4(0, 0, 0, 1)));
}

DepthMap drawn(int size, const std::vector<vec3>& positions, const Triangles& triangles, Faces faces = Faces::all,
               DepthFormat format = DepthFormat::float32) {
    DepthMap map(size, size, format);
    const std::span<const uvec3> run(triangles);
    map.draw(clip_from_samples(size, size), positions, std::span(&run, 1), faces);
    return map;
}

/// How many of the triangles, drawn one by one, cover each sample.
std::vector<int> coverage(int size, const std::vector<vec3>& positions, const Triangles& triangles) {
    std::vector<int> count(static_cast<std::size_t>(size) * size);
    for (const uvec3& t : triangles) {
        const DepthMap map = drawn(size, positions, {t});
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) count[y * size + x] += !map.is_empty(x, y);
    }
    return count;
}

std::vector<std::uint32_t> all_bits(const DepthMap& map) {
    std::vector<std::uint32_t> bits;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) bits.push_back(map.word(x, y));
    return bits;
}

// ---- coverage ------------------------------------------------------------------------------------------------------

TEST(DepthMap, FanInsideConvexBorderCoversEverySampleOnce) {
    // A fan from a point within the map to its border: together the triangles are the map's square.
    std::mt19937 random(1);
    constexpr int size = 24;
    for (int round = 0; round < 200; ++round) {
        // Coordinates on the snapping grid's halves and quarters put many samples exactly on edges and corners.
        const int steps    = 1 << (round % 5);
        const auto on_grid = [&] {
            return static_cast<float>(std::uniform_int_distribution(0, size * steps)(random)) /
                       static_cast<float>(steps) +
                   (round % 2 ? 0.5f : 0.0f);
        };
        std::vector<vec3> positions{{on_grid(), on_grid(), 0.5f}};
        positions[0] = glm::min(positions[0], vec3(size, size, 1));
        for (vec3 corner : {vec3(0, 0, 0), vec3(size, 0, 0), vec3(size, size, 0), vec3(0, size, 0)}) {
            positions.push_back(corner);
            const vec3 next = corner.x == corner.y ? (corner.x == 0 ? vec3(size, 0, 0) : vec3(0, size, 0))
                                                   : (corner.x > 0 ? vec3(size, size, 0) : vec3(0, 0, 0));
            std::vector<float> cuts;
            for (int i = 0; i < 3; ++i) cuts.push_back(std::min(on_grid() / size, 1.0f));
            std::ranges::sort(cuts);
            for (float t : cuts) positions.push_back(corner + t * (next - corner));
        }
        Triangles fan;
        const auto n = static_cast<std::uint32_t>(positions.size());
        for (std::uint32_t i = 1; i < n; ++i) fan.emplace_back(0, i, i + 1 < n ? i + 1 : 1);
        const auto count = coverage(size, positions, fan);
        for (int i = 0; i < size * size; ++i) ASSERT_EQ(count[i], 1) << "round " << round << " sample " << i;
    }
}

TEST(DepthMap, RandomTriangulatedGridCoversEverySampleOnce) {
    // Jittered inner vertices, random diagonals and random windings; then the same with the borders far outside the
    // map, so that triangles are clipped.
    std::mt19937 random(2);
    constexpr int size  = 32;
    constexpr int cells = 6;
    for (const float scale : {1.0f, 40.0f, 4000.0f})
        for (int round = 0; round < 20; ++round) {
            std::uniform_real_distribution<float> jitter(-0.4f, 0.4f);
            std::vector<vec3> positions;
            for (int j = 0; j <= cells; ++j)
                for (int i = 0; i <= cells; ++i) {
                    const bool inner = i > 0 && j > 0 && i < cells && j < cells;
                    const vec2 at(static_cast<float>(i) + (inner ? jitter(random) : 0.0f),
                                  static_cast<float>(j) + (inner ? jitter(random) : 0.0f));
                    const vec2 centred = (at / static_cast<float>(cells) - 0.5f) * scale + 0.5f;
                    positions.emplace_back(centred * static_cast<float>(size), 0.5f);
                }
            Triangles grid;
            for (std::uint32_t j = 0; j < cells; ++j)
                for (std::uint32_t i = 0; i < cells; ++i) {
                    const std::uint32_t a = j * (cells + 1) + i;
                    const std::uint32_t b = a + 1;
                    const std::uint32_t c = b + cells + 1;
                    const std::uint32_t d = c - 1;
                    if (random() % 2) {
                        grid.insert(grid.end(), {{a, b, c}, {a, c, d}});
                    } else {
                        grid.insert(grid.end(), {{d, b, a}, {b, c, d}});
                    }
                }
            const auto count = coverage(size, positions, grid);
            for (int i = 0; i < size * size; ++i) ASSERT_EQ(count[i], 1) << "scale " << scale << " sample " << i;
        }
}

/// True where the triangle covers sample (x, y), by edge functions in whole numbers. Corners are on the grid of
/// snapping.
bool covers(const std::vector<vec3>& p, const uvec3& t, int x, int y) {
    const auto step = [&](std::uint32_t corner, int axis) {
        return std::llrint((p[corner][axis] - 0.5) * kSnapsPerSample);
    };
    const auto edge = [&](std::uint32_t a, std::uint32_t b, long long at_x, long long at_y) {
        return (step(b, 0) - step(a, 0)) * (at_y - step(a, 1)) - (step(b, 1) - step(a, 1)) * (at_x - step(a, 0));
    };
    const long long area = edge(t.x, t.y, step(t.z, 0), step(t.z, 1));
    const uvec3 c        = area > 0 ? t : uvec3(t.x, t.z, t.y);
    if (area == 0) return false;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = c[k], b = c[(k + 1) % 3];
        const long long e =
            edge(a, b, static_cast<long long>(x) * kSnapsPerSample, static_cast<long long>(y) * kSnapsPerSample);
        const bool top_left = step(b, 1) < step(a, 1) || (step(b, 1) == step(a, 1) && step(b, 0) > step(a, 0));
        if (e < 0 || (e == 0 && !top_left)) return false;
    }
    return true;
}

TEST(DepthMap, TrianglesOfAllSizesCoverWhatExactEdgesCover) {
    // Of at most as many samples across and down: those that are small are filled by other code than large ones. Many
    // reach over the map's border, large ones so far that only a few columns of them are seen. The map is as wide as it
    // is for those: what is more than a quarter of a map outside is clipped.
    constexpr int width = 1024, height = 64;
    std::mt19937 random(7);
    for (const auto& [across, down] : std::vector<std::pair<int, int>>{
             {1, 1}, {3, 3}, {8, 8}, {9, 9}, {8, 31}, {9, 33}, {2, 60}, {60, 2}, {8, 70}, {200, 30}, {900, 70}})
        for (int round = 0; round < 120; ++round) {
            // Up to nine triangles, one beside the other or alone, on whole and half samples in every third round.
            const int grid  = round % 3 == 0 ? 2 : 1024;
            const auto pick = [&](int low, int high) {
                const int steps = std::uniform_int_distribution(low * grid, high * grid)(random);
                return static_cast<float>(steps) / static_cast<float>(grid);
            };
            const auto place = [&](int extent, int samples) {
                const int beyond = samples / 4;
                if (extent > beyond || random() % 2 == 0) return pick(-beyond, samples + beyond - extent);
                return random() % 2 == 0 ? pick(-extent, 8 - extent) : pick(samples - 8, samples + beyond - extent);
            };
            std::vector<vec3> positions;
            Triangles triangles;
            for (int i = 0; i < 1 + round % 9; ++i) {
                const float x = place(across, width), y = place(down, height);
                for (int k = 0; k < 3; ++k) positions.emplace_back(x + pick(0, across), y + pick(0, down), 0.5f);
                triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
            }
            std::vector<bool> expected(static_cast<std::size_t>(width) * height);
            for (const uvec3& t : triangles) {
                const vec3 low  = glm::min(glm::min(positions[t.x], positions[t.y]), positions[t.z]);
                const vec3 high = glm::max(glm::max(positions[t.x], positions[t.y]), positions[t.z]);
                for (int y = std::max(0, static_cast<int>(low.y) - 1);
                     y < std::min(height, static_cast<int>(high.y) + 2); ++y)
                    for (int x = std::max(0, static_cast<int>(low.x) - 1);
                         x < std::min(width, static_cast<int>(high.x) + 2); ++x)
                        if (covers(positions, t, x, y)) expected[y * width + x] = true;
            }
            DepthMap map(width, height, DepthFormat::float32);
            const std::span<const uvec3> run(triangles);
            map.draw(clip_from_samples(width, height), positions, std::span(&run, 1), Faces::all);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    ASSERT_EQ(!map.is_empty(x, y), expected[y * width + x])
                        << across << " by " << down << ", round " << round << ", sample " << x << ' ' << y;
        }
}

TEST(DepthMap, DepthDoesNotDependOnTheSizeThatATriangleIsFilledBy) {
    // Two halves of one small square, beside a large triangle in the same plane: what both cover has one depth, to a
    // rounding, whichever code drew it.
    constexpr int size = 64;
    std::mt19937 random(8);
    std::uniform_real_distribution<float> anywhere(0, 56), slope(-0.006f, 0.006f);
    for (int round = 0; round < 200; ++round) {
        const float sx = slope(random), sy = slope(random);
        const auto at = [&](float x, float y) { return vec3(x, y, 0.5f + sx * (x - 32) + sy * (y - 32)); };
        const float x = anywhere(random), y = anywhere(random);
        const DepthMap large = drawn(size, {at(-60, -20), at(120, -20), at(30, 130)}, {{0, 1, 2}});
        const DepthMap small =
            drawn(size, {at(x, y), at(x + 7, y + 1), at(x + 6, y + 7), at(x - 1, y + 6)}, {{0, 1, 2}, {0, 2, 3}});
        int drawn_by_both = 0;
        for (int i = 0; i < size * size; ++i) {
            if (small.is_empty(i % size, i / size) || large.is_empty(i % size, i / size)) continue;
            ASSERT_NEAR(small.nearness(i % size, i / size), large.nearness(i % size, i / size), 2e-5);
            ++drawn_by_both;
        }
        ASSERT_GT(drawn_by_both, 10);
    }
}

TEST(DepthMap, SamplesOnTopAndLeftEdgesAreDrawnOnRightAndBottomOnesAreNot) {
    // Corners at sample positions: samples lie exactly on all four edges and on the diagonal.
    const DepthMap map =
        drawn(16, {{2.5f, 3.5f, 0}, {9.5f, 3.5f, 0}, {9.5f, 8.5f, 0}, {2.5f, 8.5f, 0}}, {{0, 1, 2}, {0, 2, 3}});
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            EXPECT_EQ(!map.is_empty(x, y), x >= 2 && x < 9 && y >= 3 && y < 8) << x << ' ' << y;
}

TEST(DepthMap, DegenerateTrianglesAndSlivers) {
    // Points, segments and exact lines through samples cover nothing.
    for (const auto& corners : std::vector<std::vector<vec3>>{{{4.5f, 4.5f, 0}, {4.5f, 4.5f, 0}, {4.5f, 4.5f, 0}},
                                                              {{0.5f, 4.5f, 0}, {9.5f, 4.5f, 0}, {5.5f, 4.5f, 0}},
                                                              {{1.5f, 1.5f, 0}, {7.5f, 7.5f, 0}, {3.5f, 3.5f, 0}}}) {
        const DepthMap map = drawn(16, corners, {{0, 1, 2}});
        for (int i = 0; i < 256; ++i) EXPECT_TRUE(map.is_empty(i % 16, i / 16));
    }
    // A sliver one step of the grid wide keeps its depths between those of its corners.
    const DepthMap map =
        drawn(64, {{0, 8.5f, 0.2f}, {64, 8.5f, 0.8f}, {0, 8.5f + 1.0f / kSnapsPerSample, 0.9f}}, {{0, 1, 2}});
    for (int x = 0; x < 64; ++x) {
        ASSERT_FALSE(map.is_empty(x, 8));
        EXPECT_NEAR(1 - map.nearness(x, 8), 0.2 + 0.6 * (x + 0.5) / 64, 1e-6);
        EXPECT_TRUE(map.is_empty(x, 7) && map.is_empty(x, 9));
    }
}

TEST(DepthMap, TrianglesFarLargerThanTheMap) {
    const DepthMap map = drawn(64, {{-1e9f, -1e9f, 0.25f}, {1e9f, -1e9f, 0.25f}, {0, 2e9f, 0.25f}}, {{0, 1, 2}});
    for (int i = 0; i < 64 * 64; ++i) ASSERT_NEAR(map.nearness(i % 64, i / 64), 0.75, 1e-6);
}

TEST(DepthMap, FacesBySideSeen) {
    // y runs down: these corners are clockwise as seen, a back face.
    const std::vector<vec3> positions{{0, 0, 0.5f}, {16, 0, 0.5f}, {0, 16, 0.5f}};
    EXPECT_FALSE(drawn(16, positions, {{0, 1, 2}}, Faces::back).is_empty(2, 2));
    EXPECT_TRUE(drawn(16, positions, {{0, 1, 2}}, Faces::front).is_empty(2, 2));
    EXPECT_FALSE(drawn(16, positions, {{0, 2, 1}}, Faces::front).is_empty(2, 2));
    EXPECT_TRUE(drawn(16, positions, {{0, 2, 1}}, Faces::back).is_empty(2, 2));
}

// ---- depth ---------------------------------------------------------------------------------------------------------

TEST(DepthMap, DepthIsThePlanesWithinTheFormatsRounding) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> coordinate(0, 32 * 16);
    std::uniform_real_distribution<float> depth(0, 1);
    for (const DepthFormat format :
         {DepthFormat::unorm16, DepthFormat::unorm24, DepthFormat::unorm32, DepthFormat::float32})
        for (int round = 0; round < 300; ++round) {
            // On the snapping grid, so that snapping moves nothing.
            std::vector<vec3> p;
            for (int k = 0; k < 3; ++k)
                p.emplace_back(static_cast<float>(coordinate(random)) / 16, static_cast<float>(coordinate(random)) / 16,
                               depth(random));
            const dvec3 a(p[0]), b(p[1]), c(p[2]);
            const dvec3 n = glm::cross(b - a, c - a);
            if (std::abs(n.z) < 1) continue;
            const DepthMap map = drawn(32, p, {{0, 1, 2}}, Faces::all, format);
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 32; ++x) {
                    if (map.is_empty(x, y)) continue;
                    const double z = a.z - (n.x * (x + 0.5 - a.x) + n.y * (y + 0.5 - a.y)) / n.z;
                    // Half a step of rounding, and double arithmetic on 1 - z.
                    ASSERT_LE(std::abs(map.nearness(x, y) - (1 - z)), 0.5000001 * map.quantum(1 - z) + 1e-14)
                        << "format " << static_cast<int>(format);
                }
        }
}

TEST(DepthMap, PerspectiveDepthIsHyperbolicAndClippedOnlyAtTheLight) {
    // A floor y = 1 below a light at the origin that looks along z: it starts behind the light and runs to z = 100.
    constexpr int size    = 128;
    constexpr double near = 0.5;
    constexpr double far  = 100;
    const dmat4 clip_from_world =
        glm::transpose(dmat4(dvec4(1, 0, 0, 0) / far, dvec4(0, 1, 0, 0) / far,
                             dvec4(0, 0, -near, near * far) / ((far - near) * far), dvec4(0, 0, 1, 0) / far));
    const std::vector<vec3> floor{{-300, 1, -50}, {300, 1, -50}, {300, 1, 100}, {-300, 1, 100}};
    const Triangles triangles{{0, 1, 2}, {0, 2, 3}};
    const std::span<const uvec3> run(triangles);
    DepthMap map(size, size, DepthFormat::float32);
    map.draw(clip_from_world, floor, std::span(&run, 1), Faces::all);
    for (int y = 0; y < size; ++y) {
        const double t = (2.0 * y + 1) / size - 1;  // y / z
        const double z = 1 / t;
        for (int x = 0; x < size; ++x) {
            ASSERT_EQ(map.is_empty(x, y), !(t > 0 && z < far)) << x << ' ' << y;
            if (map.is_empty(x, y)) continue;
            const double r = near * (far - z) / (z * (far - near));
            // Cut corners are snapped too: a step of the grid moves the plane.
            const double snapped = near * far / (far - near) * 2 / size / kSnapsPerSample;
            ASSERT_NEAR(map.nearness(x, y), std::min(r, 1.0), 2 * snapped + 1e-6) << x << ' ' << y;
        }
    }
    // Between light and near plane: drawn, as near as can be.
    const std::vector<vec3> close{{-1e-3f, -1e-3f, 1e-3f}, {1e-3f, -1e-3f, 1e-3f}, {0, 1e-3f, 1e-3f}};
    const Triangles one{{0, 1, 2}};
    const std::span<const uvec3> close_run(one);
    map.draw(clip_from_world, close, std::span(&close_run, 1), Faces::all);
    EXPECT_EQ(map.nearness(size / 2, size / 2), 1);
}

TEST(DepthMap, UnormRoundsToNearest) {
    for (const int k : {0, 1, 2, 32767, 65534, 65535})
        for (const double off : {-0.49, 0.0, 0.49}) {
            const double z = (k + off) / 65535;
            if (z < 0 || z > 1) continue;
            const auto depth = static_cast<float>(z);
            const DepthMap map =
                drawn(4, {{0, 0, depth}, {8, 0, depth}, {0, 8, depth}}, {{0, 1, 2}}, Faces::all, DepthFormat::unorm16);
            EXPECT_NEAR(map.nearness(1, 1), 1 - k / 65535.0, 1e-12) << k << ' ' << off;
        }
}

// ---- many ----------------------------------------------------------------------------------------------------------

struct Soup {
    std::vector<vec3> positions;
    Triangles triangles;
};
Soup random_soup(int count, float size) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> at(-0.2f * size, 1.2f * size);
    std::uniform_real_distribution<float> extent(-0.1f * size, 0.1f * size);
    std::uniform_real_distribution<float> depth(-0.1f, 1.1f);
    Soup soup;
    for (int i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(soup.positions.size());
        const vec2 centre(at(random), at(random));
        for (int k = 0; k < 3; ++k)
            soup.positions.emplace_back(centre + vec2(extent(random), extent(random)), depth(random));
        soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    return soup;
}

TEST(DepthMap, TheNearestOfAllWins) {
    const Soup soup    = random_soup(400, 100);
    const DepthMap all = drawn(100, soup.positions, soup.triangles);
    std::vector<double> nearest(100 * 100, 0);
    for (const uvec3& t : soup.triangles) {
        const DepthMap one = drawn(100, soup.positions, {t});
        for (int i = 0; i < 100 * 100; ++i) nearest[i] = std::max(nearest[i], one.nearness(i % 100, i / 100));
    }
    for (int i = 0; i < 100 * 100; ++i) ASSERT_EQ(all.nearness(i % 100, i / 100), nearest[i]);
}

TEST(DepthMap, SameBitsForAnyThreadsAndAnyOrder) {
    Soup soup = random_soup(150'000, 300);
    std::vector<std::uint32_t> expected;
    {
        const ThreadLimit one(1);
        expected = all_bits(drawn(300, soup.positions, soup.triangles));
    }
    {
        const ThreadLimit five(5);
        EXPECT_EQ(all_bits(drawn(300, soup.positions, soup.triangles)), expected);
    }
    std::ranges::reverse(soup.triangles);
    EXPECT_EQ(all_bits(drawn(300, soup.positions, soup.triangles)), expected);
}

}  // namespace
}  // namespace umbra
