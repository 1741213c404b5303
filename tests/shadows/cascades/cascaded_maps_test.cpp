#include "umbra/shadows/cascades/cascaded_maps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/errors/shadow_edges.h"
#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

// ---- scenes --------------------------------------------------------------------------------------------------------

/// A floor along -z with a fence beside the camera, from its feet to 150 units away.
Scene long_fence(vec3 direction = {1, -0.35f, -0.3f}) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(60, 200), {0, 0, -90});
    for (int i = 0; i < 60; ++i)
        add_mesh(scene, fmt::format("post {}", i), make_box({0.2f, 1.2f, 0.15f}),
                 {-1.5f, 0.6f, 1 - 2.5f * static_cast<float>(i)});
    scene.lights        = {directional_light(direction)};
    scene.camera.eye    = {1.5f, 1.7f, 3};
    scene.camera.target = {0.5f, 0.5f, -20};
    scene.camera.fov_y  = 50;
    scene.width         = 320;
    scene.height        = 180;
    return scene;
}

/// A few boxes on a floor, all within the view.
Scene boxes_in_view() {
    Scene scene;
    add_mesh(scene, "floor", make_plane(30, 30));
    for (int i = 0; i < 5; ++i)
        add_mesh(scene, fmt::format("box {}", i), make_box({0.5f, 1 + 0.2f * static_cast<float>(i), 0.7f}),
                 {static_cast<float>(i) - 2, 0.7f, 0.6f * static_cast<float>(i % 3) - 0.5f});
    scene.lights        = {directional_light({0.7f, -1, 0.3f})};
    scene.camera.eye    = {0.5f, 5, 9};
    scene.camera.target = {0, 0.3f, 0};
    scene.width         = 160;
    scene.height        = 120;
    return scene;
}

/// Points of the floor (object 0) in a grid of x and z, without a raster.
PointBatch floor_points(const Scene& scene, dvec2 low, dvec2 high, int n) {
    PointBatch points;
    points.eye = scene.camera.eye;
    points.resize(static_cast<std::size_t>(n) * n);
    const auto add = [&](std::size_t i, dvec2 at) {
        for (TriangleId t = 0; t < scene.objects[0].triangle_count; ++t) {
            const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
            const dvec2 ab(b.x - a.x, b.z - a.z), ac(c.x - a.x, c.z - a.z), ap(at.x - a.x, at.y - a.z);
            const double area = ab.x * ac.y - ab.y * ac.x;
            const double u = (ap.x * ac.y - ap.y * ac.x) / area, v = (ab.x * ap.y - ab.y * ap.x) / area;
            if (u >= 0 && v >= 0 && u + v <= 1)
                return set_point(points, i, scene, t, static_cast<float>(u), static_cast<float>(v));
        }
    };
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            add(static_cast<std::size_t>(y) * n + x, low + (high - low) * (dvec2(x, y) + 0.5) / static_cast<double>(n));
    face_lights(points, scene);
    return points;
}

// ---- running -------------------------------------------------------------------------------------------------------

/// The method itself, whose windows can be asked, aimed at light 0.
struct Maps {
    SceneFacts facts;
    CascadedMaps method;
    std::unique_ptr<const Built> built;
    std::unique_ptr<const Aimed> aimed;

    Maps(const Scene& scene, std::string_view settings)
        : facts(find_facts(scene)),
          method(parse_method(fmt::format("cascaded_maps:{}", settings)).settings),
          built(method.build(scene, facts)),
          aimed(method.aim(*built, 0)) {}
    [[nodiscard]] Cascades fit(const PointBatch& points) const {
        return method.fit(*aimed, *method.look(*built, points)).value();
    }
    [[nodiscard]] VisibilityPlane visibility(const PointBatch& points) const {
        VisibilityPlane plane(points.size());
        method.visibility(*aimed, *method.look(*built, points), plane.out());
        return plane;
    }
    [[nodiscard]] std::size_t memory_bytes() const { return built->memory_bytes() + aimed->memory_bytes(); }
};

VisibilityPlane answers(const Scene& scene, const PointBatch& points, std::string_view choice) {
    MethodCase run(choice, scene);
    run.prepare(0);
    return run.visibility(points, 0);
}

const char* const kSplits[] = {"uniform", "logarithmic", "practical"};

// ---- splits --------------------------------------------------------------------------------------------------------

