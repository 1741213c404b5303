// Antialiased pictures: pixels on an edge become means, and nothing that is measured changes.
#include "umbra/bench/lab/antialias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/lab/asked_method.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

constexpr std::string_view kBoard = R"({
    "shows": "A board over a floor under a sun.",
    "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]},
    "lights": [{"name": "sun", "type": "directional", "direction": [0.3, -1, -0.2]}],
    "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                {"name": "board", "type": "box", "size": [2, 0.1, 1], "transform": [{"rotate_y": 20}, {"translate": [0, 1, 0]}]}]
})";

Json without_times(Json record) {
    for (const char* key : {"times", "turns"}) record.erase(key);
    record["reference"].erase("times");
    for (Json& method : record["methods"]) method.erase("times"), method.erase("light_times");
    return record;
}

TEST(Antialias, SamplesAreSquares) {
    EXPECT_EQ(samples_along_side(1), 1);
    EXPECT_EQ(samples_along_side(16), 4);
    for (const int wrong : {0, -4, 2, 8, 65, 81}) EXPECT_THROW((void)samples_along_side(wrong), UsageError) << wrong;
}

/// Of 4 x 4 points of each pixel two are lit: N.L = 1 and k_d = 0.8 give 0.8 / 8.
TEST(Antialias, IsTheMeanOfAllPointsOfAPixel) {
    const TemporaryFolder folder;
    const Scene scene     = load_scene(folder.write("floor.json", R"({
        "camera": {"eye": [0, 4, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 2}, "ambient": 0,
        "lights": [{"type": "directional", "direction": [0, -1, 0]}], "objects": [{"type": "plane", "size": 8}]})"));
    const PointBatch fine = subpixel_points(RayScene(scene), scene, 6, 5, 4);
    VisibilityPlane plane(fine.size());
    for (std::size_t i = 0; i < fine.size(); ++i) plane.s[i] = i / 24 % 4 == 1 && i % 24 % 4 >= 2 ? 1.0f : 0.0f;
    const Image image = box_filtered(shade(scene, fine, std::span(&plane, 1)), 4);
    ASSERT_EQ(image.pixels(), 30u);
    for (std::size_t i = 0; i < image.pixels(); ++i) EXPECT_NEAR(image.at(i, 1), 0.1, 1e-6);
}

/// The picture changes at edges alone; planes, errors and image metrics do not.
TEST(Antialias, SmoothsEdgesAndLeavesWhatIsMeasured) {
    const TemporaryFolder folder;
    const auto scene = folder.write("board.json", kBoard);
    CompareOptions options;
    options.methods = {"ray_traced"};
    options.size    = {64, 48};
    options.repeats = {1, 0};
    Json records[2];
    Image pictures[2];
    for (int k = 0; k < 2; ++k) {
        options.out           = folder.path() / (k == 0 ? "plain" : "smooth");
        options.pixel_samples = k == 0 ? 1 : 16;
        records[k]            = without_times(to_record(compare_scene(scene, options)));
        pictures[k]           = read_image(options.out / "board" / "ray_traced.png").image;
    }
    EXPECT_EQ(records[0], records[1]);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < pictures[0].pixels(); ++i) {
        const float by = std::abs(pictures[0].at(i, 0) - pictures[1].at(i, 0));
        changed += by > 0.02f;
    }
    EXPECT_GT(changed, 40u) << "edges of the board and of its shadow";
    EXPECT_LT(changed, pictures[0].pixels() / 4) << "and nothing else";
}

/// Pictures with several points a pixel begin with the reference's; a method that errs shows its own shadows.
TEST(Antialias, SmoothPicturesShowEachMethodsShadows) {
    const TemporaryFolder folder;
    const auto scene = folder.write("board.json", kBoard);
    CompareOptions options;
    options.methods = {"shadow_zbuffer:resolution=16", "exact"};
    options.size    = {192, 144};
    options.repeats = {1, 0};
    Image pictures[2][2];  // [points a pixel][method, reference]
    for (int k = 0; k < 2; ++k) {
        options.out           = folder.path() / (k == 0 ? "plain" : "smooth");
        options.pixel_samples = k == 0 ? 1 : 4;
        static_cast<void>(compare_scene(scene, options));
        pictures[k][0] = read_image(options.out / "board" / "shadow_zbuffer.png").image;
        pictures[k][1] = read_image(options.out / "board" / "exact.png").image;
    }
    const auto differing = [](const Image& a, const Image& b) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < a.pixels(); ++i) count += std::abs(a.at(i, 0) - b.at(i, 0)) > 0.1f ? 1 : 0;
        return static_cast<double>(count);
    };
    const double plain = differing(pictures[0][0], pictures[0][1]), smooth = differing(pictures[1][0], pictures[1][1]);
    EXPECT_GT(plain, 20);
    EXPECT_GT(smooth, 0.5 * plain);
    EXPECT_LT(smooth, 3 * plain);
}

