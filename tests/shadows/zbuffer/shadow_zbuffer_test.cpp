#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/tests/support/drawn_views.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

// ---- scenes --------------------------------------------------------------------------------------------------------

constexpr float kFloor  = 4;  ///< side of the floor, in y = 0
constexpr float kSquare = 1;  ///< side of the square above it
constexpr float kHeight = 1;

/// A square parallel to a floor, both centred on the y axis. Object 0 is the floor.
Scene square_over_floor(const Light& light) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    add_mesh(scene, "square", make_plane(kSquare, kSquare), {0, kHeight, 0});
    scene.lights.push_back(light);
    scene.camera.eye = {0, 10, 0};
    return scene;
}

/// Signed distance of the floor's point from the shadow's border, in world units on the floor: inside positive.
double depth_in_shadow(const Light& light, dvec3 p) {
    // Where the segment to the light passes the square's plane, and how lengths scale from there to the floor.
    dvec3 q;
    double scale = 1;
    if (light.kind == LightKind::directional) {
        const dvec3 d(light.direction);
        q = p + d * (kHeight / d.y);
    } else {
        const dvec3 l(light.position);
        q     = p + (l - p) * (kHeight / l.y);
        scale = l.y / (l.y - kHeight);
    }
    return scale * std::min(kSquare / 2 - std::abs(q.x), kSquare / 2 - std::abs(q.z));
}

// ---- running -------------------------------------------------------------------------------------------------------

using Plane = VisibilityPlane;

Plane look_up(const Scene& scene, const PointBatch& batch, std::string_view choice) {
    MethodCase run(choice, scene);
    EXPECT_EQ(run.serves().how, How::approximately);
    run.prepare(0);
    return run.visibility(batch, 0);
}

/// Counts against the closed form, and how far from the border the farthest wrong point lies.
struct Wrong {
    int points = 0, false_shadow = 0, false_light = 0;
    double farthest = 0;
    [[nodiscard]] int all() const { return false_shadow + false_light; }
};
Wrong against_closed_form(const Light& light, std::string_view choice, int n = 300) {
    const Scene scene      = square_over_floor(light);
    const PointBatch batch = points_on(scene, 0, n);
    const Plane plane      = look_up(scene, batch, choice);
    Wrong wrong;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        EXPECT_TRUE(plane.defined(i));
        EXPECT_TRUE(plane.s[i] == 0 || plane.s[i] == 1);
        const double depth = depth_in_shadow(light, dvec3(batch.position(i)));
        const bool shadow  = depth > 0;
        ++wrong.points;
        if (shadow == (plane.s[i] == 0)) continue;
        ++(shadow ? wrong.false_light : wrong.false_shadow);
        wrong.farthest = std::max(wrong.farthest, std::abs(depth));
    }
    return wrong;
}

const Light kLights[] = {directional_light({0.3f, -1, 0.2f}),
                         directional_light({1, -1, 0}),
                         directional_light({-2, -1, 1}),
                         directional_light({0, -1, 0}),
                         point_light({0.3f, 3, 0.4f}),
                         point_light({3, 4, 1}),
                         point_light({0, 30, 0}),
                         point_light({0.1f, 1.5f, 0.1f}),
                         spot_light({1, 4, 0}, {-0.3f, -1, 0}, 40),
                         spot_light({0, 3, 0}, {0.2f, -1, 0}, 90),
                         spot_light({0.5f, 2.5f, 0}, {0, -1, 0}, 25)};

// ---- tests ---------------------------------------------------------------------------------------------------------

TEST(ShadowZBuffer, ErrsOnlyWithinASampleOfTheShadowsBorder) {
    for (const Light& light : kLights) {
        const Wrong wrong = against_closed_form(light, "shadow_zbuffer:resolution=1024");
        // A map's window is at most 3 times the floor's diagonal wide, a cube's side at most 2 heights of 30.
        const double sample = 3 * kFloor * std::sqrt(2.0) / 1024;
        EXPECT_LT(wrong.farthest, 2 * sample) << to_string(light.kind) << ' ' << light.position.y;
        EXPECT_LT(wrong.all(), wrong.points / 100) << to_string(light.kind) << ' ' << light.position.y;
    }
}

