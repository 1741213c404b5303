// PCSS over a filterable map: sums of windows against sums over samples, penumbrae of a half-plane against their closed
// form, and what no window may do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/shadows/filtered/summed_moments.h"
#include "umbra/shadows/maps/penumbra.h"
#include "umbra/tests/support/drawn_views.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"
#include "umbra/tests/support/phase_values.h"

namespace umbra {
namespace {

constexpr MomentKind kKindsOfTables[] = {MomentKind::vsm, MomentKind::evsm2, MomentKind::evsm4, MomentKind::msm};
constexpr const char* kNames[]        = {"vsm", "evsm2", "evsm4", "msm"};

// ---- tables --------------------------------------------------------------------------------------------------------

/// A ball, a box and a leaning sheet over a floor, under a light that looks down from the side.
Scene clutter() {
    Scene scene;
    add_mesh(scene, "floor", make_plane(8, 8));
    add_mesh(scene, "ball", make_sphere(0.7f, 24, 12), {0.2f, 1.1f, 0.3f});
    add_mesh(scene, "box", make_box({0.8f, 1.4f, 0.5f}), {-1.1f, 0.7f, -0.4f});
    const mat4 leaning(0.8f, 0.6f, 0, 0, -0.6f, 0.8f, 0, 0, 0, 0, 1, 0, 0.9f, 1.8f, -0.6f, 1);
    add_mesh(scene, "sheet", transformed(make_plane(1.5f, 1), leaning));
    Light light      = point_light({0.5f, 5, 0.6f});
    light.kind       = LightKind::disk;
    light.direction  = {0, -1, 0};
    light.radius     = 0.6f;
    scene.lights     = {light};
    scene.camera.eye = {0, 10, 0};
    return scene;
}

DrawnViews drawn(const Scene& scene, int resolution, bool fit_to_casters = true) {
    return DrawnViews(scene, {.resolution = resolution, .all_depths = true}, fit_to_casters);
}

MomentBound bound_of(MomentKind kind) { return {kind, 5, 5, 0, 0}; }

TEST(SummedMoments, WholeWindowsAreSumsOfIntegersToTheLastBit) {
    const Scene scene      = clutter();
    const DrawnViews views = drawn(scene, 150);
    const MapView& view    = views.views().at(0);
    std::mt19937 random(1);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    for (const MomentKind kind : {MomentKind::vsm, MomentKind::msm})
        for (const EmptySamples empty : {EmptySamples::far, EmptySamples::apart}) {
            const MomentBound bound = bound_of(kind);
            const SummedMoments table(view, bound, empty, 150);
            const double one = std::ldexp(1.0, table.bits());
            EXPECT_EQ(table.bits(), 62 - 15);  // 150 x 150 samples are fewer than 2^15
            const Moments of_far = moments_of(bound, 1);
            for (int trial = 0; trial < 300; ++trial) {
                // Wide ones, and those of a few samples, whose sums are small beside those of the table.
                const int wide = trial % 2 == 0 ? 1 + below(5) : 1 + below(149), high = 1 + below(149);
                const int left = below(151 - wide), top = below(151 - high);
                std::array<std::int64_t, 4> sums{};
                std::int64_t count = 0;
                for (int y = top; y < top + high; ++y)
                    for (int x = left; x < left + wide; ++x) {
                        const bool is_empty = view.map.is_empty(x, y);
                        if (is_empty && empty == EmptySamples::apart) continue;
                        ++count;
                        const Moments m =
                            is_empty ? of_far : moments_of(bound, linear_depth(view.frame, view.map.nearness(x, y)));
                        for (std::size_t k = 0; k < 4; ++k)
                            sums[k] += static_cast<std::int64_t>(std::floor(m[k] * one + 0.5));
                    }
                const WindowedDepth got = table.mean({left, top}, {left + wide, top + high});
                const double drawn_part = static_cast<double>(count) / (wide * high);
                ASSERT_EQ(got.drawn, empty == EmptySamples::apart ? drawn_part : 1);
                if (count == 0) continue;
                for (std::size_t k = 0; k < 4; ++k)
                    ASSERT_EQ(got.moments[k],
                              std::ldexp(static_cast<double>(sums[k]), -table.bits()) / static_cast<double>(count))
                        << k << ' ' << trial;
                ASSERT_EQ(got.depth, 0.5 * (got.moments[0] + 1));
            }
        }
}

TEST(SummedMoments, AnyWindowIsTheMeanOfWhatItCovers) {
    const Scene scene      = clutter();
    const DrawnViews views = drawn(scene, 90);
    const MapView& view    = views.views().at(0);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-10, 100), size(0.2, 30);
    for (const MomentKind kind : kKindsOfTables)
        for (const EmptySamples empty : {EmptySamples::far, EmptySamples::apart}) {
            const MomentBound bound = bound_of(kind);
            const SummedMoments table(view, bound, empty, 61);
            int partly = 0;
            for (int trial = 0; trial < 200; ++trial) {
                const dvec2 at{place(random), place(random)}, half{size(random), size(random)};
                Moments sums{};
                double depth = 0, drawn_part = 0;
                const auto covered = [](double centre, double h, int k) {
                    return std::max(0.0, std::min(centre + h, k + 1.0) - std::max(centre - h, double(k)));
                };
                for (int y = -45; y < 145; ++y)
                    for (int x = -45; x < 145; ++x) {
                        const double weight = covered(at.x, half.x, x) * covered(at.y, half.y, y);
                        if (weight == 0) continue;
                        const bool is_empty = x < 0 || y < 0 || x >= 90 || y >= 90 || view.map.is_empty(x, y);
                        if (is_empty && empty == EmptySamples::apart) continue;
                        const double z  = is_empty ? 1 : linear_depth(view.frame, view.map.nearness(x, y));
                        const Moments m = moments_of(bound, z);
                        for (std::size_t k = 0; k < 4; ++k) sums[k] += weight * m[k];
                        depth += weight * z;
                        drawn_part += weight;
                    }
                const WindowedDepth got = table.mean(at - half, at + half);
                const double whole      = 4 * half.x * half.y;
                ASSERT_NEAR(got.drawn, drawn_part / whole, 1e-12);
                partly += drawn_part > 0 && drawn_part < 0.999 * whole;
                if (drawn_part < 1e-6) continue;
                ASSERT_NEAR(got.depth, depth / drawn_part, 1e-11);
                // Of the largest value that a moment can have, exp(10), 2^-49 is left.
                for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(got.moments[k], sums[k] / drawn_part, 1e-9) << k;
            }
            if (empty == EmptySamples::apart) {
                EXPECT_GT(partly, 50);
            }
        }
}

TEST(SummedMoments, NoWindowIsDarkerThanItsSamples) {
    // What PCF over all samples of the window finds is never more light: the bounds err to one side.
    const Scene scene      = clutter();
    const DrawnViews views = drawn(scene, 100, false);
    const MapView& view    = views.views().at(0);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const MomentKind kind : kKindsOfTables) {
        const MomentBound bound = bound_of(kind);
        const SummedMoments table(view, bound, EmptySamples::apart, 100);
        int leaks = 0;
        for (int trial = 0; trial < 400; ++trial) {
            const int side = 2 + static_cast<int>(random() % 40), left = static_cast<int>(random() % (100 - side)),
                      top  = static_cast<int>(random() % (100 - side));
            const double z = uniform(random);
            int blocked    = 0;
            for (int y = top; y < top + side; ++y)
                for (int x = left; x < left + side; ++x)
                    blocked += !view.map.is_empty(x, y) && linear_depth(view.frame, view.map.nearness(x, y)) < z;
            const WindowedDepth window = table.mean({left, top}, {left + side, top + side});
            const double lit = window.drawn == 0 ? 1 : 1 - window.drawn * (1 - lit_bound(bound, window.moments, z));
            const double pcf = 1 - blocked / static_cast<double>(side * side);
            ASSERT_GE(lit, pcf - 1e-6) << static_cast<int>(kind) << ' ' << trial;
            leaks += lit > pcf + 0.01;
        }
        EXPECT_GT(leaks, 20) << static_cast<int>(kind);
    }
}