TEST(CascadedMaps, SplitsAreTheFormulas) {
    const std::vector<double> uniform = split_depths(Splits::uniform, 0.5, 1, 16, 4);
    const std::vector<double> root    = split_depths(Splits::logarithmic, 0.5, 1, 16, 4);
    const std::vector<double> mixed   = split_depths(Splits::practical, 0.25, 1, 16, 4);
    ASSERT_EQ(uniform.size(), 5u);
    ASSERT_EQ(root.size(), 5u);
    ASSERT_EQ(mixed.size(), 5u);
    const double by_hand[3][5] = {{1, 4.75, 8.5, 12.25, 16}, {1, 2, 4, 8, 16}, {1, 4.0625, 7.375, 11.1875, 16}};
    for (int i = 0; i < 5; ++i) {
        EXPECT_DOUBLE_EQ(uniform[i], by_hand[0][i]);
        EXPECT_DOUBLE_EQ(root[i], by_hand[1][i]);
        EXPECT_DOUBLE_EQ(mixed[i], by_hand[2][i]);
    }
    EXPECT_EQ(split_depths(Splits::practical, 1, 0.3, 70, 7), split_depths(Splits::logarithmic, 0, 0.3, 70, 7));
    EXPECT_EQ(split_depths(Splits::practical, 0, 0.3, 70, 7), split_depths(Splits::uniform, 1, 0.3, 70, 7));
    EXPECT_EQ(split_depths(Splits::logarithmic, 0, 3, 70, 1), (std::vector<double>{3, 70}));
}

/// Two bodies of facets, one near and one that reaches over the far end of the view, seen along the light.
Scene bodies_along_the_light() {
    Scene scene;
    add_mesh(scene, "near", make_sphere(0.3f, 24, 12), {0, 0, -4});
    // Not round, so that it has the picture's axes.
    add_mesh(scene, "far",
             transformed(make_sphere(1, 48, 24), mat4(60, 0, 0, 0, 0, 46, 0, 0, 0, 0, 60, 0, 0, 0, -200, 1)));
    scene.lights        = {directional_light({0, 0, -1})};
    scene.camera.eye    = {0, 0, 0};
    scene.camera.target = {0, 0, -1};
    scene.camera.fov_y  = 20;
    scene.width         = 200;
    scene.height        = 200;
    return scene;
}

TEST(CascadedMaps, TexelsPerPixelGoOverTheRootOfTheRangeInALogarithmicPart) {
    const Scene scene       = bodies_along_the_light();
    const PointBatch points = primary(scene);
    const CameraFrame& view = *points.raster;
    for (const int m : {1, 3, 4, 8}) {
        const Maps maps(scene, fmt::format("splits=logarithmic,window=frustum,cascades={}", m));
        const Cascades fit = maps.fit(points);
        ASSERT_EQ(fit.parts.size(), std::size_t(m));
        const double range = fit.splits.back() / fit.splits.front();
        EXPECT_GT(range, 30);
        const auto ratio = [&](const Cascade& part, double depth) {
            return part.texel(2048).x / (2 * view.half_width * depth / view.width);
        };
        for (int k = 0; k < m; ++k) {
            EXPECT_EQ(fit.parts[k].texel(2048).x, fit.parts[k].texel(2048).y);
            const double first = ratio(fit.parts[k], fit.splits[k]), last = ratio(fit.parts[k], fit.splits[k + 1]);
            EXPECT_NEAR(first / last, std::pow(range, 1.0 / m), 1e-9 * range) << k << " of " << m;
            // A window is as wide as the far end of its part, and four texels of border: alike for all parts.
            EXPECT_NEAR(last, 200.0 / 2044, 1e-6) << k << " of " << m;
        }
    }
    // Uniform parts are coarse where pixels are fine: the first covers the most octaves.
    const Cascades uniform = Maps(scene, "splits=uniform,window=frustum").fit(points);
    EXPECT_GT(uniform.splits[1] / uniform.splits[0], 5 * std::pow(uniform.splits[4] / uniform.splits[0], 0.25));
}

// ---- windows -------------------------------------------------------------------------------------------------------

TEST(CascadedMaps, OneCascadeOverAllIsTheShadowZBuffer) {
    const Scene scene       = boxes_in_view();
    const PointBatch points = primary(scene);
    for (const char* window : {"receivers", "frustum"})
        for (const char* map : {"resolution=512", "resolution=301,filter=pcf,radius=2", "filter=pcf,bilinear=false",
                                "bias=manual,constant=3,slope=1", "bias=receiver_plane", "normal_offset=3"}) {
            const VisibilityPlane one =
                answers(scene, points, fmt::format("cascaded_maps:cascades=1,window={},{}", window, map));
            const VisibilityPlane map_of_all = answers(scene, points, fmt::format("shadow_zbuffer:{}", map));
            EXPECT_EQ(one.s, map_of_all.s) << window << ' ' << map;
            EXPECT_GT(std::ranges::count(one.s, 0.0f), 1000);
        }
}