TEST(ShadowZBuffer, ErrorFallsAsOneOverResolution) {
    // Over several lights, since along one straight border all samples may happen to lie well.
    int rough = 0;
    int fine  = 0;
    for (int i = 0; i < 8; ++i) {
        const auto turn   = static_cast<float>(i);
        const Light light = directional_light({0.31f * std::cos(turn), -1, 0.31f * std::sin(turn)});
        rough += against_closed_form(light, "shadow_zbuffer:fit=scene,resolution=64").all();
        fine += against_closed_form(light, "shadow_zbuffer:fit=scene,resolution=512").all();
    }
    // 8 times the samples a side: an eighth of the wrong area, which is the border's length times a sample's width.
    EXPECT_GT(rough, 5 * fine);
    EXPECT_LT(rough, 12 * fine);
    EXPECT_GT(fine, 0);
}

TEST(ShadowZBuffer, AcneWithoutBiasNoneWithTheDefault) {
    for (const Light& light : {directional_light({0.3f, -1, 0.2f}), directional_light({-2, -1, 1}),
                               point_light({3, 4, 1}), spot_light({1, 4, 0}, {-0.3f, -1, 0}, 40)}) {
        const Wrong bare = against_closed_form(light, "shadow_zbuffer:bias=manual,fit=scene,resolution=1024");
        EXPECT_GT(bare.false_shadow, bare.points / 5) << to_string(light.kind) << ' ' << light.position.y;
        const Wrong derived = against_closed_form(light, "shadow_zbuffer:fit=scene,resolution=1024");
        EXPECT_LT(derived.false_shadow, derived.points / 200) << to_string(light.kind) << ' ' << light.position.y;
    }
}

TEST(ShadowZBuffer, OtherBiasesRemoveAcneToo) {
    const Light light = directional_light({1, -1, 0.4f});
    for (const char* bias : {"bias=manual,slope=1.5,constant=0.5", "bias=manual,normal_offset=2,constant=0.5",
                             "bias=receiver_plane", "bias=manual,constant=3"}) {
        const Wrong wrong =
            against_closed_form(light, fmt::format("shadow_zbuffer:fit=scene,resolution=1024,{}", bias));
        EXPECT_LT(wrong.all(), wrong.points / 100) << bias;
    }
}

TEST(ShadowZBuffer, HugeBiasDetachesTheShadow) {
    const Light light  = directional_light({0.3f, -1, 0.2f});
    const Wrong plain  = against_closed_form(light, "shadow_zbuffer:resolution=1024,fit=scene");
    const Wrong biased = against_closed_form(light, "shadow_zbuffer:resolution=1024,fit=scene,constant=500");
    EXPECT_LT(plain.false_light, plain.points / 200);
    EXPECT_GT(biased.false_light, biased.points / 20);
}

/// Light that falls on the floor at this cosine of the angle from its normal, from one side or another.
Light slanted_light(double cosine, double azimuth) {
    const double sine = std::sqrt(1 - cosine * cosine);
    return directional_light(vec3(dvec3(sine * std::cos(azimuth), -cosine, sine * std::sin(azimuth))));
}

TEST(ShadowZBuffer, AutomaticBiasLeavesNoAcneOnAPlaneAtAnySlope) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    scene.camera.eye       = {0, 10, 0};
    const PointBatch floor = [&] {
        scene.lights = {slanted_light(1, 0)};
        return points_on(scene, 0, 60);
    }();
    for (double cosine : {1.0, 0.5, 0.1, 1e-2, 1e-3, 1e-4})
        for (double azimuth : {0.0, 0.4, 2.5})
            for (const char* map : {"resolution=2048", "resolution=200", "depth=32", "depth=24", "depth=16",
                                    "resolution=512,filter=pcf,radius=2"}) {
                scene.lights      = {slanted_light(cosine, azimuth)};
                const Plane plane = look_up(scene, floor, fmt::format("shadow_zbuffer:fit=scene,{}", map));
                EXPECT_EQ(std::ranges::count(plane.s, 1.0f), std::ssize(plane.s)) << map << ' ' << cosine;
            }
}

