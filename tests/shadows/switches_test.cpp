// What an object takes part in: every method on three cubes over a floor, of which the first casts no shadow, the
// second receives none, and the eye does not see the third.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "umbra/core/render/ask_visibility.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// Lights far away in the direction in which the sun of the scene stands.
Scene cubes(LightKind kind) {
    Scene scene = known_scene("switched_off").scene;
    scene.width = 192, scene.height = 128;
    Light& light = scene.lights[0];
    light.kind   = kind;
    if (kind == LightKind::directional) return scene;
    light.position  = {-40, 40, 0};
    light.direction = vec3(glm::normalize(dvec3(-1, 1, 0)));
    light.edge_u = {0, 0, 0.05f}, light.edge_v = {0.03f, 0.03f, 0};
    return scene;
}

constexpr LightKind kKinds[] = {LightKind::directional, LightKind::point, LightKind::rectangle};

/// Of a plane, over the floor well inside where the shadow of the cube at z falls: x from -1 to 1, z by a half to each
/// side.
struct Floor {
    std::size_t points = 0;
    double sum         = 0;
    [[nodiscard]] double mean() const { return sum / static_cast<double>(points); }
};
Floor floor_behind(const Scene& scene, const PointBatch& points, const VisibilityPlane& plane, float z) {
    Floor floor;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const vec3 p = points.position(i);
        if (points.triangle[i] == kNoTriangle || scene.triangle_object[points.triangle[i]] != 0) continue;
        if (std::abs(p.x) > 0.75f || std::abs(p.z - z) > 0.25f || !plane.defined(i)) continue;
        ++floor.points;
        floor.sum += static_cast<double>(plane.s[i]);
    }
    return floor;
}

class Switches : public testing::TestWithParam<const MethodInfo*> {};

TEST_P(Switches, LeaveOutCastersAndReceivers) {
    for (const LightKind kind : kKinds) {
        const Scene scene = cubes(kind);
        MethodCase run(*GetParam(), scene);
        if (!run.verdict()) continue;
        const PointBatch points = primary(scene);
        run.prepare(0);
        const VisibilityPlane plane = run.visibility(points, 0);
        const Floor first = floor_behind(scene, points, plane, -1.5f), second = floor_behind(scene, points, plane, 0),
                    third = floor_behind(scene, points, plane, 1.5f);
        for (const Floor& floor : {first, second, third}) ASSERT_GT(floor.points, 10u) << to_string(kind);
        EXPECT_GT(first.mean(), 0.95) << to_string(kind) << ": it casts no shadow";
        EXPECT_LT(second.mean(), 0.05) << to_string(kind) << ": it casts one, though it receives none";
        EXPECT_LT(third.mean(), 0.05) << to_string(kind) << ": it casts one, though it is not seen";
        std::size_t receives_none = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points.triangle[i] == kNoTriangle) continue;
            const std::uint32_t object = scene.triangle_object[points.triangle[i]];
            EXPECT_NE(object, 3u) << "the eye does not see it";
            if (object != 2 || points.facing[0][i] != Facing::unshadowed) continue;
            ++receives_none;
            ASSERT_EQ(plane.s[i], 1) << to_string(kind);
            ASSERT_EQ(plane.answer[i], Answer::given);
            ASSERT_EQ(plane.half_width[i], 0);
        }
        EXPECT_GT(receives_none, 20u) << to_string(kind);
    }
}

