// Kernels of PCF beside what is known of them: published weights, integrals over a half-plane, areas of disks.
#include "umbra/shadows/maps/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/maps/depth_lookup.h"
#include "umbra/shadows/maps/penumbra.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

constexpr int kSize = 48;  ///< samples along a side of the maps below

/// A map in which the samples that `blocks` names lie on the near plane and all others are empty.
template <class Blocks>
MapView map_of(const Blocks& blocks) {
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            if (!blocks(x, y)) continue;
            const auto first = static_cast<std::uint32_t>(positions.size());
            const vec3 corner(x, y, 0);
            for (const vec3 by : {vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0)})
                positions.push_back(corner + by);
            triangles.emplace_back(first, first + 1, first + 2);
            triangles.emplace_back(first, first + 2, first + 3);
        }
    DepthMap map(kSize, kSize, DepthFormat::float32);
    const std::span<const uvec3> run(triangles);
    // Positions in samples: x right, y down, z depth.
    map.draw(glm::transpose(dmat4(dvec4(2.0 / kSize, 0, 0, -1), dvec4(0, 2.0 / kSize, 0, -1), dvec4(0, 0, -1, 1),
                                  dvec4(0, 0, 0, 1))),
             positions, std::span(&run, 1), Faces::all);
    return {{}, std::move(map)};
}

/// S_j of a point halfway into the depth of the map.
double share(const MapView& map, dvec2 at, const Filter& filter, dvec2 turn = {1, 0}) {
    return lit_share(map, {.x = at.x, .y = at.y, .r = 0.5, .r_x = 0, .r_y = 0, .bias = 0, .turn = turn},
                     BiasMode::manual, filter);
}

TEST(Kernels, PointsBesideTheMapSeeWhatReachesIntoTheirKernel) {
    // All samples block. How much of a kernel lies in the map decides, on all four sides, up to where none does.
    const MapView map               = map_of([](int, int) { return true; });
    const std::vector<dvec2> points = even_disk(24);
    int darkened = 0, lit = 0;
    for (const Kernel kernel : {Kernel::grid, Kernel::disc, Kernel::castano3, Kernel::castano5, Kernel::castano7})
        for (const int radius : {0, 1, 3, 20})
            for (const bool bilinear : {false, true}) {
                const Filter filter{kernel_radius(kernel, radius), bilinear, kernel, points};
                for (double beyond = -2; beyond < filter.radius + 4; beyond += 0.31)
                    for (const dvec2 at : {dvec2(-beyond, 20), dvec2(kSize + beyond, 20), dvec2(20, -beyond),
                                           dvec2(20, kSize + beyond), dvec2(-beyond, -beyond)}) {
                        double outside     = 0;
                        const double whole = for_each_sample(at, {1, 0}, filter, [&](int i, int j, double weight) {
                            if (i < 0 || j < 0 || i >= kSize || j >= kSize) outside += weight;
                        });
                        const double s     = share(map, at, filter);
                        ASSERT_NEAR(s, outside / whole, 1e-6)
                            << static_cast<int>(kernel) << ' ' << radius << ' ' << beyond;
                        darkened += beyond > 0 && s < 1 ? 1 : 0;
                        lit += s == 1 ? 1 : 0;
                    }
            }
    EXPECT_GT(darkened, 500);
    EXPECT_GT(lit, 500);
}

