// Statements of the lectures about shadows, tested with every method.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "umbra/core/render/shade.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// The fraction of the points that may be wrong, of a method that says exactly and of one that says approximately.
double allowed(const Service& service) { return service.how == How::exactly ? 0 : 0.01; }

class Lecture : public testing::TestWithParam<const MethodInfo*> {
protected:
    const MethodInfo& info() const { return *GetParam(); }
};

/// A square over a floor; the light is the caller's to place.
Scene square_over_floor(LightKind kind) {
    Scene scene;
    scene.materials.emplace_back();
    scene.width      = 160;
    scene.height     = 100;
    scene.camera.eye = {0, 5, 6};
    const Mesh floor = make_plane(8, 8), square = make_plane(2, 2);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    std::vector<vec3> raised = square.positions;
    for (vec3& p : raised) p.y += 1;
    add_object(scene, "square", raised, {}, square.triangles, 0);
    scene.lights.emplace_back();
    scene.lights[0].name += "light";
    scene.lights[0].kind = kind;
    return scene;
}

/// How many points are lit, in the umbra, and between.
struct Tally {
    std::size_t lit = 0, umbra = 0, penumbra = 0;
    [[nodiscard]] std::size_t points() const { return lit + umbra + penumbra; }
};

Tally tally(const PointBatch& points, const VisibilityPlane& plane) {
    Tally t;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (is_open(points, 0, i) && plane.defined(i))
            ++(plane.s[i] == 1 ? t.lit : plane.s[i] == 0 ? t.umbra : t.penumbra);
    return t;
}

TEST_P(Lecture, WithTheOnlyLightAtTheEyeNoShadowIsSeen) {
    const KnownScene known = known_scene("light_at_eye");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    const PointBatch points = primary(known.scene);
    run.prepare(0);
    const Tally t = tally(points, run.visibility(points, 0));
    EXPECT_GT(t.lit, 3000u);
    EXPECT_LE(static_cast<double>(t.umbra + t.penumbra), allowed(run.serves()) * static_cast<double>(t.points()));
}

TEST_P(Lecture, PointLightsGiveUmbraOnly) {
    Scene scene              = square_over_floor(LightKind::point);
    scene.lights[0].position = {0.3f, 4, 0.2f};
    MethodCase run(info(), scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    const PointBatch points = primary(scene);
    run.prepare(0);
    const VisibilityPlane plane = run.visibility(points, 0);
    const Tally t               = tally(points, plane);
    EXPECT_GT(t.umbra, 500u);
    EXPECT_GT(t.lit, 500u);
    // One that answers by irradiance interpolates between patches, and one that filters a map mixes texels: both blur
    // edges, the latter no further than the edge band.
    if (run.measures() == Measure::irradiance) {
        EXPECT_LE(t.penumbra, t.umbra / 5);
        return;
    }
    const auto band      = edge_band(points, 0, brute_force(scene, points, 0), kHardTolerance);
    const bool may_blur  = run.serves().how == How::approximately;
    std::size_t penumbra = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        penumbra +=
            is_open(points, 0, i) && plane.defined(i) && plane.s[i] > 0 && plane.s[i] < 1 && !(may_blur && band[i]);
    EXPECT_EQ(penumbra, 0u);
}

TEST_P(Lecture, WhatLiesInShadowIsStillLitByTheAmbientTerm) {
    Scene scene              = square_over_floor(LightKind::point);
    scene.lights[0].position = {0.3f, 4, 0.2f};
    scene.materials[0].k_a   = {0.25f, 0.5f, 0.125f};
    scene.materials[0].O_d   = {1, 0.5f, 0.5f};
    scene.ambient            = {0.5f, 1, 1};
    const vec3 ambient       = scene.ambient * scene.materials[0].k_a * scene.materials[0].O_d;
    MethodCase run(info(), scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    const PointBatch points = primary(scene);
    run.prepare(0);
    const std::array planes{run.visibility(points, 0)};
    const Image image    = shade(scene, points, planes);
    std::size_t in_umbra = 0, lit = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || !planes[0].defined(i)) continue;
        for (int c = 0; c < 3; ++c) {
            const float value = image.at(i, static_cast<std::size_t>(c));
            if (planes[0].s[i] == 0) {
                ASSERT_FLOAT_EQ(value, ambient[c]);
            } else {
                ASSERT_GT(value, ambient[c]);
            }
        }
        ++(planes[0].s[i] == 0 ? in_umbra : lit);
    }
    EXPECT_GT(in_umbra, 500u);
    EXPECT_GT(lit, 500u);
}

TEST_P(Lecture, ADirectionalLightIsTheLimitOfAFarPointLight) {
    const vec3 towards{-1, 2, 0.5f};
    Scene sun               = square_over_floor(LightKind::directional);
    sun.lights[0].direction = -towards;
    MethodCase run(info(), sun);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    const PointBatch points = primary(sun);
    run.prepare(0);
    const VisibilityPlane limit = run.visibility(points, 0);

    std::size_t before = points.size();
    for (const float distance : {3.0f, 30.0f, 300.0f, 1e5f}) {
        Scene lamp              = square_over_floor(LightKind::point);
        lamp.lights[0].position = distance * towards;
        MethodCase near(info(), lamp);
        const PointBatch same = primary(lamp);
        near.prepare(0);
        const VisibilityPlane plane = near.visibility(same, 0);
        std::size_t differing       = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            differing += is_open(points, 0, i) && limit.defined(i) && plane.s[i] != limit.s[i];
        EXPECT_LE(differing, before) << "at " << distance;
        if (distance == 3.0f) {
            EXPECT_GT(differing, 100u) << "near by, the two are not alike";
        }
        before = differing;
    }
    // At the last distance the shadow's outline is off by less than 1e-4: at most a pixel here and there.
    EXPECT_LE(static_cast<double>(before), 2 + allowed(run.serves()) * static_cast<double>(points.size()));
}

