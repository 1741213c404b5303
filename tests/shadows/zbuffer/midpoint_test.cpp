// Midpoints: the depth halfway between the first and the second surface that a light sees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/tests/support/drawn_views.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

VisibilityPlane look_up(const Scene& scene, const PointBatch& points, const std::string& settings) {
    MethodCase run("shadow_zbuffer:" + settings, scene);
    run.prepare(0);
    return run.visibility(points, 0);
}

// ---- maps ----------------------------------------------------------------------------------------------------------

TEST(Midpoint, TheSecondSurfaceIsTheSecondOfAll) {
    constexpr int kSize = 64;
    // x right, y down in samples, z depth.
    const dmat4 clip = glm::transpose(
        dmat4(dvec4(2.0 / kSize, 0, 0, -1), dvec4(0, 2.0 / kSize, 0, -1), dvec4(0, 0, -1, 1), dvec4(0, 0, 0, 1)));
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (const DepthFormat format :
         {DepthFormat::float32, DepthFormat::unorm32, DepthFormat::unorm24, DepthFormat::unorm16}) {
        std::vector<vec3> positions;
        std::vector<uvec3> triangles;
        for (std::uint32_t t = 0; t < 60; ++t) {
            for (int k = 0; k < 3; ++k)
                positions.emplace_back(80 * uniform(random) - 8, 80 * uniform(random) - 8, uniform(random));
            triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
        }
        triangles.push_back(triangles[7]);  // drawn twice: one surface
        const auto drawn = [&](std::span<const uvec3> run) {
            DepthMap map(kSize, kSize, format);
            map.draw(clip, positions, std::span(&run, 1), Faces::all);
            return map;
        };
        std::vector<DepthMap> each;
        for (std::size_t t = 0; t < triangles.size(); ++t) each.push_back(drawn(std::span(triangles).subspan(t, 1)));
        const std::span<const uvec3> run(triangles);
        const DepthMap first = drawn(run);
        DepthMap second(kSize, kSize, format);
        second.draw_behind(first, clip, positions, std::span(&run, 1), Faces::all);
        int two = 0, one = 0;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                std::vector<std::uint32_t> words;
                for (const DepthMap& map : each)
                    if (!map.is_empty(x, y)) words.push_back(map.word(x, y));
                std::ranges::sort(words);
                const auto next = std::ranges::find_if(words, [&](std::uint32_t w) { return w > words.front() + 8; });
                ASSERT_EQ(second.is_empty(x, y), next == words.end()) << x << ' ' << y;
                if (next == words.end()) {
                    ++one;
                    continue;
                }
                ASSERT_EQ(second.word(x, y), *next) << x << ' ' << y;
                ++two;
            }
        EXPECT_GT(two, 1000);
        EXPECT_GT(one, 10);
    }
}

/// Two sheets, of which the lower is the wider one, and a floor.
Scene sheets(const Light& light) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(4, 4));
    add_mesh(scene, "upper", make_plane(1, 1), {0, 2, 0});
    add_mesh(scene, "lower", make_plane(2, 2), {0, 1, 0});
    scene.lights     = {light};
    scene.camera.eye = {0, 10, 0};
    return scene;
}

TEST(Midpoint, IsHalfwayInDepth) {
    for (const bool is_point : {false, true}) {
        const Scene scene = sheets(is_point ? point_light({0, 5, 0}) : directional_light({0, -1, 0}));
        for (const DepthFormat format : {DepthFormat::float32, DepthFormat::unorm24}) {
            const DrawnViews views(scene, {.resolution = 64, .format = format, .midpoints = true}, false);
            ASSERT_EQ(views.views().size(), 1u);
            const MapView& view = views.views()[0];
            EXPECT_EQ(views.memory_bytes(), [&] {
                const DrawnViews alone(scene, {.resolution = 64, .format = format}, false);
                return alone.memory_bytes() + view.map.memory_bytes();
            }());
            // Light space has its origin at the light, or in the middle of the scene, at height 1.
            const auto depth_of = [&](double height) { return is_point ? 5 - height : 1 - height; };
            int upper = 0, lower = 0, empty = 0;
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 64; ++x) {
                    if (view.map.is_empty(x, y) || view.midpoint->is_empty(x, y)) {
                        ++empty;
                        continue;
                    }
                    const double first  = view.frame.depth(view.map.nearness(x, y));
                    const double middle = view.frame.depth(view.midpoint->nearness(x, y));
                    if (std::abs(first - depth_of(2)) < 1e-3) {
                        EXPECT_NEAR(middle, depth_of(1.5), 1e-4);
                        ++upper;
                    } else {
                        EXPECT_NEAR(first, depth_of(1), 1e-4);
                        EXPECT_NEAR(middle, depth_of(0.5), 1e-4);
                        ++lower;
                    }
                }
            EXPECT_GT(upper, 100);
            EXPECT_GT(lower, 300);
            EXPECT_GT(empty, 0);
        }
    }
}