TEST(Kernels, SharesAreThoseOfTheirSamplesOneByOne) {
    // Half of the samples block, without a pattern; discs of few points, squares of all sizes.
    std::mt19937 random(5);
    std::vector<bool> blocks(static_cast<std::size_t>(kSize) * kSize);
    for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = random() % 2 == 0;
    const auto blocked = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < kSize && y < kSize && blocks[static_cast<std::size_t>(y * kSize + x)];
    };
    const MapView map = map_of(blocked);
    std::uniform_real_distribution<double> place(-4, kSize + 4), turns(0, 2 * kPi);
    for (const Kernel kernel : {Kernel::grid, Kernel::disc, Kernel::castano3, Kernel::castano5, Kernel::castano7})
        for (int trial = 0; trial < 1500; ++trial) {
            const std::vector<dvec2> points = even_disk(1 + trial % 11);
            const Filter filter{kernel_radius(kernel, trial % 18), trial % 2 == 0, kernel, points};
            const double angle = turns(random);
            const dvec2 at(place(random), place(random)), turn(std::cos(angle), std::sin(angle));
            double lit         = 0;
            const double whole = for_each_sample(at, turn, filter, [&](int i, int j, double weight) {
                if (!blocked(i, j)) lit += weight;
            });
            ASSERT_NEAR(share(map, at, filter, turn), lit / whole, 1e-6)
                << static_cast<int>(kernel) << " radius " << filter.radius << " points " << points.size();
        }
}

TEST(Kernels, PcssTakesTheMeanOfTheDepthsThatItsSearchFinds) {
    // Every sample blocks, each at another depth; what is right comes from one point of the disc after the other. Some
    // receivers lie beside the map, and see what their search reaches there.
    std::mt19937 random(6);
    std::uniform_real_distribution<double> depth(1.5, 6), unit(0, 1), turns(0, 2 * kPi), place(-0.3, 1.3);
    LightFrame frame;
    frame.near = 1, frame.far = 10, frame.half = dvec2(0.5);
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            if (random() % 3 == 0) continue;  // holes
            const auto first = static_cast<std::uint32_t>(positions.size());
            const double z   = depth(random);
            for (const dvec2 by : {dvec2(0, 0), dvec2(1, 0), dvec2(1, 1), dvec2(0, 1)}) {
                const dvec2 at = (dvec2(x, y) + by) / static_cast<double>(kSize) - 0.5;
                positions.emplace_back(at.x * z, at.y * z, z);
            }
            triangles.emplace_back(first, first + 1, first + 2);
            triangles.emplace_back(first, first + 2, first + 3);
        }
    MapView view{frame, DepthMap(kSize, kSize, DepthFormat::float32)};
    const std::span<const uvec3> run(triangles);
    view.map.draw(frame.clip_from_world(), positions, std::span(&run, 1), Faces::all);
    int partly = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const std::vector<dvec2> points = even_disk(3 + trial % 9);
        const SoftFilter filter{points, 0.05 + 0.4 * unit(random), 12};
        const double z = 2 + 7 * unit(random), angle = turns(random);
        Receiver p{.x    = kSize * place(random),
                   .y    = kSize * place(random),
                   .r    = frame.nearness(z),
                   .r_x  = 0,
                   .r_y  = 0,
                   .bias = 0};
        p.turn             = {std::cos(angle), std::sin(angle)};
        const auto blocker = [&](dvec2 offset) {
            const int x       = static_cast<int>(std::floor(p.x + offset.x)),
                      y       = static_cast<int>(std::floor(p.y + offset.y));
            const bool in_map = x >= 0 && y >= 0 && x < kSize && y < kSize;
            return in_map && view.map.nearness(x, y) > p.r ? frame.depth(view.map.nearness(x, y)) : 0;
        };
        const auto reach = [&](double at) { return penumbra_reach(view, dvec2(filter.size), at, z, filter.texels); };
        double sum       = 0;
        int found = 0, lit = 0;
        for (const dvec2 point : points)
            if (const double d = blocker(reach(frame.near) * turned(point, p.turn)); d > 0) sum += d, ++found;
        if (found > 0)
            for (const dvec2 point : points) lit += blocker(reach(sum / found) * turned(point, p.turn)) == 0 ? 1 : 0;
        const double expected = found == 0 ? 1 : static_cast<double>(lit) / static_cast<double>(points.size());
        ASSERT_NEAR(soft_share(view, p, z, BiasMode::manual, filter), expected, 1e-6) << trial;
        partly += expected > 0 && expected < 1 ? 1 : 0;
    }
    EXPECT_GT(partly, 500);
}