TEST(SummedMoments, OccludersLieWhereTheMeanSays) {
    // A quarter at depth 0.9, where the receiver is, the rest at 0.3.
    EXPECT_NEAR(occluder_depth(0.25, 0.25 * 0.9 + 0.75 * 0.3, 0.9), 0.3, 1e-15);
    EXPECT_EQ(occluder_depth(1, 0.9, 0.9), 0.9);
    // What is lit lies behind the receiver: no occluder lies behind it, and none before the near plane.
    EXPECT_EQ(occluder_depth(0.5, 0.95, 0.9), 0.9);
    EXPECT_EQ(occluder_depth(0.5, 0.3, 0.9), 0);
    for (const MomentKind kind : kKindsOfTables) {
        const MomentBound bound = bound_of(kind);
        const Moments near = moments_of(bound, 0.3), far = moments_of(bound, 0.9);
        Moments means{};
        for (std::size_t k = 0; k < 4; ++k) means[k] = 0.75 * near[k] + 0.25 * far[k];
        EXPECT_NEAR(occluder_depth(lit_bound(bound, means, 0.9), 0.45, 0.9), 0.3, 1e-4) << static_cast<int>(kind);
    }
}

// ---- lights --------------------------------------------------------------------------------------------------------

TEST(Penumbra, LightsAreAsWideAsTheyAreSeen) {
    const LightFrame frame;  // looks along z
    Light light;
    const auto near = [&](dvec2 direction, dvec2 want) {
        const dvec2 got = rectangle_as(frame, light, direction);
        EXPECT_NEAR(got.x, want.x, 1e-6);
        EXPECT_NEAR(got.y, want.y, 1e-6);
    };
    light.kind   = LightKind::rectangle;
    light.edge_u = {2, 0, 0}, light.edge_v = {0, 0.5f, 0};
    near({0, 0}, {1, 0.25});
    near({0.7, -2}, {1, 0.25});  // parallel to the map it looks alike from everywhere
    // Turned within its plane by the angle of 3, 4, 5: variances add.
    light.edge_u = {1.2f, 1.6f, 0}, light.edge_v = {-0.4f, 0.3f, 0};
    near({0, 0}, {std::hypot(0.6, 0.2), std::hypot(0.8, 0.15)});
    // Turned away by the same angle: narrower along x from in front, and from a side by its depth, too.
    light.edge_u = {1.2f, 0, 1.6f}, light.edge_v = {0, 0.5f, 0};
    near({0, 0}, {0.6, 0.25});
    near({0.5, 0}, {0.2, 0.25});
    near({-0.5, 0.25}, {1, std::hypot(0.2, 0.25)});
    // A disk has the standard deviation of a square sqrt(3)/2 as wide.
    const double round = std::sqrt(0.75);
    light.kind         = LightKind::disk;
    light.radius       = 2;
    light.direction    = {0, 0, 1};
    near({0.3, 0}, {2 * round, 2 * round});
    light.direction = {1, 0, 0};
    near({0, 0}, {0, 2 * round});
    near({0.5, 0}, {round, 2 * round});
    // A sphere looks like a disk that faces the point, which is longer where the map is oblique.
    light.kind = LightKind::sphere;
    near({0, 0}, {2 * round, 2 * round});
    near({0.75, 0}, {2 * round * 1.25, 2 * round});

    EXPECT_DOUBLE_EQ(disk_radius(light), 2);
    light.kind   = LightKind::rectangle;
    light.edge_u = {2, 0, 0}, light.edge_v = {0, 0.5f, 0};
    EXPECT_DOUBLE_EQ(kPi * disk_radius(light) * disk_radius(light), 1);
}

