// Predicates, surface points and facing: signs against exact expectations at the edge of rounding.
#include "umbra/core/render/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "umbra/core/base/predicates.h"

namespace umbra {
namespace {

TEST(Predicates, PlaneThroughPointsHasNoSide) {
    // d = a + s (b - a) + t (c - a) with dyadic s, t: representable, so exactly in the plane.
    const vec3 a(0.5f, 1.25f, -3), b(2.5f, 1.75f, 1), c(-1.5f, 4.25f, 2);
    const vec3 d = a + 0.5f * (b - a) + 0.25f * (c - a);
    EXPECT_EQ(side_of_plane(a, b, c, d), 0);
    const vec3 n = glm::cross(b - a, c - a);
    for (int k = 0; k < 3; ++k) {
        vec3 up = d, down = d;
        up[k]   = std::nextafter(d[k], n[k] > 0 ? kInfinity : -kInfinity);
        down[k] = std::nextafter(d[k], n[k] > 0 ? -kInfinity : kInfinity);
        EXPECT_EQ(side_of_plane(a, b, c, up), 1) << k;
        EXPECT_EQ(side_of_plane(a, b, c, down), -1) << k;
    }
}

TEST(Predicates, TurningTheTriangleTurnsTheSign) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> u(-1, 1);
    auto point = [&](float scale) { return scale * vec3(u(random), u(random), u(random)); };
    for (int i = 0; i < 2000; ++i) {
        const float far  = std::pow(10.0f, static_cast<float>(i % 12));
        const vec3 shift = point(far);
        const vec3 a = shift + point(1), b = shift + point(1), c = shift + point(1), q = shift + point(1e-3f);
        const int s = side_of_plane(a, b, c, q);
        EXPECT_EQ(side_of_plane(b, c, a, q), s);
        EXPECT_EQ(side_of_plane(b, a, c, q), -s);
        EXPECT_EQ(side_of_plane(a, b, q, c), -s);
        EXPECT_EQ(side_of_direction(a, b, c, q), -side_of_direction(a, b, c, -q));
    }
}

TEST(Predicates, DirectionInThePlaneHasNoSide) {
    EXPECT_EQ(side_of_direction(vec3(1e6f, 3, 1), vec3(1e6f + 1, 3, 1), vec3(1e6f, 3, 2), vec3(0.3f, 0, 0.7f)), 0);
    EXPECT_EQ(side_of_direction(vec3(1e6f, 3, 1), vec3(1e6f + 1, 3, 1), vec3(1e6f, 3, 2), vec3(0.3f, 1e-38f, 0.7f)),
              -1);
}

Scene one_triangle(bool two_sided) {
    Scene scene;
    scene.materials.emplace_back().two_sided = two_sided;
    add_object(scene, "triangle", {vec3(0), vec3(1, 0, 0), vec3(0, 0, -1)}, {}, {uvec3(0, 1, 2)}, 0);  // normal +y
    return scene;
}

TEST(Points, BarycentricsAreClampedIntoTheTriangle) {
    const Scene scene = one_triangle(true);
    PointBatch batch;
    batch.eye = vec3(0, 3, 0);
    batch.resize(1);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> u(-0.1f, 1.1f);
    for (int i = 0; i < 10000; ++i) {
        set_point(batch, 0, scene, 0, i % 3 ? u(random) : std::ldexp(1.0f, -(i % 60)), u(random));
        ASSERT_GE(batch.u[0], 0.0f);
        ASSERT_GE(batch.v[0], 0.0f);
        // Floats near 1 are multiples of 2^-24: with u below that, only a smaller v keeps the sum at most 1.
        ASSERT_LE(static_cast<long double>(batch.u[0]) + static_cast<long double>(batch.v[0]), 1.0L);
    }
    set_point(batch, 0, scene, 0, 0x1p-60f, 1.0f);
    EXPECT_LT(batch.v[0], 1.0f);
}

TEST(Points, TwoSidedNormalsTurnToTheEye) {
    for (const bool two_sided : {true, false}) {
        Scene scene                          = one_triangle(two_sided);
        scene.lights.emplace_back().position = vec3(0.2f, -2, -0.2f);
        PointBatch batch;
        batch.eye = vec3(0.2f, -1, -0.2f);  // below, where the winding looks clockwise
        batch.resize(1);
        set_point(batch, 0, scene, 0, 0.25f, 0.25f);
        face_lights(batch, scene);
        EXPECT_EQ(batch.normal(0), two_sided ? vec3(0, -1, 0) : vec3(0, 1, 0));
        EXPECT_EQ(batch.flipped[0], two_sided);
        EXPECT_EQ(batch.facing[0][0], two_sided ? Facing::front : Facing::away);
    }
}

TEST(Points, LightInThePlaneIsAway) {
    Scene scene                          = one_triangle(true);
    scene.lights.emplace_back().position = vec3(5, 0, 1);
    scene.lights.emplace_back().kind     = LightKind::directional;
    scene.lights.back().direction        = vec3(1, 0, -2);
    scene.lights.emplace_back().position = vec3(5, 1e-30f, 1);
    PointBatch batch;
    batch.eye = vec3(0, 3, 0);
    batch.resize(1);
    set_point(batch, 0, scene, 0, 0.25f, 0.25f);
    face_lights(batch, scene);
    EXPECT_EQ(batch.facing[0][0], Facing::away);
    EXPECT_EQ(batch.facing[1][0], Facing::away);
    EXPECT_EQ(batch.facing[2][0], Facing::front);
}

TEST(Points, AreaLightsAreCutByThePlane) {
    Scene scene = one_triangle(true);
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere})
        for (const float height : {2.0f, 0.25f, -2.0f}) {
            Light& light    = scene.lights.emplace_back();
            light.kind      = kind;
            light.position  = vec3(3, height, 0);
            light.direction = vec3(1, 0, 0);  // upright, so that height counts
            light.edge_u    = vec3(0, 1, 0);
            light.edge_v    = vec3(0, 0, 1);
            light.radius    = 0.5f;
        }
    PointBatch batch;
    batch.eye = vec3(0, 3, 0);
    batch.resize(1);
    set_point(batch, 0, scene, 0, 0.25f, 0.25f);
    face_lights(batch, scene);
    for (std::size_t k = 0; k < 9; k += 3) {
        EXPECT_EQ(batch.facing[k][0], Facing::front);
        EXPECT_EQ(batch.facing[k + 1][0], Facing::partly);
        EXPECT_EQ(batch.facing[k + 2][0], Facing::away);
    }
}