struct Castano {
    Kernel kernel;
    int taps;
    double sum;
};
constexpr Castano kCastanos[] = {{Kernel::castano3, 2, 16}, {Kernel::castano5, 3, 144}, {Kernel::castano7, 4, 2704}};

/// Of one row: what the bilinear comparisons count, and where they are, as published; s is the position between
/// samples.
std::vector<dvec2> taps(Kernel kernel, double s) {
    if (kernel == Kernel::castano3) return {{3 - 2 * s, (2 - s) / (3 - 2 * s) - 1}, {1 + 2 * s, s / (1 + 2 * s) + 1}};
    if (kernel == Kernel::castano5)
        return {{4 - 3 * s, (3 - 2 * s) / (4 - 3 * s) - 2}, {7, (3 + s) / 7}, {1 + 3 * s, s / (1 + 3 * s) + 2}};
    return {{-(5 * s - 6), (4 * s - 5) / (5 * s - 6) - 3},
            {-(11 * s - 28), (4 * s - 16) / (11 * s - 28) - 1},
            {11 * s + 17, (7 * s + 5) / (11 * s + 17) + 1},
            {5 * s + 1, s / (5 * s + 1) + 3}};
}

TEST(Kernels, CastanosWeighSamplesAsTheirBilinearComparisonsDo) {
    for (const Castano& c : kCastanos)
        for (const dvec2 part : {dvec2(0), dvec2(0.25, 0.5), dvec2(0.9, 0.1), dvec2(0.5, 1.0 / 3)}) {
            // What each comparison takes of the two samples beside it, in both directions.
            const auto row = [&](double s) {
                std::vector<double> weights(10, 0.0);  // of samples -4 to 5
                for (const dvec2 tap : taps(c.kernel, s)) {
                    const double below = std::floor(tap.y), beyond = tap.y - below;
                    weights[static_cast<std::size_t>(below) + 4] += tap.x * (1 - beyond);
                    weights[static_cast<std::size_t>(below) + 5] += tap.x * beyond;
                }
                return weights;
            };
            ASSERT_EQ(taps(c.kernel, part.x).size(), static_cast<std::size_t>(c.taps));
            const std::vector<double> across = row(part.x), down = row(part.y);
            const dvec2 at = dvec2(20.5) + part;  // beyond the middle of sample 20
            double sum     = 0;
            for (int y = -4; y <= 5; ++y)
                for (int x = -4; x <= 5; ++x) {
                    const MapView one   = map_of([&](int i, int j) { return i == 20 + x && j == 20 + y; });
                    const double weight = c.sum * (1 - share(one, at, {kernel_radius(c.kernel, 0), true, c.kernel}));
                    EXPECT_NEAR(weight, across[x + 4] * down[y + 4], 1e-6 * c.sum) << x << ' ' << y;
                    sum += weight;
                }
            EXPECT_NEAR(sum, c.sum, 1e-5 * c.sum);
        }
}

TEST(Kernels, SumsArePublishedOnes) {
    for (const Castano& c : kCastanos) {
        double sum = 0;
        const double whole =
            for_each_sample({20.3, 7.9}, {1, 0}, {kernel_radius(c.kernel, 0), true, c.kernel}, [&](int, int, double w) {
                EXPECT_GE(w, 0);
                sum += w;
            });
        EXPECT_DOUBLE_EQ(whole, c.sum);
        EXPECT_DOUBLE_EQ(sum, c.sum);
    }
    const std::vector<dvec2> points = even_disk(37);
    for (const Filter& f : {Filter{3, false}, Filter{3, true}, Filter{0, true}, Filter{2, false, Kernel::disc, points},
                            Filter{2, true, Kernel::disc, points}}) {
        double sum         = 0;
        const double whole = for_each_sample({20.3, 7.9}, {0.6, 0.8}, f, [&](int, int, double w) { sum += w; });
        EXPECT_NEAR(sum, whole, 1e-12 * whole);
    }
}

/// The part of the unit disk beyond the line x = d.
double disk_beyond(double d) {
    d = std::clamp(d, -1.0, 1.0);
    return (std::acos(d) - d * std::sqrt(1 - d * d)) / kPi;
}