// ---- a half-plane ---------------------------------------------------------------------------------------------------

/// A long edge at `height` over a floor, parallel to z, that hides the side of negative x from a light 4 above.
Scene edge_over_floor(float height, LightKind kind = LightKind::rectangle) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "floor", {{-4, 0, -1}, {4, 0, -1}, {4, 0, 1}, {-4, 0, 1}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "sheet", {{-6, height, -6}, {0, height, -6}, {0, height, 6}, {-6, height, 6}}, {},
               {{0, 2, 1}, {0, 3, 2}}, 0);
    Light light     = point_light({0, 4, 0});
    light.kind      = kind;
    light.direction = {0, -1, 0};
    light.edge_u = {0.5f, 0, 0}, light.edge_v = {0, 0, -0.5f};
    light.radius     = 0.25f;
    scene.lights     = {light};
    scene.camera.eye = {0, -3, 0};
    return scene;
}

/// Points of the floor from x = -2 to 2 at z = -0.75, in its triangle (-4, 0, -1), (4, 0, 1), (4, 0, -1).
PointBatch across(const Scene& scene) {
    PointBatch points;
    points.eye = {0, 3, 0};
    points.resize(1601);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float x = -2 + static_cast<float>(i) / 400, u = 0.125f;
        set_point(points, i, scene, 0, u, (x + 4) / 8 - u);
    }
    face_lights(points, scene);
    return points;
}