/// Where S_j is decided without a method, subpixels have it.
TEST(Antialias, WhatReceivesNoShadowsIsLit) {
    const TemporaryFolder folder;
    const PreparedScene prepared = prepare_scene(folder.write("lit.json", R"({
        "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]},
        "lights": [{"type": "directional", "direction": [0.3, -1, -0.2]}],
        "objects": [{"type": "plane", "size": 8, "receives_shadows": false},
                    {"type": "box", "size": [2, 0.1, 1], "transform": [{"translate": [0, 1, 0]}]}]})"),
                                                 {40, 30}, 4);
    const MethodRun run =
        run_method(MethodChoice(find_method("exact")), prepared.scene, prepared.facts, prepared.points);
    std::vector<std::uint32_t> ask;
    const VisibilityPlane got =
        between_centres(prepared.scene, prepared.points, run.planes[0], prepared.subpixels, 2, 0, ask);
    const auto is_floor   = [&](TriangleId t) { return t != kNoTriangle && prepared.scene.triangle_object[t] == 0; };
    const auto expect_lit = [&](const PointBatch& points, const VisibilityPlane& plane) {
        std::size_t floor = 0, lit = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_floor(points.triangle[i])) continue;
            ++floor;
            lit += plane.s[i] == 1 ? 1 : 0;
        }
        EXPECT_GT(floor, points.size() / 5);
        EXPECT_EQ(lit, floor);
    };
    expect_lit(prepared.subpixels, got);
    expect_lit(prepared.points, run.planes[0]);
    expect_lit(prepared.points, run.work->ask(prepared.points, 0));
    expect_lit(prepared.points, AskedMethod(prepared.scene, prepared.facts, std::nullopt)(prepared.points)[0]);
}

/// A board over a floor under a square light: penumbrae of some pixels, which bend at their ends.
TEST(Antialias, SmoothPenumbraeAreInterpolatedAndEdgesAsked) {
    const TemporaryFolder folder;
    const PreparedScene prepared = prepare_scene(folder.write("soft.json", R"({
        "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]},
        "lights": [{"type": "rectangle", "position": [1, 5, 0], "direction": [0, -1, 0], "size": [1, 1]}],
        "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                    {"name": "board", "type": "box", "size": [2, 0.1, 1], "transform": [{"translate": [0, 1, 0]}]}]})"),
                                                 {160, 120}, 9);
    const MethodRun run =
        run_method(MethodChoice(find_method("exact")), prepared.scene, prepared.facts, prepared.points);
    const VisibilityPlane right = run.work->ask(prepared.subpixels, 0);
    std::vector<std::uint32_t> ask;
    const VisibilityPlane got =
        between_centres(prepared.scene, prepared.points, run.planes[0], prepared.subpixels, 3, 0, ask);
    const std::set<std::uint32_t> asked(ask.begin(), ask.end());
    std::size_t interpolated = 0, in_penumbra = 0;
    for (std::uint32_t i = 0; i < right.size(); ++i) {
        if (!prepared.subpixels.asks(0, i)) {
            EXPECT_EQ(got.s[i], 0);
            EXPECT_FALSE(asked.contains(i));
        } else if (!asked.contains(i)) {
            EXPECT_NEAR(got.s[i], right.s[i], 1.0 / 64) << i;
            ++interpolated;
            in_penumbra += right.s[i] > 0.05f && right.s[i] < 0.95f ? 1 : 0;
        }
    }
    EXPECT_GT(interpolated, 2 * asked.size());
    EXPECT_GT(in_penumbra, 1000u);
    EXPECT_GT(asked.size(), 5000u) << "the board's outline, and the ends of penumbrae";
}

}  // namespace
}  // namespace umbra