/// The part of a kernel beyond a line, `d` samples from its middle.
double kernel_beyond(const Filter& f, double d) {
    if (f.kernel == Kernel::disc) {
        const double radius = f.radius + 0.5;
        if (!f.bilinear) return disk_beyond(d / radius);
        constexpr int kSteps = 200;  // over the sample that a comparison is bilinear in
        double sum           = 0;
        for (int k = 0; k < kSteps; ++k) sum += disk_beyond((d + (k + 0.5) / kSteps - 0.5) / radius);
        return sum / kSteps;
    }
    // A density that is constant over each sample.
    const std::span<const double> heights = profile(f.kernel);
    double beyond = 0, all = 0;
    for (int k = 0; k <= 2 * f.radius; ++k) {
        const double height = heights.empty() ? 1 : heights[static_cast<std::size_t>(k)];
        const double left   = k - f.radius - 0.5;
        beyond += height * std::clamp(left + 1 - d, 0.0, 1.0);
        all += height;
    }
    return beyond / all;
}

TEST(Kernels, AHalfPlaneGivesTheKernelsIntegralAsARamp) {
    const std::vector<dvec2> points = even_disk(1024);
    const MapView left              = map_of([](int x, int) { return x < 24; });
    const MapView above             = map_of([](int, int y) { return y < 24; });
    for (const Filter& f :
         {Filter{1, true}, Filter{4, true}, Filter{1, true, Kernel::castano3}, Filter{2, true, Kernel::castano5},
          Filter{3, true, Kernel::castano7}, Filter{2, false, Kernel::disc, points},
          Filter{2, true, Kernel::disc, points}, Filter{5, true, Kernel::disc, points}}) {
        const bool sampled     = f.kernel == Kernel::disc;
        const double tolerance = sampled ? 0.006 : 1e-6;
        double before          = 0;
        for (double x = 24 - f.radius - 1.5; x <= 24 + f.radius + 1.5; x += 0.0625) {
            const double s = share(left, {x, 20.2}, f), expected = kernel_beyond(f, 24 - x);
            ASSERT_NEAR(s, expected, tolerance) << static_cast<int>(f.kernel) << ' ' << f.radius << ' ' << x;
            ASSERT_NEAR(share(above, {20.2, x}, f), expected, tolerance) << static_cast<int>(f.kernel) << ' ' << x;
            ASSERT_GE(s, before - 1e-7) << x;
            before = s;
        }
        EXPECT_EQ(share(left, {24 - f.radius - 1.5, 20.2}, f), 0);
        EXPECT_EQ(before, 1);
    }
}

TEST(Kernels, ADiscOfManyPointsIsItsArea) {
    std::mt19937 random(3);
    std::vector<bool> blocked(kSize * kSize);
    for (auto&& b : blocked) b = random() % 3 == 0;
    const MapView map   = map_of([&](int x, int y) { return blocked[y * kSize + x]; });
    const double radius = 3.5;
    std::vector<double> error;
    for (const int n : {16, 64, 256, 1024}) {
        const std::vector<dvec2> points = even_disk(n);
        double sum                      = 0;
        for (int k = 0; k < 20; ++k) {
            const dvec2 at(15.13 + 0.7 * k, 18.4 + 0.31 * k);
            constexpr int kSteps = 400;
            int in = 0, lit = 0;
            for (int j = 0; j < kSteps; ++j)
                for (int i = 0; i < kSteps; ++i) {
                    const dvec2 q = radius * ((dvec2(i, j) + 0.5) * (2.0 / kSteps) - 1.0);
                    if (glm::dot(q, q) > radius * radius) continue;
                    ++in;
                    const ivec2 sample(glm::floor(at + q));
                    lit += blocked[sample.y * kSize + sample.x] ? 0 : 1;
                }
            const double angle = k;
            const double s     = share(map, at, {3, false, Kernel::disc, points}, {std::cos(angle), std::sin(angle)});
            sum += std::pow(s - double(lit) / in, 2);
        }
        error.push_back(std::sqrt(sum / 20));
    }
    EXPECT_LT(error[0], 0.15);
    EXPECT_LT(error[3], 0.006);
    for (int k = 0; k + 1 < 4; ++k) EXPECT_LT(error[k + 1], 0.6 * error[k]) << k;
}