std::vector<float> soft(const Scene& scene, const PointBatch& points, const std::string& settings,
                        int resolution = 1024) {
    const std::string more = settings.empty() ? "" : "," + settings;
    MethodCase run(fmt::format("filtered_map@soft:resolution={}{}", resolution, more), scene);
    run.prepare(0);
    return run.visibility(points, 0).s;
}

/// Of the floor at distance 4 behind the half-plane: what a rectangle of width 0.5 and a disk of radius 0.25 show.
double half_plane(double x, double height, LightKind kind) {
    const double w = 0.5 * height / (4 - height), u = std::clamp(2 * x / w, -1.0, 1.0);
    if (kind == LightKind::rectangle) return 0.5 + 0.5 * u;
    return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / kPi;
}

TEST(SoftWindows, APenumbraIsAsWideAsTheLightBehindAHalfPlane) {
    // w = size (d_r - d_b) / d_b. A texel of the map of 1024 is 0.0125 wide on the floor: that is how far the sheet's
    // edge may lie from where it is drawn, in units of the penumbra's width the error of S_j.
    constexpr double kTexel = 0.0125;
    for (const char* kind : kNames)
        for (const char* settings : {"parts=1,searches=1", "parts=1", "parts=2", "parts=3", "parts=2,fit=scene"})
            for (const float height : {0.5f, 0.9f, 1.4f}) {
                const Scene scene       = edge_over_floor(height);
                const PointBatch points = across(scene);
                const double w          = 0.5 * double(height) / (4 - double(height));
                const auto s            = soft(scene, points, fmt::format("kind={},{}", kind, settings));
                const bool draws_floor  = std::string_view(settings).ends_with("fit=scene");
                double first = 1e9, last = -1e9;
                for (std::size_t i = 0; i < s.size(); ++i) {
                    const double x = double(points.px[i]);
                    // Asked a bias before a floor that is drawn, the bound of an exponential is larger.
                    ASSERT_NEAR(s[i], half_plane(x, double(height), LightKind::rectangle),
                                (draws_floor ? 2 : 1) * kTexel / w)
                        << kind << ' ' << settings << ' ' << height << ' ' << x;
                    if (s[i] > 0.05f) first = std::min(first, x);
                    if (s[i] < 0.95f) last = std::max(last, x);
                    if (i > 0) {
                        // Where the floor is drawn, its own depths raise the bound by a little.
                        ASSERT_GE(s[i], s[i - 1] - (draws_floor ? 2e-2f : 0.0f)) << kind << ' ' << settings << ' ' << x;
                    }
                }
                EXPECT_NEAR(last - first, 0.9 * w, (draws_floor ? 2 : 0.5) * kTexel)
                    << kind << ' ' << settings << ' ' << height;
                EXPECT_EQ(s.front(), 0) << kind;
                EXPECT_EQ(s.back(), 1) << kind;
            }
}