TEST(CascadedMaps, TexelsNeverGrowWhenEachPartIsSplitInTwo) {
    for (const Scene& scene : {long_fence(), boxes_in_view(), long_fence({0.2f, -1, 0.1f})}) {
        const PointBatch points = primary(scene);
        for (const char* window : {"receivers", "frustum"})
            for (const char* splits : kSplits) {
                std::vector<double> before(points.size(), kInfinity);
                double sum = 0, first_sum = 0;
                for (const int m : {1, 2, 4, 8}) {
                    const Cascades fit =
                        Maps(scene, fmt::format("window={},splits={},cascades={}", window, splits, m)).fit(points);
                    sum = 0;
                    for (std::size_t i = 0; i < points.size(); ++i) {
                        if (!points.asks(0, i)) continue;
                        const Cascades::Choice choice = fit.choose(exact_position(scene, points, i));
                        if (choice.first == Cascades::kLit) continue;
                        ASSERT_LT(choice.first, fit.parts.size()) << "a point that is seen has a cascade";
                        if (!fit.parts[choice.first].casts) continue;
                        const dvec2 texel = fit.parts[choice.first].texel(2048);
                        ASSERT_LE(texel.x * texel.y, before[i] * (1 + 1e-6)) << window << ' ' << splits << ' ' << m;
                        before[i] = texel.x * texel.y;
                        sum += before[i];
                    }
                    if (m == 1) first_sum = sum;
                }
                // All of the boxes is as near as the rest; the fence is not.
                EXPECT_LT(sum, (scene.objects.size() > 10 ? 0.6 : 1.0) * first_sum) << window << ' ' << splits;
            }
    }
}

TEST(CascadedMaps, WindowsOfReceiversAreSmallerThanThoseOfTheView) {
    const Scene scene       = long_fence();
    const PointBatch points = primary(scene);
    const Cascades view     = Maps(scene, "window=frustum").fit(points);
    const Cascades surfaces = Maps(scene, "window=receivers").fit(points);
    const Cascades samples  = Maps(scene, "depth_range=visible").fit(points);
    const auto area         = [](const Cascades& fit) {
        double all = 0;
        for (const Cascade& part : fit.parts) all += part.frame.half.x * part.frame.half.y;
        return all;
    };
    EXPECT_LT(area(surfaces), 0.7 * area(view));
    EXPECT_LE(area(samples), area(surfaces));
    // What is seen lies among what is in view.
    EXPECT_GE(samples.splits.front(), surfaces.splits.front());
    EXPECT_LE(samples.splits.back(), surfaces.splits.back());
}

TEST(CascadedMaps, DepthsAreThoseOfWhatIsInView) {
    // A floor that the view's sides cut, and a ball behind the camera that says nothing.
    Scene scene = boxes_in_view();
    add_mesh(scene, "behind", make_sphere(1, 16, 8), {0.5f, 6, 30});
    const PointBatch points  = primary(scene);
    const Cascades in_view   = Maps(scene, "window=frustum").fit(points);
    const Cascades as_seen   = Maps(scene, "window=frustum,depth_range=visible").fit(points);
    const CameraFrame& frame = *points.raster;
    MinMax seen;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.asks(0, i)) seen.add(frame.project(exact_position(scene, points, i)).z);
    EXPECT_EQ(as_seen.splits.front(), seen.min);
    EXPECT_EQ(as_seen.splits.back(), seen.max);
    // The floor fills the picture's lower edge: the nearest depth is that of the corner, half a pixel from its centre.
    const double lowest = frame.eye.y / -frame.ray_direction(80, 120).y;
    EXPECT_NEAR(in_view.splits.front(), lowest, 1e-6);
    EXPECT_LT(in_view.splits.front(), as_seen.splits.front());
}

TEST(CascadedMaps, AFloorAtTheEyeLeavesTheSplitsTheirRange) {
    // Depths from next to nothing: splits begin at a share of the farthest, the first part where the view does.
    Scene scene             = long_fence();
    scene.camera.eye        = {-0.5f, 1e-5f, -10};
    scene.camera.target     = {-0.4f, -2, -15};
    const PointBatch points = primary(scene);
    for (const char* settings : {"splits=logarithmic", "stable=true", "window=frustum", "depth_range=visible"}) {
        const Cascades fit = Maps(scene, settings).fit(points);
        EXPECT_NEAR(fit.splits.front(), 1e-4 * fit.splits.back(), 1e-9 * fit.splits.back()) << settings;
        int nearer = 0, in_part = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!points.asks(0, i)) continue;
            const dvec3 p = exact_position(scene, points, i);
            nearer += fit.view.depth(p) < fit.splits.front();
            in_part += fit.choose(p).first == 0;
        }
        EXPECT_GT(nearer, 20000) << settings;
        EXPECT_GE(in_part, nearer) << settings;
    }
}

TEST(CascadedMaps, WhatCastsFromOutsideTheViewShades) {
    // A roof over the light's side of what the camera sees, behind the camera and high above: nothing of it is in view.
    Scene scene;
    add_mesh(scene, "floor", make_plane(40, 40));
    add_mesh(scene, "roof", make_box({4, 0.2f, 4}), {0, 30, 30});
    add_mesh(scene, "box", make_box({0.4f, 0.4f, 0.4f}), {3, 0.2f, 0});
    scene.lights            = {directional_light({0, -1, -1})};
    scene.camera.eye        = {0, 3, 7};
    scene.camera.target     = {0, 0, 0};
    scene.width             = 160;
    scene.height            = 90;
    const PointBatch points = primary(scene);
    std::size_t roof        = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        roof += points.triangle[i] != kNoTriangle && scene.triangle_object[points.triangle[i]] == 1;
    ASSERT_EQ(roof, 0u);
    for (const char* settings : {"splits=uniform", "splits=logarithmic", "stable=true", "depth_range=visible",
                                 "window=frustum", "cascades=1", "resolution=64,filter=pcf,radius=3"}) {
        const VisibilityPlane plane = answers(scene, points, fmt::format("cascaded_maps:{}", settings));
        int dark                    = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const vec3 p = points.position(i);
            if (!points.asks(0, i) || p.y > 0 || std::max(std::abs(p.x), std::abs(p.z)) > 1.4f) continue;
            EXPECT_EQ(plane.s[i], 0) << settings << ' ' << p.x << ' ' << p.z;
            ++dark;
        }
        EXPECT_GT(dark, 300);
    }
}