TEST(Kernels, WhatAllSamplesAgreeOnNoKernelChanges) {
    const std::vector<dvec2> points = even_disk(7);
    const MapView none = map_of([](int, int) { return false; }), all = map_of([](int, int) { return true; });
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int trial = 0; trial < 500; ++trial) {
        const dvec2 at   = dvec2(18) + 12.0 * dvec2(uniform(random), uniform(random));
        const dvec2 turn = noise_turn(at.x, at.y);
        const int radius = trial % 17;
        for (const Filter& f :
             {Filter{radius, false}, Filter{radius, true}, Filter{1, true, Kernel::castano3},
              Filter{2, true, Kernel::castano5}, Filter{3, true, Kernel::castano7},
              Filter{radius, true, Kernel::disc, points}, Filter{radius, false, Kernel::disc, points}}) {
            ASSERT_EQ(share(none, at, f, turn), 1);
            ASSERT_EQ(share(all, at, f, turn), 0);
        }
    }
}

TEST(Kernels, WiderThanTheMapTheyCountItsPartOfTheSquare) {
    const MapView all = map_of([](int, int) { return true; });
    for (const int radius : {17, 30, 64})
        for (const bool bilinear : {false, true}) {
            const double side = 2 * radius + 1, blocked = std::min<double>(kSize, side);
            EXPECT_NEAR(share(all, {24.5, 24.5}, {radius, bilinear}), 1 - blocked * blocked / (side * side), 1e-6)
                << radius << bilinear;
        }
    // A half-plane's edge passes over a wide kernel sample by sample, and between samples if it is bilinear.
    const MapView half = map_of([](int x, int) { return x < 24; });
    for (const double x : {20.0, 20.25, 20.9}) {
        const double covered = 24 - (x - 17.5);
        EXPECT_NEAR(share(half, {x, 24.5}, {17, true}), 1 - covered / 35, 1e-6) << x;
        EXPECT_NEAR(share(half, {x, 24.5}, {17, false}), 1 - (24 - (std::floor(x) - 17)) / 35, 1e-6) << x;
    }
}

// ---- rotation ------------------------------------------------------------------------------------------------------

double turns_of(dvec2 turn) {
    EXPECT_NEAR(glm::length(turn), 1, 1e-12);
    return std::atan2(turn.y, turn.x) / (2 * kPi) + (turn.y < 0 ? 1 : 0);
}

TEST(Kernels, NoiseIsEvenAndNeighboursHaveNothingInCommon) {
    constexpr int kSide = 100, kBins = 20;
    std::vector<int> bins(kBins);
    double product = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const dvec2 here = noise_turn(700 + 0.37 * x, 3 + 0.21 * y),
                        next = noise_turn(700 + 0.37 * (x + 1), 3 + 0.21 * y);
            ++bins[static_cast<std::size_t>(std::min(turns_of(here) * kBins, kBins - 1.0))];
            product += glm::dot(here, next);
            EXPECT_EQ(here, noise_turn(700 + 0.37 * x, 3 + 0.21 * y));
        }
    double chi            = 0;
    const double expected = double(kSide) * kSide / kBins;
    for (const int n : bins) chi += (n - expected) * (n - expected) / expected;
    EXPECT_LT(chi, 43.8);  // 19 degrees of freedom, one in a thousand
    EXPECT_LT(std::abs(product) / (kSide * kSide), 0.03);
    EXPECT_NE(noise_turn(3, 5), noise_turn(5, 3));
}