TEST(SoftWindows, RoundLightsHaveThePenumbraOfARectangleOfTheirSpread) {
    for (const LightKind kind : {LightKind::disk, LightKind::sphere})
        for (const float height : {0.9f, 1.4f}) {
            const Scene scene       = edge_over_floor(height, kind);
            const PointBatch points = across(scene);
            const double w          = 0.5 * double(height) / (4 - double(height));
            const auto s            = soft(scene, points, "");
            for (std::size_t i = 0; i < s.size(); ++i) {
                const double x = double(points.px[i]);
                // The two shapes differ by 0.029 at most.
                ASSERT_NEAR(s[i], half_plane(x, double(height), kind), 0.0125 / w + 0.029) << height << ' ' << x;
                // Far from the edge it is lit or dark, to the last bit.
                if (std::abs(x) > 0.6 * w + 0.02) {
                    ASSERT_EQ(s[i], x > 0 ? 1 : 0) << x;
                }
            }
        }
}

TEST(SoftWindows, LaterSearchesLeaveOutWhatBlocksOtherPoints) {
    // A sheet below the light makes the first window wide, one beside the edge lies in it and blocks nothing here.
    Scene scene = edge_over_floor(0.5f);
    add_object(scene, "top", {{2, 3, -6}, {3, 3, -6}, {3, 3, 6}, {2, 3, 6}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "beside", {{0.2f, 1.4f, -6}, {0.5f, 1.4f, -6}, {0.5f, 1.4f, 6}, {0.2f, 1.4f, 6}}, {},
               {{0, 2, 1}, {0, 3, 2}}, 0);
    const PointBatch points = across(scene);
    const auto error        = [&](int searches) {
        const auto s = soft(scene, points, fmt::format("searches={}", searches));
        double sum   = 0;
        int n        = 0;
        for (std::size_t i = 0; i < s.size(); ++i) {
            const double x = double(points.px[i]);
            if (std::abs(x) > 0.05) continue;
            sum += std::abs(double(s[i]) - half_plane(x, 0.5, LightKind::rectangle));
            ++n;
        }
        return sum / n;
    };
    EXPECT_GT(error(1), 0.08);
    EXPECT_LT(error(2), 0.8 * error(1));
    EXPECT_LT(error(3), 0.7 * error(1));
}

// ---- what no window may do ------------------------------------------------------------------------------------------

TEST(SoftWindows, ASlantedReceiverAloneIsLit) {
    // Drawn into the map, and deep within one window: its own texels before the point are its plane.
    for (const vec3 towards : {vec3(2.5f, 2, 0), vec3(3, 0.9f, 1)})
        for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere})
            for (const char* name : kNames) {
                Scene scene = edge_over_floor(1, kind);
                scene.objects.clear(), scene.positions.clear(), scene.normals.clear(), scene.triangles.clear();
                scene.triangle_object.clear();
                add_mesh(scene, "floor", make_plane(4, 4));
                add_mesh(scene, "far", make_box({0.2f, 0.2f, 0.2f}), -1.5f * towards);
                scene.lights[0].position  = towards;
                scene.lights[0].direction = glm::normalize(-towards);
                scene.camera.eye          = {0, 3, 0};
                const PointBatch points   = points_on(scene, 0, 30);
                const auto s              = soft(scene, points, fmt::format("fit=scene,kind={}", name));
                EXPECT_GT(*std::ranges::min_element(s), 0.97f) << name << ' ' << to_string(kind);
            }
}