TEST(CascadedMaps, PointsOutsideOfTheViewAreAnswered) {
    // All of the floor, little of it in the picture, as reflections ask for it; the camera looks all around.
    Scene scene                 = long_fence();
    const PointBatch points     = floor_points(scene, {-3, -30}, {6, 3}, 250);
    const VisibilityPlane truth = answers(scene, points, "exact");
    const auto dark             = std::ranges::count(truth.s, 0.0f);
    ASSERT_GT(dark, 2000);
    const auto wrong_in = [&](const VisibilityPlane& plane) {
        std::ptrdiff_t wrong = 0;
        for (std::size_t i = 0; i < points.size(); ++i) wrong += plane.s[i] != truth.s[i];
        return wrong;
    };
    const auto one_map = wrong_in(answers(scene, points, "shadow_zbuffer:resolution=1024"));
    EXPECT_LT(one_map, dark);
    scene.camera.eye = {1.5f, 1.7f, -12};
    for (const char* settings : {"resolution=1024", "resolution=1024,stable=true", "resolution=1024,window=frustum",
                                 "resolution=1024,depth_range=visible"}) {
        std::size_t by_part = 0, by_whole = 0;
        for (int turn = 0; turn < 8; ++turn) {
            const float angle   = 0.785f * (static_cast<float>(turn) + 0.3f);
            scene.camera.target = scene.camera.eye + vec3(std::cos(angle), -0.2f, std::sin(angle));
            const Maps maps(scene, settings);
            const Cascades fit          = maps.fit(points);
            const VisibilityPlane plane = maps.visibility(points);
            for (std::size_t i = 0; i < points.size(); ++i) {
                EXPECT_EQ(plane.answer[i], Answer::given);
                const std::size_t part = fit.choose(exact_position(scene, points, i)).first;
                by_part += part < fit.parts.size();
                by_whole += part == fit.parts.size();
            }
            // The whole is that map, and the parts are finer.
            EXPECT_LT(wrong_in(plane), 1.02 * static_cast<double>(one_map)) << settings << ' ' << turn;
        }
        EXPECT_GT(by_part, 10000u) << settings;
        EXPECT_GT(by_whole, 10000u) << settings;
    }
}

// ---- stable --------------------------------------------------------------------------------------------------------

TEST(CascadedMaps, StableTexelsStayWhereTheyAreWhenTheCameraMoves) {
    for (const bool stable : {true, false}) {
        Scene scene             = long_fence();
        const Camera camera     = scene.camera;
        const PointBatch points = floor_points(scene, {-3, -30}, {4, 0}, 250);
        const Maps maps(scene, fmt::format("resolution=512,stable={}", stable));
        const Cascades first         = maps.fit(points);
        const VisibilityPlane before = maps.visibility(points);
        const double texel           = first.parts[0].texel(512).x;
        int compared = 0, changed = 0, grids = 0, following = 0, moved_grids = 0;
        for (const vec3 way : {vec3(1, 0, 0), vec3(-1, 0.3f, 0.2f), vec3(0.2f, 0.1f, -1), vec3(0, -1, 0.5f)})
            for (const double step : {0.11, 0.37, 0.93}) {
                const vec3 by               = static_cast<float>(step * texel) * glm::normalize(way);
                scene.camera.eye            = camera.eye + by;
                scene.camera.target         = camera.target + by;
                const Cascades now          = maps.fit(points);
                const VisibilityPlane after = maps.visibility(points);
                if (stable) {
                    EXPECT_EQ(now.splits, first.splits);
                }
                for (std::size_t k = 0; k < now.parts.size(); ++k) {
                    const LightFrame &a = first.parts[k].frame, &b = now.parts[k].frame;
                    const dvec2 size = first.parts[k].texel(512);
                    for (int axis = 0; axis < 2; ++axis) {
                        // Along an axis without bounds the window is that of all that casts, wherever the camera is.
                        const bool follows = std::isfinite(now.parts[k].low[axis]);
                        const double from  = (b.centre - b.half)[axis] / size[axis];
                        const double steps = follows ? from - std::round(from) : b.centre[axis] - a.centre[axis];
                        ++grids;
                        following += follows;
                        moved_grids += a.half != b.half || a.x != b.x || std::abs(steps) > 1e-6;
                    }
                }
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const dvec3 p   = exact_position(scene, points, i);
                    const auto part = first.choose(p).first;
                    if (part >= first.parts.size() || now.choose(p).first != part) continue;
                    ++compared;
                    changed += before.s[i] != after.s[i];
                }
            }
        EXPECT_EQ(grids, 96);
        EXPECT_GT(following, 20);
        EXPECT_GT(compared, 100000);
        if (stable) {
            EXPECT_EQ(moved_grids, 0);
            EXPECT_EQ(changed, 0);
        } else {
            EXPECT_GT(moved_grids, 40);
            EXPECT_GT(changed, 100);
        }
    }
}