TEST(Kernels, GradientNoiseIsSpreadOverAnyNinePixels) {
    double widest = 0;
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 60; ++x) {
            std::vector<double> nine;
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) nine.push_back(turns_of(gradient_turn(x + i, y + j)));
            std::ranges::sort(nine);
            double gap = nine[0] + 1 - nine[8];
            for (int k = 0; k < 8; ++k) gap = std::max(gap, nine[k + 1] - nine[k]);
            widest = std::max(widest, gap);
        }
    // Nine random angles leave gaps of 0.31 on average, and of over 0.6 somewhere in as many blocks.
    EXPECT_LT(widest, 0.25);
}

// ---- in the shadow z-buffer ----------------------------------------------------------------------------------------

/// Boxes of two sizes over a floor, seen from above.
Scene boxes(const Light& light) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(6, 6));
    add_mesh(scene, "large", make_box({1, 0.6f, 1.4f}), {-0.6f, 0.5f, 0.2f});
    add_mesh(scene, "small", make_box({0.3f, 0.3f, 0.3f}), {1, 0.9f, -0.7f});
    scene.lights     = {light};
    scene.camera.eye = {0.5f, 7, 2};
    scene.width = 400, scene.height = 300;
    return scene;
}

std::vector<float> answers(const Scene& scene, const PointBatch& points, const std::string& settings) {
    MethodCase run("shadow_zbuffer:" + settings, scene);
    run.prepare(0);
    return run.visibility(points, 0).s;
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double(a[i]) - double(b[i]));
    return sum / static_cast<double>(a.size());
}

constexpr const char* kKernels[] = {"kernel=disc,radius=3",
                                    "kernel=disc,radius=3,bilinear=false",
                                    "kernel=disc,radius=3,rotation=noise,samples=12",
                                    "kernel=disc,radius=3,rotation=gradient,samples=12",
                                    "kernel=castano3",
                                    "kernel=castano5",
                                    "kernel=castano7",
                                    "filter=pcss,rotation=noise",
                                    "filter=pcss,rotation=gradient"};

TEST(Kernels, OfTheShadowZBufferChangeEdgesAlone) {
    for (const Light& light : {directional_light({0.3f, -1, 0.2f}), point_light({1, 5, 1})}) {
        const Scene scene       = boxes(light);
        const PointBatch points = primary(scene);
        // Other biases depend on the kernel.
        const std::string map = "resolution=256,bias=manual,constant=4,slope=8,";
        const auto plain      = answers(scene, points, map + "filter=pcf,radius=6,bilinear=false");
        for (const std::string kernel : kKernels) {
            const bool soft = kernel.starts_with("filter");
            const auto s    = answers(scene, points, map + (soft ? "" : "filter=pcf,") + kernel);
            int between = 0, wrong = 0;
            for (std::size_t i = 0; i < s.size(); ++i) {
                between += s[i] > 0 && s[i] < 1;
                // Where a square that holds the kernel is all lit or all dark, so is the kernel. Their maps differ in
                // where their texels are.
                wrong += (plain[i] == 0 || plain[i] == 1) && s[i] != plain[i];
            }
            EXPECT_GT(between, 100) << kernel;
            EXPECT_EQ(wrong, 0) << kernel;
        }
    }
}

TEST(Kernels, RotationIsNoiseAboutTheSameMean) {
    const Scene scene       = boxes(directional_light({0.3f, -1, 0.2f}));
    const PointBatch points = primary(scene);
    const std::string disc  = "resolution=256,filter=pcf,kernel=disc,radius=4,bilinear=false";
    const auto many         = answers(scene, points, disc + ",samples=1024");
    // Of the mean difference, in its standard errors.
    const auto bias_of = [&](const std::vector<float>& s) {
        double sum = 0, squares = 0;
        for (std::size_t i = 0; i < s.size(); ++i) {
            const double difference = double(s[i]) - double(many[i]);
            sum += difference;
            squares += difference * difference;
        }
        return std::abs(sum) / std::sqrt(squares);
    };
    const auto none = answers(scene, points, disc + ",samples=8");
    for (const char* rotation : {"noise", "gradient"}) {
        const auto s = answers(scene, points, fmt::format("{},samples=8,rotation={}", disc, rotation));
        EXPECT_NE(s, none) << rotation;
        EXPECT_LT(mean_difference(s, many), 2 * mean_difference(none, many)) << rotation;
        EXPECT_LT(bias_of(s), 4) << rotation;
    }
}