double mean_error(const Scene& scene, const char* method) {
    MethodCase exact("exact", scene), run(method, scene);
    const PointBatch points = primary(scene);
    double sum              = 0;
    std::size_t n           = 0;
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        exact.prepare(j), run.prepare(j);
        const VisibilityPlane right = exact.visibility(points, j), got = run.visibility(points, j);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, j, i) || !got.defined(i)) continue;
            sum += std::abs(double(got.s[i]) - double(right.s[i]));
            ++n;
        }
    }
    return sum / static_cast<double>(n);
}

Scene small_scene(const char* name) {
    Scene scene = load_scene(fmt::format("{}/{}.json", UMBRA_SCENES, name));
    scene.width = 160, scene.height = 90;
    return scene;
}

TEST(SoftWindows, ComeCloserThanTheLightsCentreAndThanSamples) {
    for (const auto& [name, share] : {std::pair{"umbra_penumbra", 0.4}, {"eclipse", 0.6}, {"light_sizes", 0.75}}) {
        const Scene scene = small_scene(name);
        const double got  = mean_error(scene, "filtered_map@soft");
        EXPECT_LT(got, share * mean_error(scene, "filtered_map")) << name;
        EXPECT_LT(got, mean_error(scene, "shadow_zbuffer@soft")) << name;
    }
}

TEST(SoftWindows, PartsKeepASlantedReceiverFromShadingItself) {
    const Scene scene = small_scene("umbra_penumbra");
    EXPECT_LT(mean_error(scene, "filtered_map@soft"), 0.9 * mean_error(scene, "filtered_map@soft:parts=1"));
}

// ---- the method -----------------------------------------------------------------------------------------------------

TEST(SoftWindows, SameForAnyNumberOfThreads) {
    const Scene scene       = clutter();
    const PointBatch points = points_on(scene, 0, 100);
    for (const char* kind : kNames) {
        std::vector<float> expected;
        for (const int threads : {1, 3, 8}) {
            const ThreadLimit limit(threads);
            const auto s = soft(scene, points, fmt::format("kind={}", kind), 300);
            if (expected.empty()) expected = s;
            EXPECT_EQ(s, expected) << kind;
        }
        EXPECT_GT(std::ranges::count_if(expected, [](float v) { return v > 0.1f && v < 0.9f; }), 100) << kind;
    }
}

TEST(SoftWindows, OfHardLightsItIsTheBox) {
    Scene scene             = edge_over_floor(0.7f);
    scene.lights[0].kind    = LightKind::point;
    const PointBatch points = across(scene);
    MethodCase pcss("filtered_map:filter=pcss", scene), box("filtered_map", scene);
    pcss.prepare(0), box.prepare(0);
    // The map of pcss is a little wider: windows may reach further over its border.
    const auto a = pcss.visibility(points, 0).s, b = box.visibility(points, 0).s;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (std::abs(points.px[i]) > 0.03f) {
            EXPECT_EQ(a[i], b[i]) << points.px[i];
        }
}