/// Had all switches been on, each of the answers above would be another one.
TEST_P(Switches, ChangeNothingWhereTheyAreOn) {
    Scene scene = cubes(LightKind::directional);
    for (Object& object : scene.objects) object.switches = {};
    MethodCase run(*GetParam(), scene);
    if (!run.verdict()) GTEST_SKIP() << "it serves area lights alone";
    const PointBatch points = primary(scene);
    run.prepare(0);
    const VisibilityPlane plane = run.visibility(points, 0);
    EXPECT_LT(floor_behind(scene, points, plane, -1.5f).mean(), 0.05);
    std::size_t top = 0, shaded = 0, third = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const std::uint32_t object = scene.triangle_object[points.triangle[i]];
        third += object == 3 ? 1 : 0;
        if (object != 2 || points.ny[i] < 0.9f || !plane.defined(i)) continue;
        ++top;
        shaded += plane.s[i] < 0.5f ? 1 : 0;
    }
    EXPECT_GE(shaded, top * 8 / 10) << "the board is over it";
    EXPECT_GT(third, 20u);
}

INSTANTIATE_TEST_SUITE_P(All, Switches, testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& param) { return std::string(param.param->name); });

TEST(ObjectSwitches, DecideFacingsWithoutMethods) {
    for (const LightKind kind : kKinds) {
        Scene scene             = cubes(kind);
        const PointBatch points = primary(scene);
        PointBatch again        = points;
        face_lights(again, scene);
        EXPECT_EQ(again.facing, points.facing) << "of a raster, and of a list";
        for (Object& object : scene.objects) object.switches.receives_shadows = true;
        face_lights(again, scene);
        const std::vector<VisibilityPlane> lit = lit_everywhere(scene, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool is_second = points.triangle[i] != kNoTriangle && scene.triangle_object[points.triangle[i]] == 2;
            const Facing without = again.facing[0][i];
            EXPECT_EQ(points.facing[0][i], is_second && is_asked(without) ? Facing::unshadowed : without);
            EXPECT_EQ(points.asks(0, i), is_asked(without) && !is_second);
            EXPECT_EQ(points.faces(0, i), is_asked(without));
            EXPECT_EQ(points.decided(0, i), is_second && is_asked(without) ? 1 : 0);
            EXPECT_EQ(lit[0].s[i], is_asked(without) ? 1 : 0);
        }
    }
}

/// Under each rule, opaque and stained; and what is decided on it.
TEST(ObjectSwitches, WhatCastsNoShadowNeitherBlocksNorFilters) {
    using enum TransparentOccluders;
    for (const TransparentOccluders rule : {ignore, block, multiply})
        for (const float opacity : {1.0f, 0.5f}) {
            Scene scene       = cubes(LightKind::directional);
            scene.transparent = rule;
            scene.materials.resize(2);
            scene.materials[1].opacity         = opacity;
            scene.materials[1].transmit_colour = {1, 0.5f, 0.25f};
            scene.objects[1].material          = 1;
            const TriangleId t                 = scene.objects[1].first_triangle;
            EXPECT_FALSE(scene.blocks(t));
            EXPECT_EQ(scene.lets_through(t), vec3(1));
            EXPECT_FALSE(find_facts(scene).has_filters);
            EXPECT_FALSE(find_facts(scene).has_coloured_filters);
            scene.objects[1].switches.casts_shadows = true;
            const bool filters                      = rule == multiply && opacity < 1;
            EXPECT_EQ(scene.blocks(t), rule == block || opacity == 1);
            EXPECT_EQ(find_facts(scene).has_filters, filters);
            EXPECT_EQ(find_facts(scene).has_coloured_filters, filters);
        }
}

/// S_j of three channels, where others let coloured light through.
TEST(ObjectSwitches, AreDecidedPerChannel) {
    const Scene scene       = cubes(LightKind::directional);
    const PointBatch points = primary(scene);
    VisibilityPlane plane(points.size(), true);
    write_decided(scene, points, 0, plane.out());
    std::size_t decided = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        decided += points.facing[0][i] == Facing::unshadowed ? 1 : 0;
        EXPECT_EQ(plane.s[i], points.decided(0, i));
        EXPECT_EQ(plane.colour[i], vec3(points.decided(0, i)));
    }
    EXPECT_GT(decided, 20u);
}

}  // namespace
}  // namespace umbra
