#include "umbra/core/render/sampling.h"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <set>
#include <stdexcept>

namespace umbra {
namespace {

std::vector<vec2> samples_of(const SampleSet& set, std::uint64_t point) {
    std::vector<vec2> all;
    Samples8 eight;
    for (int first = 0; first < set.count(); first += 8) {
        set.eight(set.key(point), first, eight);
        for (int k = 0; k < std::min(8, set.count() - first); ++k) all.emplace_back(eight.x[k], eight.y[k]);
    }
    return all;
}

constexpr Sampler kAll[] = {Sampler::random, Sampler::stratified, Sampler::regular, Sampler::r2, Sampler::sobol};
std::string name_of(Sampler sampler) {
    std::string_view rest = kSamplers;
    for (int k = 0; k < static_cast<int>(sampler); ++k) rest = rest.substr(rest.find('|') + 1);
    return std::string(rest.substr(0, rest.find('|')));
}

class EverySampler : public testing::TestWithParam<Sampler> {};
INSTANTIATE_TEST_SUITE_P(All, EverySampler, testing::ValuesIn(kAll), [](const auto& p) { return name_of(p.param); });

/// Chi-square over 16 x 16 boxes, all points' samples together: 255 degrees of freedom. Well spread samples fall below
/// the mean of 255, none may lie far above it (7 standard deviations of 22.6).
TEST_P(EverySampler, CoversTheSquareEvenly) {
    for (int count : {1, 5, 16, 64, 100}) {
        const SampleSet set(GetParam(), count, 1);
        std::vector<double> boxes(256);
        const int points = 40000 / count;
        for (int p = 0; p < points; ++p)
            for (vec2 s : samples_of(set, p)) {
                ASSERT_TRUE(s.x >= 0 && s.x < 1 && s.y >= 0 && s.y < 1);
                ++boxes[static_cast<int>(s.x * 16) + 16 * static_cast<int>(s.y * 16)];
            }
        const double expected = points * count / 256.0;
        double chi2           = 0;
        for (double n : boxes) chi2 += (n - expected) * (n - expected) / expected;
        EXPECT_LT(chi2, 255 + 7 * 22.6) << count;
    }
}

TEST_P(EverySampler, DependsOnSeedPointAndSampleOnly) {
    const SampleSet a(GetParam(), 24, 5), same(GetParam(), 24, 5), other(GetParam(), 24, 6);
    EXPECT_EQ(samples_of(a, 1000000007ull), samples_of(same, 1000000007ull));
    EXPECT_NE(samples_of(a, 3), samples_of(other, 3));
    EXPECT_NE(samples_of(a, 3), samples_of(a, 4));
    EXPECT_NE(samples_of(a, 3), samples_of(a, 3 + (1ull << 32)));
}

/// The samples of neighbouring points must not be alike, or errors become patterns.
TEST_P(EverySampler, NeighbouringPointsAreIndependent) {
    const SampleSet set(GetParam(), 8, 0);
    const int n = 20000;
    double sum = 0, squares = 0;
    for (int p = 0; p < n; ++p) {
        const double a = samples_of(set, p)[0].x - 0.5, b = samples_of(set, p + 1)[0].x - 0.5;
        sum += a * b;
        squares += a * a;
    }
    // For shifted grids a point's first samples stay in the first cell; correlation is about the mean then.
    double mean = 0;
    for (int p = 0; p < n; ++p) mean += (samples_of(set, p)[0].x - 0.5) / n;
    EXPECT_LT(std::abs((sum / n - mean * mean) / (squares / n - mean * mean)), 5 / std::sqrt(n));
}

TEST(Stratified, OneSampleInEachCellOfEqualArea) {
    for (int side : {2, 4, 7}) {
        const SampleSet set(Sampler::stratified, side * side, 9);
        std::set<std::pair<int, int>> cells;
        for (vec2 s : samples_of(set, 77))
            cells.emplace(static_cast<int>(s.x * static_cast<float>(side)),
                          static_cast<int>(s.y * static_cast<float>(side)));
        EXPECT_EQ(cells.size(), static_cast<std::size_t>(side * side));
    }
}

/// A (0, m, 2)-net: of 2^m samples one lies in every box of area 2^-m, whatever its shape. Scrambling keeps that.
TEST(Sobol, IsANetForEveryPoint) {
    const int m = 6, count = 1 << m;
    const SampleSet set(Sampler::sobol, count, 21);
    for (std::uint64_t point : {0u, 1u, 12345u}) {
        const std::vector<vec2> samples = samples_of(set, point);
        for (int a = 0; a <= m; ++a) {
            std::set<std::pair<int, int>> boxes;
            for (vec2 s : samples)
                boxes.emplace(static_cast<int>(std::ldexp(s.x, a)), static_cast<int>(std::ldexp(s.y, m - a)));
            EXPECT_EQ(boxes.size(), static_cast<std::size_t>(count)) << "boxes " << a << ", point " << point;
        }
    }
}

// ---- how variance falls with the number of samples ----------------------------------------------------------------

double variance(Sampler sampler, int count, const std::function<double(vec2)>& f) {
    const SampleSet set(sampler, count, 1);
    const int points = 600;
    double sum = 0, squares = 0;
    for (int p = 0; p < points; ++p) {
        double mean = 0;
        for (vec2 s : samples_of(set, p)) mean += f(s) / count;
        sum += mean / points;
        squares += mean * mean / points;
    }
    return squares - sum * sum;
}

/// Least squares through log variance over log N.
double slope(Sampler sampler, const std::function<double(vec2)>& f) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int count : {16, 64, 256, 1024, 4096}) {
        const double a = std::log2(count), b = std::log2(variance(sampler, count, f));
        n += 1, x += a, y += b, xx += a * a, xy += a * b;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

double slanted_edge(vec2 s) { return s.y > 0.21 + 0.63 * static_cast<double>(s.x) ? 1 : 0; }
double straight_edge(vec2 s) { return s.x > 0.3717f ? 1 : 0; }
double smooth(vec2 s) { return std::exp(static_cast<double>(s.x)) * std::cos(1.3 * static_cast<double>(s.y)); }

TEST(Variance, RandomFallsWithN) {
    EXPECT_NEAR(slope(Sampler::random, slanted_edge), -1, 0.1);
    EXPECT_NEAR(slope(Sampler::random, smooth), -1, 0.1);
}
TEST(Variance, StratifiedFallsFaster) {
    EXPECT_NEAR(slope(Sampler::stratified, slanted_edge), -1.5, 0.1);
    EXPECT_NEAR(slope(Sampler::stratified, smooth), -2, 0.1);
}
TEST(Variance, SobolFallsFastest) {
    EXPECT_NEAR(slope(Sampler::sobol, slanted_edge), -1.5, 0.1);
    EXPECT_NEAR(slope(Sampler::sobol, straight_edge), -1.9, 0.2);
    EXPECT_NEAR(slope(Sampler::sobol, smooth), -2.9, 0.2);
}
TEST(Variance, RegularGridsShowTheirEdges) { EXPECT_NEAR(slope(Sampler::regular, straight_edge), -1, 0.15); }

// ---- maps ----------------------------------------------------------------------------------------------------------

TEST(MapToDisk, KeepsArea) {
    const SampleSet set(Sampler::sobol, 8, 4);
    // 8 rings of equal area by 8 sectors.
    std::vector<double> boxes(64);
    const int points = 8000;
    for (int p = 0; p < points; ++p) {
        Samples8 s;
        set.eight(set.key(p), 0, s);
        map_to_disk(s);
        for (int k = 0; k < 8; ++k) {
            const double r2 = static_cast<double>(s.x[k]) * static_cast<double>(s.x[k]) +
                              static_cast<double>(s.y[k]) * static_cast<double>(s.y[k]);
            ASSERT_LE(r2, 1 + 1e-6);
            const double turn = std::atan2(s.y[k], s.x[k]) / (2 * kPi) + 0.5;
            ++boxes[std::min(7, static_cast<int>(r2 * 8)) + 8 * std::min(7, static_cast<int>(turn * 8))];
        }
    }
    for (double n : boxes) EXPECT_NEAR(n, points / 8.0, 6 * std::sqrt(points / 8.0));
}

TEST(MapToDisk, IsTheConcentricMap) {
    Samples8 s{{0.5f, 1, 1, 0, 0.75f, 0.5f, 0.25f, 0.5f}, {0.5f, 0.5f, 1, 0, 0.625f, 0.9f, 0.75f, 0}};
    const Samples8 from = s;
    map_to_disk(s);
    for (int k = 0; k < 8; ++k) {
        const double a = 2.0 * static_cast<double>(from.x[k]) - 1, b = 2.0 * static_cast<double>(from.y[k]) - 1;
        double x = 0, y = 0;
        if (a != 0 || b != 0) {
            const double r = std::abs(a) > std::abs(b) ? a : b;
            const double t = std::abs(a) > std::abs(b) ? kPi / 4 * b / a : kPi / 2 - kPi / 4 * a / b;
            x = r * std::cos(t), y = r * std::sin(t);
        }
        EXPECT_NEAR(static_cast<double>(s.x[k]), x, 2e-7) << k;
        EXPECT_NEAR(static_cast<double>(s.y[k]), y, 2e-7) << k;
    }
}

TEST(TangentDisk, TouchesTheSphereAtARightAngle) {
    for (dvec3 p : {dvec3(3, 1, -2), dvec3(0, 0, -9), dvec3(0, 0, 9), dvec3(1.2, 0.3, 0.9)}) {
        const dvec3 centre(0.25, 0.5, 1);
        const double radius = 0.4;
        TangentDisk disk;
        ASSERT_TRUE(tangent_disk(p, centre, radius, disk));
        for (int k = 0; k < 16; ++k) {
            const double a  = 2 * kPi * k / 16;
            const dvec3 rim = disk.centre + disk.axis_u * std::cos(a) + disk.axis_v * std::sin(a);
            EXPECT_NEAR(glm::length(rim - centre), radius, 1e-12);
            EXPECT_NEAR(glm::dot(rim - centre, rim - p), 0, 1e-12);
        }
    }
    TangentDisk disk;
    EXPECT_FALSE(tangent_disk({0.1, 0, 0}, {0, 0, 0}, 0.5, disk));
}

}  // namespace
}  // namespace umbra