TEST(SoftWindows, ParametersRepeatThePhasesThatTheyName) {
    const Scene scene       = clutter();
    const PointBatch points = points_on(scene, 0, 60);
    const SceneFacts facts  = find_facts(scene);
    for (const char* change :
         {"filter=box", "kind=msm", "resolution=128", "radius=2", "positive_exponent=3", "negative_exponent=1",
          "bleed=0.3", "min_variance=0.01", "moment_bias=0.1", "empty=far", "precision=double", "bias=manual",
          "constant=30", "slope=20", "normal_offset=5", "fit=scene", "search=0.01", "parts=5", "searches=1"})
        for (const char* kind : {"vsm", "evsm4"}) {
            const MethodChoice from = parse_method(fmt::format("filtered_map@soft:resolution=200,kind={}", kind));
            MethodChoice to         = from;
            const std::string_view text(change);
            to.settings.set(text.substr(0, text.find('=')), text.substr(text.find('=') + 1));
            const PhaseInput input{scene, facts, points};
            const Phase first       = first_changed_phase(from.settings, to.settings);
            const PhaseAnswer again = answer_from(to, input, first, make_values(*from.make(), input));
            const PhaseAnswer once  = answer_from(to, input);
            EXPECT_EQ(again.plane.s, once.plane.s) << change;
            EXPECT_EQ(again.memory_bytes, once.memory_bytes) << change;
            if (text.starts_with("parts") || text.starts_with("search")) {
                EXPECT_NE(once.plane.s, answer_from(from, input).plane.s) << change;
            }
        }
}

TEST(SoftWindows, CountsItsTables) {
    Scene scene      = clutter();
    const auto bytes = [&](const char* settings) {
        MethodCase run(fmt::format("filtered_map@soft:resolution=64,{}", settings), scene);
        run.prepare(0);
        return run.memory_bytes();
    };
    const std::size_t entries = 65 * 65 * 8, depth = drawn(scene, 64).memory_bytes();
    EXPECT_EQ(bytes("kind=vsm,empty=far"), depth + entries * 2);
    EXPECT_EQ(bytes("kind=vsm"), depth + entries * 3);
    EXPECT_EQ(bytes("kind=evsm2,empty=far"), depth + entries * 3);
    EXPECT_EQ(bytes("kind=evsm4"), depth + entries * 6);
    EXPECT_EQ(bytes("kind=msm"), depth + entries * 5);
    scene.lights[0].kind = LightKind::point;
    EXPECT_EQ(bytes("kind=vsm"), depth + 64 * 64 * 3 * 4);
}

TEST(SoftWindows, BlameWhatLiesInTheWindow) {
    const Scene scene       = edge_over_floor(0.9f);
    const PointBatch points = across(scene);
    MethodCase run("filtered_map@soft", scene);
    run.prepare(0);
    const auto s = run.visibility(points, 0).s;
    std::vector<TriangleId> who(points.size(), 12345);
    run.blame(points, 0, who);
    int in_penumbra = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s[i] == 1) continue;
        // The sample that the point's own line passes is empty in half of the penumbra.
        in_penumbra += points.px[i] > 0.02f;
        ASSERT_NE(who[i], kNoTriangle) << points.px[i];
        EXPECT_EQ(scene.objects[scene.triangle_object[who[i]]].name, "sheet");
    }
    EXPECT_GT(in_penumbra, 10);
    EXPECT_EQ(who.back(), kNoTriangle);
}

TEST(SoftWindows, SaysWhatItsPenumbraeAre) {
    const Scene scene = clutter();
    EXPECT_NE(MethodCase("filtered_map@soft", scene).serves().why.find("behind one blocker"), std::string::npos);
    EXPECT_EQ(MethodCase("filtered_map@soft", scene).serves().why.find("missing"), std::string::npos);
}

TEST(SoftWindows, WhatContradictsItselfIsRefused) {
    const auto refusal = [](const std::string& settings) -> std::string {
        try {
            (void)parse_method("filtered_map:" + settings).make();
        } catch (const UsageError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_NE(refusal("filter=pcss,kind=esm").find("expected kind=vsm, evsm2, evsm4 or msm"), std::string::npos);
    EXPECT_EQ(refusal("filter=box,kind=esm"), "");
    for (const char* kind : kNames) EXPECT_EQ(refusal(fmt::format("filter=pcss,kind={}", kind)), "");
    EXPECT_NE(refusal("filter=pcss,resolution=128,normal_offset=60").find("expected a resolution"), std::string::npos);
}

}  // namespace
}  // namespace umbra