TEST(CascadedMaps, StableWindowsHoldTheirPartOfTheViewWhereverTheCameraLooks) {
    Scene scene = long_fence();
    const Maps maps(scene, "stable=true,blend=0.2");
    int held = 0;
    for (int turn = 0; turn < 12; ++turn) {
        const float angle       = 0.5f * static_cast<float>(turn);
        scene.camera.target     = scene.camera.eye + vec3(std::cos(angle), -0.2f, std::sin(angle));
        const PointBatch points = primary(scene);
        const Cascades fit      = maps.fit(points);
        for (std::size_t k = 0; k < fit.parts.size(); ++k)
            for (const dvec3& corner : fit.view.corners(fit.splits[k], fit.splits[k + 1])) {
                const dvec2 at = (dvec2(fit.parts[k].frame.light_space(corner)) - fit.parts[k].frame.centre) /
                                 fit.parts[k].frame.half;
                // Within the map by as much as a filter of one texel asks for; or nothing casts beyond.
                for (int axis = 0; axis < 2; ++axis) {
                    if (!std::isfinite(fit.parts[k].low[axis])) continue;
                    EXPECT_LT(std::abs(at[axis]), 1 - 2 * 2.0 / 2048) << turn << ' ' << k;
                    ++held;
                }
                EXPECT_TRUE(fit.parts[k].answers(corner));
            }
    }
    EXPECT_GT(held, 100);
}

TEST(CascadedMaps, SpheresHoldTheCornersAndTouchThem) {
    Scene scene = boxes_in_view();
    for (const bool orthographic : {false, true})
        for (const float fov : {20.0f, 60.0f, 120.0f}) {
            scene.camera.projection = orthographic ? Projection::orthographic : Projection::perspective;
            scene.camera.fov_y      = fov;
            const View view(frame(scene.camera, 160, 90));
            const View::Sphere sphere = view.sphere(2, 7);
            double farthest           = 0;
            for (const dvec3& corner : view.corners(2, 7))
                farthest = std::max(farthest, glm::length(corner - sphere.centre));
            EXPECT_NEAR(farthest, sphere.radius, 1e-12 * sphere.radius);
            // No other centre on the axis does with less.
            for (const double by : {-0.01, 0.01}) {
                double other = 0;
                for (const dvec3& corner : view.corners(2, 7))
                    other = std::max(
                        other, glm::length(corner - sphere.centre - by * glm::normalize(sphere.centre - view.eye())));
                EXPECT_GT(other, sphere.radius) << orthographic << ' ' << fov << ' ' << by;
            }
        }
}

// ---- seams ---------------------------------------------------------------------------------------------------------

TEST(CascadedMaps, LitSurfacesAreLitInAllPartsAndAtTheSeams) {
    // A low dome of facets, convex, so that it shades none of itself; its map holds the dome itself, at all slopes.
    Scene scene;
    Mesh dome = make_plane(200, 200, 60);
    for (vec3& p : dome.positions) p.y = -0.001f * (p.x * p.x + p.z * p.z);
    dome.normals.clear();
    add_mesh(scene, "dome", dome);
    scene.lights            = {directional_light({0.5f, -0.5f, -0.2f})};
    scene.camera.eye        = {3, 2.5f, 40};
    scene.camera.target     = {0, -1, -10};
    scene.width             = 240;
    scene.height            = 135;
    const PointBatch points = primary(scene);
    for (const char* splits : kSplits)
        for (const int m : {1, 2, 4, 8})
            for (const char* more :
                 {"", "filter=pcf,", "filter=pcf,radius=4,bilinear=false,", "filter=pcf,blend=0.3,", "stable=true,",
                  "filter=pcf,stable=true,blend=1,", "window=frustum,filter=pcf,", "depth_range=visible,filter=pcf,"}) {
                const VisibilityPlane plane =
                    answers(scene, points,
                            fmt::format("cascaded_maps:{}resolution=256,splits={},cascades={}", more, splits, m));
                int dark = 0, asked = 0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    if (!points.asks(0, i)) continue;
                    ++asked;
                    dark += plane.s[i] != 1;
                }
                EXPECT_EQ(dark, 0) << more << splits << m;
                EXPECT_GT(asked, 15000);
            }
}

