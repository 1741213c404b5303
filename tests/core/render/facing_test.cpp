#include "umbra/core/render/facing.h"

#include <gtest/gtest.h>

#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// A slanted triangle and a sphere light whose centre is the middle of an edge, exactly in the plane, moved by `lift`.
Scene slanted(vec3 lift) {
    const vec3 a(-3.125f, 0.25f, 1.75f), b(5.375f, 1.25f, 2.875f), c(0.7f, -0.9f, -4.3f);
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "slope", {a, b, c}, {}, {{0, 1, 2}}, 0);
    Light light;
    light.kind     = LightKind::sphere;
    light.radius   = 0.5f;
    light.position = 0.5f * (a + b) + lift;
    scene.lights.push_back(light);
    return scene;
}

PointBatch points_on(const Scene& scene, vec3 eye) {
    PointBatch points;
    points.eye = eye;
    points.resize(200);
    for (std::size_t i = 0; i < points.size(); ++i)
        set_point(points, i, scene, 0, 0.004f * static_cast<float>(i), 0.001f * static_cast<float>(i));
    face_lights(points, scene);
    return points;
}

std::size_t behind(const Scene& scene, vec3 eye) {
    const PointBatch points = points_on(scene, eye);
    std::size_t n           = 0;
    for (std::size_t i = 0; i < points.size(); ++i) n += centre_is_behind(scene, points, 0, i);
    return n;
}

TEST(CentreIsBehind, SaysWhichSideOfThePlaneTheCentreIsOn) {
    const vec3 above(0, 50, 0), below(0, -50, 0), step(0, 1e-6f, 0);
    EXPECT_EQ(behind(slanted(vec3(0)), above), 200u) << "in the plane";
    EXPECT_EQ(behind(slanted(vec3(0)), below), 200u) << "in the plane";
    EXPECT_EQ(behind(slanted(step), above), 0u);
    EXPECT_EQ(behind(slanted(-step), above), 200u);
    EXPECT_EQ(behind(slanted(step), below), 200u);
    EXPECT_EQ(behind(slanted(-step), below), 0u);
}

TEST(CentreIsBehind, IsNotAskedWhereThePlaneDoesNotCutTheLight) {
    EXPECT_EQ(behind(slanted({0, 5, 0}), {0, 50, 0}), 0u);
    EXPECT_EQ(behind(slanted({0, -5, 0}), {0, 50, 0}), 0u) << "all of it is behind: facing says so";
}

/// The two methods that take an area light as its centre find it behind at the same points, however near to the plane.
/// With back faces alone in the map, a triangle that the light is in front of does not shade itself.
TEST(CentreIsBehind, IsTheSameToBothMethodsThatTakeTheCentre) {
    std::size_t behind = 0;
    for (const float lift : {-1e-5f, -1e-6f, -1e-7f, 0.0f, 1e-7f, 1e-6f, 1e-5f}) {
        const Scene scene       = slanted({0, lift, 0});
        const PointBatch points = points_on(scene, {0, 50, 0});
        for (const char* choice : {"shadow_volumes", "shadow_zbuffer:faces=back"}) {
            MethodCase run(choice, scene);
            run.prepare(0);
            const VisibilityPlane plane = run.visibility(points, 0);
            for (std::size_t i = 0; i < points.size(); ++i) {
                ASSERT_EQ(points.facing[0][i], Facing::partly);
                const bool dark = centre_is_behind(scene, points, 0, i);
                behind += dark;
                EXPECT_EQ(plane.s[i], dark ? 0 : 1) << choice << ' ' << lift << ' ' << i;
            }
        }
    }
    EXPECT_GT(behind, 800u);
}

/// No method is asked for a point in a sphere light or on it: whatever lies between, S is 1. Decided exactly.
TEST(Facing, OfPointsInASphereLight) {
    const vec3 a(0), b(4, 0, 0), c(0, 0, -4);
    for (const float scale : {1.0f, 0x1p60f, 0x1p-60f}) {
        Scene scene;
        scene.materials.emplace_back().two_sided = false;
        add_object(scene, "floor", {a, scale * b, scale * c}, {}, {{0, 1, 2}}, 0);
        Light& light   = scene.lights.emplace_back();
        light.kind     = LightKind::sphere;
        light.radius   = scale;
        const float u  = 0.25f;
        const auto far = [](float x) { return std::nextafter(x, 1.0f); };
        PointBatch points;
        points.eye = {0, 9, 0};
        const std::vector<vec2> named{{0, 0},       {0.2f, 0.1f},  {u, 0},        {0, u},
                                      {far(u), 0},  {0, far(u)},   {0.15f, 0.2f}, {0.16f, 0.2f},
                                      {0.5f, 0.5f}, {u, 0x1p-40f}, {0.1f, 0.22f}};
        points.resize(named.size());
        for (std::size_t i = 0; i < named.size(); ++i) set_point(points, i, scene, 0, named[i].x, named[i].y);
        face_lights(points, scene);
        const std::vector<bool> within{true, true, true, true, false, false, false, false, false, false, true};
        for (std::size_t i = 0; i < named.size(); ++i)
            EXPECT_EQ(points.facing[0][i], within[i] ? Facing::unshadowed : Facing::partly) << i << ' ' << scale;
        VisibilityPlane plane(points.size());
        write_decided(scene, points, 0, plane.out());
        for (std::size_t i = 0; i < named.size(); ++i) EXPECT_EQ(plane.s[i], within[i] ? 1.0f : 0.0f) << i;
    }
}

/// A light flush with a face gives it nothing, whatever the light's shape; lifted by next to nothing it gives it all.
TEST(Facing, OfLightsFlushWithAFace) {
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk}) {
        for (const float lift : {0.0f, 0x1p-120f, -0x1p-120f}) {
            Scene scene;
            scene.materials.emplace_back().two_sided = false;
            add_object(scene, "floor", {{-4, 0, 4}, {4, 0, 4}, {0, 0, -8}}, {}, {{0, 1, 2}}, 0);
            Light light;
            light.kind      = kind;
            light.position  = {0, lift, 0};
            light.direction = {0, -1, 0};
            light.edge_u    = {0.3f, 0, 0.1f};
            light.edge_v    = {-0.1f, 0, 0.3f};
            light.radius    = 0.5f;
            scene.lights.push_back(light);
            EXPECT_EQ(points_on(scene, {0, 9, 0}).facing[0][0], lift > 0 ? Facing::front : Facing::away) << int(kind);
        }
    }
}

/// Corners of a rectangle light that no float can hold: its foot is behind the plane by less than their rounding.
TEST(Facing, OfARectangleByItsExactCorners) {
    Scene scene;
    scene.materials.emplace_back().two_sided = false;
    add_object(scene, "floor", {{-4, 65536, 4}, {4, 65536, 4}, {0, 65536, -8}}, {}, {{0, 1, 2}}, 0);
    Light light;
    light.kind     = LightKind::rectangle;
    light.position = {0, 65536 + 0x1p-7f, 0};
    light.edge_u   = {1, 0, 0};
    light.edge_v   = {0, 0x1.0001p-6f, 0};  // the lower corners are at 65536 - 2^-23
    scene.lights.push_back(light);
    EXPECT_EQ(points_on(scene, {0, 70000, 0}).facing[0][0], Facing::partly);
}

}  // namespace
}  // namespace umbra