TEST(ShadowZBuffer, AutomaticBiasDetachesByNoMoreThanItStates) {
    // A square just above the floor, in distances along the light: beyond 16 widths of a sample it must cast.
    for (double cosine : {1.0, 0.5, 0.1, 0.02}) {
        const Light light     = slanted_light(cosine, 0.4);
        const auto scene_with = [&](double height) {
            Scene scene;
            add_mesh(scene, "floor", make_plane(kFloor, kFloor));
            add_mesh(scene, "square", make_plane(kSquare, kSquare), {0, static_cast<float>(height), 0});
            scene.lights     = {light};
            scene.camera.eye = {0, 10, 0};
            return scene;
        };
        const Scene flat = scene_with(1e-4);
        const DrawnViews views(flat, {}, false);
        const MapView& view = views.views().at(0);
        const double width  = 2 * std::max(view.frame.half.x, view.frame.half.y) / view.map.width();

        const double height    = 16.5 * width * cosine;
        const Scene scene      = scene_with(height);
        const PointBatch floor = points_on(scene, 0, 200);
        const auto lit         = [&](const char* choice) {
            const Plane plane = look_up(scene, floor, choice);
            int n             = 0;
            for (std::size_t i = 0; i < floor.size(); ++i) {
                const dvec3 d(light.direction);
                const dvec3 q = dvec3(floor.position(i)) - d * (height / -d.y);
                n += std::max(std::abs(q.x), std::abs(q.z)) < kSquare / 4 && plane.s[i] != 0;
            }
            return n;
        };
        EXPECT_EQ(lit("shadow_zbuffer:fit=scene"), 0) << cosine;
        EXPECT_GT(lit("shadow_zbuffer:fit=scene,constant=17"), 500) << cosine;
    }
}

TEST(ShadowZBuffer, GrazingLightKeepsTheShadowOfWhatStandsOnTheFloor) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    add_mesh(scene, "box", make_box({0.5f, 1, 0.5f}), {1, 0.5f, 0});
    scene.camera.eye = {0, 10, 0};
    for (double cosine : {1e-2, 1e-3, 1e-4, 1e-5}) {
        scene.lights           = {slanted_light(cosine, kPi)};
        const PointBatch floor = points_on(scene, 0, 100);
        const Plane plane      = look_up(scene, floor, "shadow_zbuffer");
        int wrong = 0, judged = 0;
        for (std::size_t i = 0; i < floor.size(); ++i) {
            const bool behind = floor.px[i] < 0.7f && std::abs(floor.pz[i]) < 0.23f;
            const bool beside = std::abs(floor.pz[i]) > 0.27f;
            if (!behind && !beside) continue;
            ++judged;
            wrong += plane.s[i] != (behind ? 0.0f : 1.0f);
        }
        EXPECT_EQ(wrong, 0) << cosine;
        EXPECT_GT(judged, 5000);
    }
}

TEST(ShadowZBuffer, LampsFarAwayShadeAsSunsDo) {
    for (const float distance : {1e3f, 1e6f, 1e9f, 1e11f})
        for (const char* depth : {"float", "32", "24"}) {
            const Light light = point_light({0.3f * distance, distance, 0.2f * distance});
            const Wrong wrong =
                against_closed_form(light, fmt::format("shadow_zbuffer:resolution=1024,depth={}", depth), 200);
            EXPECT_LT(wrong.farthest, 6 * kFloor * std::sqrt(2.0) / 1024) << distance << ' ' << depth;
        }
}