TEST(CascadedMaps, EachPointHasOneCascadeWithoutBlendAndSharesRiseToTheSeamWithIt) {
    const Scene scene       = long_fence();
    const PointBatch points = primary(scene);
    const Cascades apart    = Maps(scene, "splits=logarithmic,blend=0").fit(points);
    const Cascades blended  = Maps(scene, "splits=logarithmic,blend=0.25").fit(points);
    EXPECT_EQ(apart.splits, blended.splits);
    int in_two = 0, in_one = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points.asks(0, i)) continue;
        const dvec3 p                = exact_position(scene, points, i);
        const Cascades::Choice alone = apart.choose(p), both = blended.choose(p);
        EXPECT_EQ(alone.second, Cascades::kLit);
        EXPECT_EQ(alone.share, 0);
        EXPECT_EQ(alone.first, both.first);
        if (both.first >= blended.parts.size()) continue;
        const double depth = blended.view.depth(p), end = blended.splits[both.first + 1];
        const double begin = end - 0.25 * (end - blended.splits[both.first]);
        const bool last    = both.first + 1 == blended.parts.size();
        const double share = last || depth <= begin ? 0 : (depth - begin) / (end - begin);
        EXPECT_NEAR(both.share, share, 1e-9);
        EXPECT_EQ(both.second, share > 0 ? both.first + 1 : Cascades::kLit);
        ++(share > 0 ? in_two : in_one);
    }
    EXPECT_GT(in_two, 500);
    EXPECT_GT(in_one, 1000);
}

TEST(CascadedMaps, BlendingLeavesNoStepAtTheSeams) {
    // Pairs of floor points close to one another on either side of a seam, where a kernel is half in shadow.
    const Scene scene    = long_fence();
    const PointBatch eye = primary(scene);
    const auto steps     = [&](const char* settings) {
        const Maps maps(scene, fmt::format("resolution=96,filter=pcf,radius=3,{}", settings));
        const Cascades fit = maps.fit(eye);
        PointBatch pairs;
        pairs.eye = eye.eye;
        pairs.resize(8000);
        std::size_t n = 0;
        for (std::size_t k = 1; k + 1 < fit.splits.size(); ++k)
            for (int i = 0; i < 1000; ++i)
                for (const double side : {-1e-4, 1e-4}) {
                    // On the floor, at the seam's depth: x as it comes, z from the depth.
                    const double x = -3 + 8 * (i + 0.5) / 1000;
                    const dvec3 f(eye.raster->forward);
                    const double z =
                        eye.raster->eye.z +
                        (fit.splits[k] + side - f.x * (x - eye.raster->eye.x) + f.y * eye.raster->eye.y) / f.z;
                    const dvec2 uv       = {(x + 30) / 60, (z + 190) / 200};
                    const PointBatch one = floor_points(scene, {x, z}, {x, z}, 1);
                    if (uv.x < 0 || uv.x > 1 || uv.y < 0 || uv.y > 1 || one.triangle[0] == kNoTriangle) continue;
                    set_point(pairs, n++, scene, one.triangle[0], one.u[0], one.v[0]);
                }
        pairs.resize(n);
        face_lights(pairs, scene);
        const VisibilityPlane plane = maps.visibility(pairs);
        std::pair<int, int> result{0, 0};
        for (std::size_t i = 0; i + 1 < n; i += 2) {
            result.first += std::abs(plane.s[i] - plane.s[i + 1]) > 0.02f;
            ++result.second;
        }
        return result;
    };
    const auto apart = steps("blend=0"), blended = steps("blend=0.3");
    EXPECT_GT(apart.second, 1500);
    EXPECT_GT(apart.first, 200);
    EXPECT_LT(blended.first, apart.first / 20);
}

// ---- accuracy ------------------------------------------------------------------------------------------------------

/// 95th percentile and mean of the distance of shadow edges from the true ones, pixels, over points of some depths.
EdgeDisplacement edges_between(const Scene& scene, const PointBatch& points, VisibilityPlane plane,
                               VisibilityPlane truth, double from, double to) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const double depth = points.raster->project(exact_position(scene, points, i)).z;
        if (depth < from || depth >= to) plane.answer[i] = truth.answer[i] = Answer::undefined;
    }
    const auto found = edge_displacement(points, error_classes(points, 0, plane, truth, kHardTolerance), plane, truth);
    return found.value_or(EdgeDisplacement{});
}