/// A disk reaches along a normal by its radius times the sine of the angle to its own: not at all where it lies flat.
TEST(Points, AFlatDiskIsNotCutByThePlaneBelowIt) {
    Scene scene = one_triangle(true);
    for (const vec3 direction : {vec3(0, -1, 0), vec3(1, 0, 0), vec3(3, -4, 0)}) {
        Light& light    = scene.lights.emplace_back();
        light.kind      = LightKind::disk;
        light.position  = vec3(3, 0.35f, 0);
        light.direction = direction;
        light.radius    = 0.5f;  // the last one reaches 0.3
    }
    PointBatch batch;
    batch.eye = vec3(0, 3, 0);
    batch.resize(1);
    set_point(batch, 0, scene, 0, 0.25f, 0.25f);
    face_lights(batch, scene);
    EXPECT_EQ(batch.facing[0][0], Facing::front);
    EXPECT_EQ(batch.facing[1][0], Facing::partly);
    EXPECT_EQ(batch.facing[2][0], Facing::front);
}

TEST(Camera, ProjectInvertsTheEyeRay) {
    Camera camera;
    camera.eye    = vec3(1e5f, 2, 3);
    camera.target = vec3(1e5f, 0, 0);
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        camera.projection   = projection;
        const CameraFrame f = frame(camera, 640, 360);
        for (const dvec2 pixel : {dvec2(0.5, 0.5), dvec2(320, 180), dvec2(639.5, 12.25)}) {
            const dvec3 p = f.ray_origin(pixel.x, pixel.y) + 7.0 * f.ray_direction(pixel.x, pixel.y);
            const dvec3 q = f.project(p);
            EXPECT_NEAR(q.x, pixel.x, 1e-7);
            EXPECT_NEAR(q.y, pixel.y, 1e-7);
            EXPECT_NEAR(q.z, 7, 1e-9);
        }
    }
}

TEST(Lights, ZachmannSpotIsNeverNegative) {
    // Its printed form is: with n = 8 and a cut-off of 45 degrees, cos^8 falls below cos(45) well inside the cone.
    Spot spot{SpotFalloff::zachmann, 8, 0.7853982f, 0};
    EXPECT_FLOAT_EQ(spot_factor(spot, 1), 1);
    EXPECT_LT(std::pow(std::cos(0.6f), 8.0f), std::cos(0.7853982f));
    EXPECT_EQ(spot_factor(spot, std::cos(0.6f)), 0);
    spot.exponent = 1;
    EXPECT_GT(spot_factor(spot, std::cos(0.6f)), 0);
    EXPECT_EQ(spot_factor(spot, std::cos(0.8f)), 0);
}

TEST(Lights, AttenuationIsFiniteAndMonotone) {
    for (const bool clamp : {true, false}) {
        const Attenuation a{0, 0, 1, clamp};
        float last = kInfinity;
        for (float d = 0; d < 1e20f; d = d == 0 ? 1e-30f : d * 3) {
            const float f = attenuation_factor(a, d);
            ASSERT_TRUE(std::isfinite(f)) << d;
            ASSERT_LE(f, last) << d;
            last = f;
        }
        EXPECT_FLOAT_EQ(attenuation_factor(a, 2), 0.25f);
        EXPECT_FLOAT_EQ(attenuation_factor(a, 0.5f), clamp ? 1.0f : 4.0f);
    }
}

}  // namespace
}  // namespace umbra