// ---- answers -------------------------------------------------------------------------------------------------------

/// A box on a floor.
Scene box_on_floor(const Light& light) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(6, 6));
    add_mesh(scene, "box", make_box({1, 1, 1}), {0, 0.5f, 0});
    scene.lights     = {light};
    scene.camera.eye = {0, 10, 0};
    return scene;
}

/// How many of the box's points that face the light lie further than a twentieth from its edges, and how many of these
/// are dark.
std::pair<int, int> acne(const Scene& scene, const std::string& settings, float margin = 0.05f) {
    const PointBatch box        = points_on(scene, 1, 60);
    const VisibilityPlane plane = look_up(scene, box, settings);
    int open = 0, dark = 0;
    for (std::size_t i = 0; i < box.size(); ++i) {
        if (box.flipped[i] || !is_open(box, 0, i)) continue;
        vec3 q = glm::abs(box.position(i) - vec3(0, 0.5f, 0));
        if (q.x + q.y + q.z - std::max({q.x, q.y, q.z}) - std::min({q.x, q.y, q.z}) > 0.5f - margin) continue;
        ++open;
        dark += plane.s[i] < 1;
    }
    return {open, dark};
}

const Light kSuns[] = {directional_light({0.3f, -1, 0.2f}), directional_light({1, -1, 0.4f}),
                       directional_light({-2, -1, 1}), point_light({3, 4, 1})};

TEST(Midpoint, AClosedBoxNeedsNoBias) {
    for (const Light& light : kSuns) {
        const Scene scene = box_on_floor(light);
        for (const char* map : {"resolution=1024", "resolution=1024,depth=24", "resolution=1024,filter=pcf"}) {
            const std::string bare  = fmt::format("{},bias=manual", map);
            const auto [open, dark] = acne(scene, bare + ",surface=midpoint");
            EXPECT_GT(open, 1000);
            EXPECT_EQ(dark, 0) << map << ' ' << to_string(light.kind) << light.direction.x;
            EXPECT_GT(acne(scene, bare).second, open / 5) << map << ' ' << to_string(light.kind) << light.direction.x;
        }
        // With the receiver's plane, not even where the box has no depth, along its silhouette.
        for (const char* bias : {"auto", "receiver_plane"})
            EXPECT_EQ(acne(scene, fmt::format("surface=midpoint,bias={}", bias), 0).second, 0) << bias;
    }
}

TEST(Midpoint, TheShadowOfABoxIsWhereItWas) {
    for (const Light& light : kSuns) {
        const Scene scene      = box_on_floor(light);
        const PointBatch floor = points_on(scene, 0, 200);
        const auto first       = look_up(scene, floor, "resolution=1024,surface=first").s;
        for (const char* bias : {"auto", "manual"}) {
            const auto s = look_up(scene, floor, fmt::format("resolution=1024,surface=midpoint,bias={}", bias)).s;
            int differ   = 0;
            for (std::size_t i = 0; i < s.size(); ++i) differ += s[i] != first[i];
            EXPECT_LT(differ, std::ssize(s) / 400) << bias;
            EXPECT_GT(std::ranges::count(s, 0.0f), 500);
        }
    }
}