TEST_P(Lecture, UmbraShrinksAndPenumbraGrowsWithTheLight) {
    Tally before;
    for (const float width : {0.1f, 0.6f, 1.2f, 2.4f}) {
        Scene scene               = square_over_floor(LightKind::rectangle);
        scene.lights[0].position  = {0, 4, 0};
        scene.lights[0].edge_u    = {width, 0, 0};
        scene.lights[0].edge_v    = {0, 0, -width};
        scene.lights[0].direction = {0, 1, 0};
        MethodCase run(info(), scene);
        const Service service = run.serves();
        if (!service) GTEST_SKIP() << service.why;
        // Some methods take the light at its centre, and say so.
        if (service.why.find("centres") != std::string::npos) GTEST_SKIP() << service.why;
        const PointBatch points = primary(scene);
        run.prepare(0);
        const Tally t = tally(points, run.visibility(points, 0));
        if (before.points() > 0) {
            EXPECT_LT(t.umbra, before.umbra) << "width " << width;
            EXPECT_GT(t.penumbra, before.penumbra) << "width " << width;
        }
        before = t;
    }
}

/// A point on the inner side of a ring, and four lights: one behind its plane, one behind the ring's far side, one
/// behind another object, one in the open.
TEST_P(Lecture, AShadowHasThreeReasons) {
    Scene scene;
    scene.materials.emplace_back();
    const Mesh ring = make_torus(1, 0.3f, 96, 48), square = make_plane(0.5f, 0.5f);
    add_object(scene, "ring", ring.positions, {}, ring.triangles, 0);
    std::vector<vec3> raised = square.positions;
    for (vec3& p : raised) p += vec3(0.35f, 2, 0);
    add_object(scene, "square", raised, {}, square.triangles, 0);
    for (const vec3 position : {vec3(5, 0.1f, 0), vec3(-5, 0.1f, 0), vec3(0, 4, 0), vec3(0, -4, 0)}) {
        Light light;
        light.name     = "light" + std::to_string(scene.lights.size());
        light.position = position;
        scene.lights.push_back(light);
    }
    MethodCase run(info(), scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    TriangleId inner = 0;
    float least      = 1;
    for (TriangleId t = 0; t < scene.objects[0].triangle_count; ++t) {
        const vec3 centre = (scene.vertex(t, 0) + scene.vertex(t, 1) + scene.vertex(t, 2)) / 3.0f;
        const float off   = glm::length(centre - vec3(0.7f, 0, 0));
        if (off < least) inner = t, least = off;
    }
    PointBatch point;
    point.resize(1);
    point.eye = {-0.5f, 0, 0};
    set_point(point, 0, scene, inner, 0.3f, 0.35f);
    face_lights(point, scene);
    EXPECT_EQ(point.facing[0][0], Facing::away);

    const char* const blockers[]{"", "ring", "square", ""};
    for (LightId light = 1; light < 4; ++light) {
        ASSERT_EQ(point.facing[light][0], Facing::front);
        run.prepare(light);
        const VisibilityPlane plane = run.visibility(point, light);
        if (!plane.defined(0)) continue;
        const std::string blocker = blockers[light];
        EXPECT_EQ(plane.s[0], blocker.empty() ? 1 : 0) << "light " << light;
        if (blocker.empty()) continue;
        TriangleId who = kNoTriangle;
        run.blame(point, light, std::span(&who, 1));
        if (who != kNoTriangle) {
            EXPECT_EQ(scene.objects[scene.triangle_object[who]].name, blocker);
        }
    }
}

/// A directional light reaches half of a sphere; a point light at distance d from its centre (1 - r / d) / 2.
TEST(LitShare, OfASphereTellsTheKindOfLight) {
    Scene scene;
    scene.materials.emplace_back();
    scene.materials[0].two_sided = false;
    const Mesh ball              = make_sphere(1, 360, 180);
    add_object(scene, "ball", ball.positions, {}, ball.triangles, 0);
    const auto share = [&](const Light& light) {
        scene.lights.assign(1, light);
        PointBatch points;
        points.resize(scene.triangles.size());
        std::vector<double> area;
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
            area.push_back(glm::length(glm::cross(b - a, c - a)));
            set_point(points, t, scene, t, 0.25f, 0.25f);
        }
        face_lights(points, scene);
        double lit = 0, all = 0;
        for (std::size_t t = 0; t < area.size(); ++t) {
            all += area[t];
            lit += points.facing[0][t] == Facing::front ? area[t] : 0;
        }
        return lit / all;
    };
    Light light;
    light.name      = "sun";
    light.kind      = LightKind::directional;
    light.direction = {0.3f, -1, 0.2f};
    EXPECT_NEAR(share(light), 0.5, 0.002);
    light.kind = LightKind::point;
    for (const float d : {1.25f, 2.0f, 8.0f}) {
        light.position = d * glm::normalize(vec3(-0.3f, 1, -0.2f));
        EXPECT_NEAR(share(light), (1 - 1 / double(d)) / 2, 0.003) << "at " << d;
    }
}

INSTANTIATE_TEST_SUITE_P(EveryMethod, Lecture, testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& param) { return std::string(param.param->name); });

}  // namespace
}  // namespace umbra