TEST(ShadowZBuffer, ARoofThatIsNotFittedToShadesWhatIs) {
    // The largest plane, before all that the map's depth is fitted to; the box's top is the first of that.
    Scene scene;
    add_mesh(scene, "roof", make_plane(40, 40), {0, 3, 0});
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    add_mesh(scene, "box", make_box({1, 1, 1}), {0, 0.5f, 0});
    scene.camera.eye = {1, 2.5f, 1};
    for (const Light& light : {directional_light({0, -1, 0}), directional_light({0.2f, -1, 0.1f}),
                               point_light({0, 30, 0}), point_light({0.2f, 3.5f, 0})})
        for (const char* map : {"depth=float", "depth=24", "depth=16", "resolution=64", "constant=200"}) {
            scene.lights = {light};
            for (std::uint32_t object : {1u, 2u}) {
                const PointBatch points = points_on(scene, object, 12);
                const Plane plane       = look_up(scene, points, fmt::format("shadow_zbuffer:{}", map));
                EXPECT_EQ(std::ranges::count(plane.s, 0.0f), std::ssize(plane.s)) << map << ' ' << light.position.y;
            }
        }
}

TEST(ShadowZBuffer, MapsThatDoNotFitIntoMemoryAreRefused) {
    const Scene scene = square_over_floor(point_light({0.1f, 1.5f, 0.1f}));
    LightViews::Options options{.resolution = 512};
    const DrawnViews all(scene, options, false);
    ASSERT_EQ(all.views().size(), 5u);  // above the light there is nothing
    options.memory_limit = static_cast<double>(all.memory_bytes());
    EXPECT_NO_THROW(DrawnViews(scene, options, false));
    options.memory_limit -= 1;
    try {
        const DrawnViews less(scene, options, false);
        FAIL() << "five maps in the memory of less";
    } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find("resolution=512"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("4 of them"), std::string::npos) << e.what();
    }
}

TEST(ShadowZBuffer, MapsInUsedMemoryAreAsNewOnes) {
    Scene scene = square_over_floor(point_light({0.1f, 1.5f, 0.1f}));
    scene.lights.push_back(point_light({0.9f, 1.2f, -0.6f}));
    scene.lights.push_back(directional_light({0.1f, -1, 0.2f}));
    const SceneFacts facts = find_facts(scene);
    const LightViews::Options options{.resolution = 64};
    const BuiltCasters built(scene, facts, {.fit = Fit::scene});
    for (const LightId light : {0u, 1u, 2u, 1u, 0u}) {
        const LightViews used(built, light, options);  // in the memory of the one before
        const DrawnViews fresh(scene, options, false, light);
        ASSERT_EQ(used.views().size(), fresh.views().size());
        EXPECT_EQ(used.memory_bytes(), fresh.aimed.memory_bytes());
        std::size_t drawn = 0;
        for (std::size_t v = 0; v < fresh.views().size(); ++v)
            for (int y = 0; y < options.resolution; ++y)
                for (int x = 0; x < options.resolution; ++x) {
                    ASSERT_EQ(used.views()[v].map.word(x, y), fresh.views()[v].map.word(x, y)) << light << ' ' << v;
                    drawn += fresh.views()[v].map.is_empty(x, y) ? 0 : 1;
                }
        EXPECT_GT(drawn, 500u);
    }
    EXPECT_FALSE(built.spare->exchange({}).empty()) << "else no memory was used again";
}