TEST(CascadedMaps, NearEdgesAreBetterThanThoseOfOneMapOfAsManyTexels) {
    Scene scene                     = long_fence();
    scene.width                     = 640;
    scene.height                    = 360;
    const PointBatch points         = primary(scene);
    const VisibilityPlane truth     = answers(scene, points, "exact");
    const VisibilityPlane one       = answers(scene, points, "shadow_zbuffer:resolution=2048");
    const EdgeDisplacement near_one = edges_between(scene, points, one, truth, 0, 12);
    const EdgeDisplacement far_one  = edges_between(scene, points, one, truth, 25, 1000);
    ASSERT_GT(near_one.pieces, 1000u);
    ASSERT_GT(far_one.pieces, 100u);
    EXPECT_GT(near_one.mean, 0.25);
    // Measured, of the mean of one map: 0.57, 0.31, 0.12, 0.10 near the eye, and 0.4, 1.0, 0.6, 0.1 far from it.
    struct Expected {
        const char* settings;
        double near, far;
    };
    double before = 1;
    for (const Expected& e :
         {Expected{"splits=uniform", 0.7, 0.6}, Expected{"splits=practical", 0.4, 1.3},
          Expected{"splits=logarithmic", 0.2, 0.9}, Expected{"splits=logarithmic,depth_range=visible", 0.15, 0.3}}) {
        const VisibilityPlane four =
            answers(scene, points, fmt::format("cascaded_maps:cascades=4,resolution=1024,{}", e.settings));
        const EdgeDisplacement near = edges_between(scene, points, four, truth, 0, 12);
        const EdgeDisplacement far  = edges_between(scene, points, four, truth, 25, 1000);
        EXPECT_LT(near.mean, e.near * near_one.mean) << e.settings;
        EXPECT_LT(near.mean, before) << e.settings << ": the more logarithmic, the better near the eye";
        EXPECT_LE(near.p95, near_one.p95) << e.settings;
        EXPECT_EQ(near.unmatched, 0u) << e.settings;
        EXPECT_LT(far.mean, e.far * far_one.mean) << e.settings;
        before = near.mean;
    }
}

TEST(CascadedMaps, ErrorsFallWithResolution) {
    const Scene scene           = load_scene(std::string(UMBRA_SCENES) + "/low_sun_fence.json");
    const PointBatch points     = primary(scene);
    const VisibilityPlane truth = answers(scene, points, "exact");
    std::vector<double> rmse;
    for (const int resolution : {64, 128, 256, 512, 1024}) {
        const VisibilityPlane plane = answers(scene, points, fmt::format("cascaded_maps:resolution={}", resolution));
        rmse.push_back(visibility_error(points, 0, plane, truth, kHardTolerance).rmse);
    }
    // The wrong area falls as texels do, its root by the root of two; single steps waver.
    for (std::size_t i = 1; i < rmse.size(); ++i) EXPECT_LT(rmse[i], 0.95 * rmse[i - 1]) << i;
    EXPECT_LT(rmse.back(), 0.4 * rmse.front());
}

TEST(CascadedMaps, AllSettingsAreRightOutsideTheEdgeBand) {
    const Scene scene           = load_scene(std::string(UMBRA_SCENES) + "/low_sun_fence.json");
    const PointBatch points     = primary(scene);
    const VisibilityPlane truth = answers(scene, points, "exact");
    for (const char* settings :
         {"splits=uniform", "splits=logarithmic", "stable=true", "stable=true,blend=0.5", "blend=0.2", "cascades=8",
          "depth_range=visible", "window=frustum", "depth_range=visible,window=frustum", "filter=pcf"}) {
        const VisibilityPlane plane = answers(scene, points, fmt::format("cascaded_maps:{}", settings));
        const VisibilityError e     = visibility_error(points, 0, plane, truth, kHardTolerance);
        EXPECT_LT(double(e.false_light.interior + e.false_shadow.interior), 3e-4 * double(e.points)) << settings;
        EXPECT_GT(e.umbra, 10000u);
    }
}

// ---- the contract --------------------------------------------------------------------------------------------------

TEST(CascadedMaps, PicturesDecideTheFitOfPointsWithoutOne) {
    // Some of the points, without the raster: the same bits, since the scene's own picture is fitted to.
    const Scene scene       = long_fence();
    const PointBatch points = primary(scene);
    for (const char* settings : {"", "depth_range=visible", "stable=true", "blend=0.3"}) {
        const std::string choice = fmt::format("cascaded_maps:resolution=256{}{}", *settings ? "," : "", settings);
        std::vector<std::uint32_t> some;
        for (std::uint32_t i = 0; i < points.size(); i += 7) some.push_back(i);
        const VisibilityPlane all  = answers(scene, points, choice);
        const VisibilityPlane part = answers(scene, pick(points, some), choice);
        int differ                 = 0;
        for (std::size_t k = 0; k < some.size(); ++k) differ += part.s[k] != all.s[some[k]];
        EXPECT_EQ(differ, 0) << settings;
    }
}

TEST(CascadedMaps, WhatIsSeenServesALightThatMoves) {
    // At first the floor faces away from the light. Its points have no picture: one is traced, once.
    Scene scene            = long_fence({1, 0.35f, -0.3f});
    PointBatch points      = floor_points(scene, {-3, -30}, {6, 3}, 100);
    const SceneFacts facts = find_facts(scene);
    const CascadedMaps method(parse_method("cascaded_maps:resolution=256,depth_range=visible").settings);
    const auto built  = method.build(scene, facts);
    const auto looked = method.look(*built, points);
    scene.lights[0]   = long_fence().lights[0];
    face_light(points, scene, 0);
    const auto aimed = method.aim(*built, 0);
    VisibilityPlane plane(points.size());
    method.visibility(*aimed, *looked, plane.out());
    EXPECT_EQ(plane.s, answers(scene, points, "cascaded_maps:resolution=256,depth_range=visible").s);
    EXPECT_EQ(method.fit(*aimed, *looked)->splits,
              Maps(scene, "resolution=256,depth_range=visible").fit(primary(scene)).splits);
    EXPECT_EQ(looked->memory_bytes(), 320 * 180 * 37u);
    EXPECT_GT(std::ranges::count(plane.s, 0.0f), 100);
}