TEST(Midpoint, ASheetAloneHasTheBiasThatIsSet) {
    // The floor is not drawn: the sheet is the one surface, and must cast.
    Scene scene;
    add_mesh(scene, "floor", make_plane(6, 6));
    add_mesh(scene, "sheet", make_plane(1, 1), {0, 1, 0});
    scene.lights           = {directional_light({1, -1, 0.4f})};
    scene.camera.eye       = {0, 10, 0};
    const PointBatch floor = points_on(scene, 0, 150), sheet = points_on(scene, 1, 60);
    for (const char* bias : {"auto", "receiver_plane", "manual", "manual,constant=3"})
        for (const PointBatch* points : {&floor, &sheet}) {
            const auto first = look_up(scene, *points, fmt::format("bias={}", bias)).s;
            EXPECT_EQ(look_up(scene, *points, fmt::format("bias={},surface=midpoint", bias)).s, first) << bias;
        }
    EXPECT_GT(std::ranges::count(look_up(scene, floor, "surface=midpoint").s, 0.0f), 300);
    // So that without one it has acne, as it has without midpoints.
    const auto bare = look_up(scene, sheet, "bias=manual,surface=midpoint").s;
    EXPECT_GT(std::ranges::count(bare, 0.0f), std::ssize(bare) / 5);
}

TEST(Midpoint, APlateCastsOntoWhatLiesCloseBehindIt) {
    // All in all less than what bias=auto moves points by.
    Scene scene;
    add_mesh(scene, "floor", make_plane(4, 4));
    add_mesh(scene, "plate", make_box({2, 0.00015f, 2}), {0, 0.000175f, 0});
    scene.camera.eye = {0, 10, 0};
    int auto_leaks = 0, midpoint_leaks = 0;
    for (const Light& light : {directional_light({8, -1, 0.3f}), directional_light({5, -1, 1})}) {
        scene.lights           = {light};
        const PointBatch floor = points_on(scene, 0, 200);
        const auto first       = look_up(scene, floor, "fit=scene").s;
        const auto midpoint    = look_up(scene, floor, "fit=scene,surface=midpoint").s;
        for (std::size_t i = 0; i < floor.size(); ++i) {
            // Where the segment to the light passes the plate's middle height, well inside.
            const dvec3 d(light.direction);
            const dvec3 q = dvec3(floor.position(i)) + d * (0.000175 / d.y);
            if (std::max(std::abs(q.x), std::abs(q.z)) > 0.9) continue;
            auto_leaks += first[i] > 0;
            midpoint_leaks += midpoint[i] > 0;
        }
    }
    EXPECT_GT(auto_leaks, 1000);
    EXPECT_EQ(midpoint_leaks, 0);
}

TEST(Midpoint, WhatIsNotFittedToShadesWhatIs) {
    // The largest plane, before all that the map's depth is fitted to.
    Scene scene;
    add_mesh(scene, "roof", make_plane(40, 40), {0, 3, 0});
    add_mesh(scene, "floor", make_plane(4, 4));
    add_mesh(scene, "box", make_box({1, 1, 1}), {0, 0.5f, 0});
    scene.camera.eye = {1, 2.5f, 1};
    for (const Light& light : {directional_light({0, -1, 0}), point_light({0.2f, 3.5f, 0})}) {
        scene.lights = {light};
        for (std::uint32_t object : {1u, 2u}) {
            const auto s = look_up(scene, points_on(scene, object, 12), "surface=midpoint").s;
            EXPECT_EQ(std::ranges::count(s, 0.0f), std::ssize(s)) << object;
        }
    }
}

TEST(Midpoint, MemoryForBothMapsIsAskedFor) {
    const Scene scene = box_on_floor(directional_light({1, -1, 0.4f}));
    LightViews::Options options{.resolution = 256, .midpoints = true};
    options.memory_limit = static_cast<double>(DrawnViews(scene, options).memory_bytes());
    EXPECT_NO_THROW(DrawnViews(scene, options));
    options.memory_limit -= 1;
    EXPECT_THROW(DrawnViews(scene, options), UsageError);
}

TEST(Midpoint, SameForAnyNumberOfThreadsAndInUsedMemory) {
    const Scene scene      = box_on_floor(point_light({0.1f, 2.5f, 0.1f}));
    const PointBatch floor = points_on(scene, 0, 100);
    const auto expected    = look_up(scene, floor, "surface=midpoint,resolution=256,filter=pcf").s;
    for (int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(look_up(scene, floor, "surface=midpoint,resolution=256,filter=pcf").s, expected);
    }
    MethodCase again("shadow_zbuffer:surface=midpoint,resolution=256,filter=pcf", scene);
    again.prepare(0);
    again.aim(0);
    EXPECT_EQ(again.visibility(floor, 0).s, expected);
}

}  // namespace
}  // namespace umbra