TEST(ShadowZBuffer, NothingLeaksThroughACubesSeams) {
    // A sphere of occluders round the light, a room round both: no point of the room sees the light, every point of
    // the inner sphere does. The light is off the middle, so that the seams meet facets anyhow.
    Scene scene;
    add_mesh(scene, "room", make_box({8, 8, 8}));
    add_mesh(scene, "shade", make_sphere(1, 48, 24));
    scene.lights.push_back(point_light({0.2f, 0.1f, -0.15f}));
    scene.camera.eye      = scene.lights[0].position;  // two-sided materials turn inwards
    const PointBatch room = points_on(scene, 0, 150);
    const PointBatch ball = points_on(scene, 1, 6);
    for (const char* choice :
         {"shadow_zbuffer:resolution=256", "shadow_zbuffer:resolution=256,fit=scene",
          "shadow_zbuffer:resolution=256,filter=pcf,radius=3",
          "shadow_zbuffer:resolution=255,filter=pcf,bilinear=false",
          "shadow_zbuffer:resolution=80,filter=pcf,radius=16", "shadow_zbuffer:resolution=256,depth=16",
          "shadow_zbuffer:resolution=256,depth=24,fit=scene", "shadow_zbuffer:resolution=256,normal_offset=2"}) {
        const Plane outside = look_up(scene, room, choice);
        EXPECT_EQ(std::ranges::count(outside.s, 0.0f), std::ssize(outside.s)) << choice;
        const Plane inside = look_up(scene, ball, choice);
        EXPECT_EQ(std::ranges::count(inside.s, 1.0f), std::ssize(inside.s)) << choice;
        EXPECT_EQ(std::ranges::count(inside.answer, Answer::given), std::ssize(inside.answer)) << choice;
    }
}

TEST(ShadowZBuffer, SixteenBitsAreWorseThanFloatsWhereNearAndFarLieFarApart) {
    // A chip beside the light makes the range of depths large; a leaf lies just above the floor.
    Scene scene = square_over_floor(point_light({0.3f, 3, 0.4f}));
    add_mesh(scene, "chip", make_plane(1e-4f, 1e-4f), {0.3f, 2.99f, 0.4f});
    add_mesh(scene, "leaf", make_plane(1, 1), {1.4f, 0.001f, 1.4f});
    const PointBatch floor = points_on(scene, 0, 200);
    const auto shadowed    = [&](const char* depth) {
        const Plane plane = look_up(scene, floor, fmt::format("shadow_zbuffer:bias=receiver_plane,depth={}", depth));
        int leaf          = 0;
        for (std::size_t i = 0; i < floor.size(); ++i)
            leaf += plane.s[i] == 0 && std::max(std::abs(floor.px[i] - 1.4f), std::abs(floor.pz[i] - 1.4f)) < 0.5f;
        return leaf;
    };
    const int expected = static_cast<int>(floor.size()) / 16;  // a square metre of sixteen
    EXPECT_GT(shadowed("float"), expected * 9 / 10);
    EXPECT_GT(shadowed("32"), expected * 9 / 10);
    EXPECT_LT(shadowed("16"), expected / 2);
}

TEST(ShadowZBuffer, KernelsWiderThanAQuarterOfTheMapAreRefused) {
    EXPECT_THROW((void)parse_method("shadow_zbuffer")
                     .info->make(parse_method("shadow_zbuffer:resolution=16,filter=pcf,radius=16").settings),
                 UsageError);
    EXPECT_NO_THROW(
        (void)parse_method("shadow_zbuffer").info->make(parse_method("shadow_zbuffer:resolution=16").settings));
}

TEST(ShadowZBuffer, LightOnASurfaceAndCloseToOne) {
    for (const float height : {0.0f, 1e-6f, 1e-3f}) {
        // On the square's upper side the light sees none of the floor below; the square's own points are `away`.
        const Scene scene      = square_over_floor(point_light({0.1f, kHeight + height, 0.1f}));
        const PointBatch floor = points_on(scene, 0, 60);
        const Plane plane      = look_up(scene, floor, "shadow_zbuffer:resolution=512");
        int wrong              = 0;
        for (std::size_t i = 0; i < floor.size(); ++i) {
            EXPECT_TRUE(std::isfinite(plane.s[i]));
            wrong += height > 0 && plane.s[i] != 0;
        }
        EXPECT_EQ(wrong, 0) << height;
    }
}