TEST(CascadedMaps, SameBitsForAnyNumberOfThreadsAndFromSeveralAtOnce) {
    const Scene scene       = long_fence();
    const PointBatch points = primary(scene);
    for (const char* settings : {"filter=pcf,blend=0.2", "depth_range=visible", "stable=true"}) {
        std::vector<float> expected;
        for (const int threads : {1, 3, 8}) {
            const ThreadLimit limit(threads);
            const Maps maps(scene, fmt::format("resolution=512,{}", settings));
            const VisibilityPlane plane = maps.visibility(points);
            if (expected.empty()) expected = plane.s;
            EXPECT_EQ(plane.s, expected) << settings;
        }
        const Maps maps(scene, fmt::format("resolution=512,{}", settings));
        std::array<VisibilityPlane, 4> at_once;
        parallel_ranges(4, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) at_once[k] = maps.visibility(points);
        });
        for (const VisibilityPlane& plane : at_once) EXPECT_EQ(plane.s, expected) << settings;
    }
}

TEST(CascadedMaps, OtherLightsHaveOneMapOrACube) {
    Scene scene = boxes_in_view();
    Light lamp;
    lamp.name        = "lamp";
    lamp.position    = {1, 6, 2};
    Light spot       = lamp;
    spot.kind        = LightKind::spot;
    spot.direction   = glm::normalize(vec3(-0.2f, -1, 0));
    spot.spot.cutoff = glm::radians(30.0f);
    scene.lights.push_back(lamp);
    scene.lights.push_back(spot);
    const PointBatch points = primary(scene);
    MethodCase maps("cascaded_maps:resolution=128", scene), zbuffer("shadow_zbuffer:resolution=128", scene);
    EXPECT_NE(maps.serves().why.find("others by one map"), std::string::npos) << maps.serves().why;
    maps.build();
    zbuffer.build();
    for (const LightId light : {1u, 2u, 0u, 1u}) {
        maps.aim(light);
        zbuffer.aim(light);
        const VisibilityPlane one = maps.visibility(points, light), other = zbuffer.visibility(points, light);
        EXPECT_EQ(one.s == other.s, light != 0) << light;
        std::vector<TriangleId> blockers(points.size()), others(points.size());
        maps.blame(points, light, blockers);
        zbuffer.blame(points, light, others);
        EXPECT_EQ(blockers == others, light != 0) << light;
    }
    scene.lights.erase(scene.lights.begin());
    MethodCase without("cascaded_maps", scene);
    EXPECT_EQ(without.serves().how, How::approximately);
    EXPECT_NE(without.serves().why.find("no light is directional"), std::string::npos) << without.serves().why;
}

TEST(CascadedMaps, NothingThatCastsLeavesAllLit) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(4, 4));
    scene.lights                = {directional_light({0.3f, -1, 0.2f})};
    scene.camera.eye            = {0, 3, 5};
    const PointBatch points     = primary(scene);
    const VisibilityPlane plane = answers(scene, points, "cascaded_maps");
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.asks(0, i)) {
            EXPECT_EQ(plane.s[i], 1);
        }
}

TEST(CascadedMaps, MemoryIsThatOfTheMaps) {
    const Scene scene = boxes_in_view();
    const auto bytes  = [&](const char* settings) { return Maps(scene, settings).memory_bytes(); };
    EXPECT_EQ(bytes("cascades=3,resolution=512") - bytes("cascades=1,resolution=512"), 2 * 512 * 512 * 4u);
    EXPECT_LT(bytes("cascades=1,resolution=64") - 64 * 64 * 4, 20000u);
}

TEST(CascadedMaps, BadSettingsAreRefused) {
    const auto make = [](const char* settings) {
        (void)parse_method("cascaded_maps")
            .info->make(parse_method(fmt::format("cascaded_maps:{}", settings)).settings);
    };
    const auto message = [&](const char* settings) -> std::string {
        try {
            make(settings);
        } catch (const UsageError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_NE(message("resolution=16,filter=pcf,radius=16").find("at least 72"), std::string::npos);
    EXPECT_EQ(message("resolution=72,filter=pcf,radius=16"), "");
    EXPECT_NE(message("resolution=71,filter=pcf,radius=16"), "");
    EXPECT_EQ(message("resolution=16,radius=16"), "") << "radius is of pcf alone";
    EXPECT_NE(message("cascades=0"), "");
    EXPECT_NE(message("cascades=9"), "");
    EXPECT_NE(message("lambda=1.1"), "");
    EXPECT_NE(message("blend=-0.1"), "");
    EXPECT_NE(message("splits=log"), "");
    if (8 * 4.0 * 16384 * 16384 > LightViews::half_of_memory()) {
        EXPECT_NE(message("cascades=8,resolution=16384").find("half of the machine's memory"), std::string::npos);
    }
}

}  // namespace
}  // namespace umbra