TEST(Kernels, AnswersDoNotDependOnTheRasterOrTheThreads) {
    const Scene scene       = boxes(directional_light({0.3f, -1, 0.2f}));
    const PointBatch points = primary(scene);
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 3; i < points.size(); i += 7) which.push_back(i);
    const PointBatch some = pick(points, which);
    for (const std::string kernel : kKernels) {
        const std::string settings = "resolution=128,filter=pcf," + kernel;
        if (kernel.starts_with("filter")) continue;
        const auto all = answers(scene, points, settings);
        const auto few = answers(scene, some, settings);
        for (std::size_t k = 0; k < which.size(); ++k) ASSERT_EQ(few[k], all[which[k]]) << kernel;
        const ThreadLimit limit(1);
        EXPECT_EQ(answers(scene, points, settings), all) << kernel;
    }
}

Scene under_a_disk_light() {
    Light light     = point_light({0, 4, 0});
    light.kind      = LightKind::disk;
    light.direction = {0, -1, 0};
    light.radius    = 0.3f;
    return boxes(light);
}

TEST(Kernels, RotationBreaksTheBandsOfPcss) {
    const Scene scene       = under_a_disk_light();
    const PointBatch points = primary(scene);
    const std::string pcss  = "resolution=512,filter=pcss";
    const auto many         = answers(scene, points, pcss + ",samples=1024");
    const auto none         = answers(scene, points, pcss + ",samples=6");
    for (const char* rotation : {"noise", "gradient"}) {
        const auto s = answers(scene, points, fmt::format("{},samples=6,rotation={}", pcss, rotation));
        EXPECT_NE(s, none);
        EXPECT_LT(mean_difference(s, many), 1.5 * mean_difference(none, many)) << rotation;
        EXPECT_GT(std::ranges::count_if(s, [](float v) { return v > 0 && v < 1; }), 200) << rotation;
    }
}

TEST(Kernels, ALightsSizeStaysWhereOnlyTheBiasChanges) {
    const Scene scene       = under_a_disk_light();
    const PointBatch points = primary(scene);
    MethodCase run("shadow_zbuffer:resolution=256,filter=pcss,constant=3", scene);
    run.prepare(0);
    // A parameter of the phase visibility: what build and aim made serves.
    const auto sloped = parse_method("shadow_zbuffer:resolution=256,filter=pcss,constant=3,slope=1").make();
    VisibilityPlane plane(points.size());
    sloped->visibility(run.aimed(), *run.look(points), plane.out());
    EXPECT_EQ(plane.s, answers(scene, points, "resolution=256,filter=pcss,constant=3,slope=1"));
}

TEST(Kernels, WhatContradictsItselfIsRefused) {
    const auto refusal = [](const std::string& settings) -> std::string {
        try {
            (void)parse_method("shadow_zbuffer:" + settings).make();
        } catch (const UsageError& e) {
            return e.what();
        }
        return "";
    };
    for (const char* kernel : {"castano3", "castano5", "castano7"}) {
        EXPECT_NE(refusal(fmt::format("filter=pcss,kernel={}", kernel)).find("expected kernel=grid or kernel=disc"),
                  std::string::npos);
        EXPECT_EQ(refusal(fmt::format("filter=pcf,kernel={}", kernel)), "");
        // Their own radius counts, not the one that is set.
        EXPECT_EQ(refusal(fmt::format("filter=pcf,radius=16,resolution=32,kernel={}", kernel)), "");
    }
    EXPECT_EQ(refusal("filter=pcss,kernel=disc"), "");
    EXPECT_NE(refusal("filter=pcf,radius=16,resolution=32,kernel=disc").find("radius=16"), std::string::npos);
}

}  // namespace
}  // namespace umbra