TEST(ShadowZBuffer, AFloorAloneIsLit) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    scene.camera.eye = {0, 10, 0};
    for (const Light& light : kLights)
        for (const char* fit : {"casters", "scene"}) {
            scene.lights           = {light};
            const PointBatch floor = points_on(scene, 0, 40);
            const Plane plane      = look_up(scene, floor, fmt::format("shadow_zbuffer:fit={}", fit));
            EXPECT_EQ(std::ranges::count(plane.s, 1.0f), std::ssize(plane.s)) << fit;
        }
}

// A triangle without area casts nothing, and leaves a map that is fitted to it no width.
TEST(ShadowZBuffer, WindowsHaveAWidthWhateverTheyAreFittedTo) {
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "floor", {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "point", {{0, 1, 0}}, {}, {{0, 0, 0}}, 0);
    Light sun;
    sun.kind               = LightKind::directional;
    sun.direction          = {0, -1, 0};
    scene.lights           = {sun};
    const SceneFacts facts = find_facts(scene);
    const Casters all(scene, facts, true);
    const SelectedCasters casters(all, sun);
    LightFrame frame = looking_along({0, 0, 0}, {0, -1, 0}, false);
    ASSERT_TRUE(fit_to_scene(frame, casters, 1));
    EXPECT_EQ(casters.box().size(), vec3(0)) << "else the floor is fitted to, and this tests nothing";
    EXPECT_GT(frame.half.x, 0);
    EXPECT_GT(frame.half.y, 0);
}

TEST(ShadowZBuffer, FittingToCastersLosesNoShadow) {
    // A floor forty times as wide as what is on it, and reaches a little into it; walls; and what lies under it.
    Scene scene;
    add_mesh(scene, "floor", make_plane(40, 40));
    add_mesh(scene, "wall", transformed(make_plane(40, 40), mat4(0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)),
             {-20, 19.9f, 0});
    add_mesh(scene, "box", make_box({1, 1, 1}), {0, 0.4f, 0});
    add_mesh(scene, "far box", make_box({1, 1, 1}), {-17, 3, 2});
    scene.camera.eye = {5, 10, 5};
    for (const Light& light : {directional_light({-1, -0.7f, 0.2f}), directional_light({-0.4f, -1, 0.1f}),
                               point_light({6, 7, 1}), point_light({0, -9, 0})}) {
        scene.lights = {light};
        for (std::uint32_t object = 0; object < 4; ++object) {
            const PointBatch points = points_on(scene, object, object < 2 ? 300 : 40);
            const Plane casters     = look_up(scene, points, "shadow_zbuffer:fit=casters,resolution=4096");
            const Plane all         = look_up(scene, points, "shadow_zbuffer:fit=scene,resolution=4096");
            int differ              = 0;
            for (std::size_t i = 0; i < points.size(); ++i) differ += casters.s[i] != all.s[i];
            EXPECT_LE(differ, std::ssize(points.triangle) / 50) << object << ' ' << to_string(light.kind);
        }
    }
}

TEST(ShadowZBuffer, SpotsAnswerOutsideTheirConesUnlessToldNotTo) {
    const Light light      = spot_light({0, 3, 0}, {0, -1, 0}, 20);
    const Scene scene      = square_over_floor(light);
    const PointBatch floor = points_on(scene, 0, 100);
    const Plane all        = look_up(scene, floor, "shadow_zbuffer:fit=scene");
    const Plane cone       = look_up(scene, floor, "shadow_zbuffer:fit=scene,surround=0");
    EXPECT_EQ(std::ranges::count(all.answer, Answer::given), std::ssize(all.answer));
    for (std::size_t i = 0; i < floor.size(); ++i) {
        const float factor =
            spot_factor(light.spot, glm::dot(-to_light(light, floor.position(i)).direction, light.direction));
        const bool far_out = std::max(std::abs(floor.px[i]), std::abs(floor.pz[i])) > 1.2f;
        EXPECT_TRUE(factor == 0 || cone.defined(i));
        EXPECT_TRUE(!far_out || !cone.defined(i));
    }
}

TEST(ShadowZBuffer, SecondDepthNeedsNoBiasOnClosedOccluders) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    add_mesh(scene, "ball", make_sphere(0.5f, 64, 32), {0, 1, 0});
    scene.lights.push_back(directional_light({0.3f, -1, 0.2f}));
    scene.camera.eye      = {0, 10, 0};
    const PointBatch ball = points_on(scene, 1, 3);
    int all = 0, back = 0, open = 0;
    const Plane with_all  = look_up(scene, ball, "shadow_zbuffer:bias=manual,faces=all");
    const Plane with_back = look_up(scene, ball, "shadow_zbuffer:bias=manual,faces=back");
    for (std::size_t i = 0; i < ball.size(); ++i) {
        if (ball.flipped[i] || ball.facing[0][i] != Facing::front ||
            glm::dot(ball.normal(i), vec3(-0.3f, 1, -0.2f)) < 0.3f)
            continue;
        ++open;
        all += with_all.s[i] == 0;
        back += with_back.s[i] == 0;
    }
    EXPECT_GT(all, open / 5);
    EXPECT_EQ(back, 0);
    // The floor lies in the ball's shadow all the same.
    const PointBatch floor = points_on(scene, 0, 100);
    EXPECT_GT(std::ranges::count(look_up(scene, floor, "shadow_zbuffer:faces=back").s, 0.0f), 100);
}

TEST(ShadowZBuffer, FilteringGivesSharesAtTheBorderOnly) {
    const Light light      = directional_light({0.3f, -1, 0.2f});
    const Scene scene      = square_over_floor(light);
    const PointBatch floor = points_on(scene, 0, 300);
    for (const char* bilinear : {"true", "false"}) {
        const Plane plane =
            look_up(scene, floor,
                    fmt::format("shadow_zbuffer:fit=scene,resolution=512,filter=pcf,radius=2,bilinear={}", bilinear));
        const double reach = 4 * 3.5 * kFloor * std::sqrt(2.0) / 512;  // kernel and a sample, on the floor
        int between        = 0;
        for (std::size_t i = 0; i < floor.size(); ++i) {
            const double depth = depth_in_shadow(light, dvec3(floor.position(i)));
            EXPECT_TRUE(std::abs(depth) <= reach || plane.s[i] == (depth > 0 ? 0.0f : 1.0f));
            between += plane.s[i] > 0 && plane.s[i] < 1;
        }
        EXPECT_GT(between, 100);
    }
}

TEST(ShadowZBuffer, WallSquareToTheLightAtTheEndOfTheScene) {
    // Nothing lies behind the wall, and its depth is the same everywhere: rounding alone must not shadow it.
    Scene scene = square_over_floor(point_light({0.3f, 3, 0.4f}));
    add_mesh(scene, "wall", make_plane(20, 20), {0, -5, 0});
    for (const char* depth : {"float", "32", "24", "16"}) {
        const PointBatch wall = points_on(scene, 2, 30);
        const Plane plane     = look_up(scene, wall, fmt::format("shadow_zbuffer:fit=scene,depth={}", depth));
        int seen              = 0;
        for (std::size_t i = 0; i < wall.size(); ++i) {
            const vec3 p = wall.position(i);
            if (wall.flipped[i] || wall.facing[0][i] != Facing::front || std::max(std::abs(p.x), std::abs(p.z)) < 8)
                continue;
            ++seen;
            EXPECT_EQ(plane.s[i], 1) << depth;
        }
        EXPECT_GT(seen, 100);
    }
}

TEST(ShadowZBuffer, SameForAnyNumberOfThreads) {
    const Scene scene      = square_over_floor(point_light({0.1f, 1.5f, 0.1f}));
    const PointBatch floor = points_on(scene, 0, 200);
    std::vector<float> expected;
    for (int threads : {1, 3, 8}) {
        const ThreadLimit limit(threads);
        const Plane plane = look_up(scene, floor, "shadow_zbuffer:filter=pcf,depth=24");
        if (expected.empty()) expected = plane.s;
        EXPECT_EQ(plane.s, expected);
    }
}

}  // namespace
}  // namespace umbra
