// Shading models against values worked out by hand, and against one another where they must agree.
#include "umbra/bench/studies/light/shading_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/render/shade.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/lit_everywhere.h"

namespace umbra {
namespace {

/// A diffuse white material under a sun from straight above.
Scene white_scene() {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].k_a = vec3(0), scene.materials[0].k_d = vec3(1);
    Light sun;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {0, -1, 0};
    scene.lights.push_back(sun);
    scene.width = 64, scene.height = 48;
    return scene;
}

/// One triangle with a normal of its own at each corner, seen at an angle.
Scene bent_triangle() {
    Scene scene = white_scene();
    add_object(scene, "sheet", {{-2, 0, 1}, {2, 0, 1}, {0, 0, -3}},
               {glm::normalize(vec3(-1, 1, 0)), glm::normalize(vec3(2, 1, 0)), glm::normalize(vec3(0, 1, -1))},
               {{0, 1, 2}}, 0);
    scene.camera.eye = {0, 1.5f, 3}, scene.camera.target = {0, 0, -1};
    return scene;
}

std::size_t surfaces(const PointBatch& points) {
    return points.size() - static_cast<std::size_t>(std::ranges::count(points.triangle, kNoTriangle));
}

/// A ball over a floor, a point light, highlights.
Scene ball() {
    Scene scene            = white_scene();
    scene.materials[0].k_s = vec3(0.5f), scene.materials[0].shininess = 20;
    const Mesh sphere = make_sphere(1, 16, 8), floor = make_plane(8, 8);
    add_object(scene, "ball", sphere.positions, sphere.normals, sphere.triangles, 0);
    std::vector<vec3> low = floor.positions;
    for (vec3& p : low) p.y -= 1;
    add_object(scene, "floor", low, {}, floor.triangles, 0);
    Light lamp;
    lamp.name = "lamp", lamp.position = {2, 3, 2};
    scene.lights.push_back(lamp);
    scene.camera.eye = {0, 2, 5};
    return scene;
}

TEST(ShadingModels, PhongIsTheSumOfEveryPixel) {
    const Scene scene         = ball();
    const PointBatch points   = points_of(scene);
    const ShadedPicture phong = shaded(ShadingModel::phong, scene, points);
    const Image sum           = shade(scene, points, lit_everywhere(scene, points));
    EXPECT_EQ(phong.linear.data, sum.data);
    EXPECT_EQ(phong.evaluations, surfaces(points));
}

/// One value a face: that of the middle between its corners.
TEST(ShadingModels, FlatIsTheSumAtTheMiddleOfTheFace) {
    Scene scene          = white_scene();
    scene.lights[0].kind = LightKind::point, scene.lights[0].position = {1.5f, 2, 0.5f};
    add_object(scene, "triangle", {{-2, 0, 2}, {2, 0, 2}, {-1, 0, -3}}, {}, {{0, 1, 2}}, 0);
    scene.camera.eye        = {0, 4, 4};
    const PointBatch points = points_of(scene);
    const Image flat        = shaded(ShadingModel::flat, scene, points).linear;
    const dvec3 to_lamp     = dvec3(scene.lights[0].position) - dvec3(-1, 0, 1) / 3.0;
    ASSERT_GT(surfaces(points), 100u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        ASSERT_NEAR(flat.at(i, 0), to_lamp.y / glm::length(to_lamp), 1e-6);
    }
}

/// With light and viewer at infinity nothing in the sum changes over a face.
TEST(ShadingModels, FlatIsPhongWhereLightAndViewerAreAtInfinity) {
    Scene scene            = white_scene();
    scene.materials[0].k_s = vec3(0.5f), scene.materials[0].shininess = 5;
    scene.lights[0].direction = {-1, -2, -1.5f};
    const Mesh box            = make_box({2, 1, 1});
    add_object(scene, "box", box.positions, {}, box.triangles, 0);
    scene.camera.eye = {3, 2, 4}, scene.camera.projection = Projection::orthographic, scene.camera.height = 3;
    const PointBatch points = points_of(scene);
    ASSERT_GT(surfaces(points), 500u);
    const ShadedPicture flat = shaded(ShadingModel::flat, scene, points);
    EXPECT_EQ(flat.linear.data, shaded(ShadingModel::phong, scene, points).linear.data);
    EXPECT_EQ(flat.evaluations, 6u);  // triangles of three visible faces

    scene.lights[0].kind = LightKind::point, scene.lights[0].position = {2, 3, 2};
    const PointBatch near = points_of(scene);
    EXPECT_NE(shaded(ShadingModel::flat, scene, near).linear.data,
              shaded(ShadingModel::phong, scene, near).linear.data);
}

/// Corner values are the heights of the normals: the sun is straight above.
TEST(ShadingModels, GouraudInterpolatesValuesAndPhongNormals) {
    const Scene scene       = bent_triangle();
    const PointBatch points = points_of(scene);
    const Image gouraud     = shaded(ShadingModel::gouraud, scene, points).linear,
                phong       = shaded(ShadingModel::phong, scene, points).linear;
    const double c[]        = {1 / std::sqrt(2.0), 1 / std::sqrt(5.0), 1 / std::sqrt(2.0)};
    ASSERT_GT(surfaces(points), 300u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const double u = points.u[i], v = points.v[i], w = 1 - u - v;
        EXPECT_NEAR(gouraud.at(i, 0), w * c[0] + u * c[1] + v * c[2], 1e-6);
        const dvec3 n = w * dvec3(scene.normals[0]) + u * dvec3(scene.normals[1]) + v * dvec3(scene.normals[2]);
        EXPECT_NEAR(phong.at(i, 1), n.y / glm::length(n), 1e-6);
    }
    EXPECT_EQ(shaded(ShadingModel::gouraud, scene, points).evaluations, 3u);
}

/// Weights that are linear in the picture, from the corners' places in it.
TEST(ShadingModels, ScreenLinearGouraudIsLinearInPixels) {
    const Scene scene       = bent_triangle();
    const PointBatch points = points_of(scene);
    const Image screen      = shaded(ShadingModel::gouraud_screen, scene, points).linear,
                gouraud     = shaded(ShadingModel::gouraud, scene, points).linear;
    const double c[]        = {1 / std::sqrt(2.0), 1 / std::sqrt(5.0), 1 / std::sqrt(2.0)};
    dvec2 at[3];
    for (int k = 0; k < 3; ++k) at[k] = dvec2(points.raster->project(dvec3(scene.vertex(0, k))));
    const auto area = [](dvec2 p, dvec2 q, dvec2 r) { return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x); };
    double apart    = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const std::size_t row = i / 64;
        const dvec2 pixel(static_cast<double>(i % 64) + 0.5, static_cast<double>(row) + 0.5);
        const double whole = area(at[0], at[1], at[2]), u = area(at[0], pixel, at[2]) / whole,
                     v = area(at[0], at[1], pixel) / whole;
        EXPECT_NEAR(screen.at(i, 0), (1 - u - v) * c[0] + u * c[1] + v * c[2], 1e-5);
        apart = std::max(apart, std::abs(double(screen.at(i, 0)) - double(gouraud.at(i, 0))));
    }
    EXPECT_GT(apart, 0.02);
}

/// A corner behind the eye has no place in the picture: the triangle is interpolated in space.
TEST(ShadingModels, ScreenLinearGouraudLeavesTrianglesThatPassTheEye) {
    Scene scene             = bent_triangle();
    scene.camera.eye        = {0, 0.5f, -0.5f};
    scene.camera.target     = {0, 0.3f, -3};
    const PointBatch points = points_of(scene);
    ASSERT_GT(surfaces(points), 200u);
    EXPECT_EQ(shaded(ShadingModel::gouraud_screen, scene, points).linear.data,
              shaded(ShadingModel::gouraud, scene, points).linear.data);
}

TEST(ShadingModels, EverySecondPixelIsTheMeanOfItsNeighbours) {
    const Scene scene          = ball();
    const PointBatch points    = points_of(scene);
    const ShadedPicture second = shaded(ShadingModel::every_second, scene, points),
                        phong  = shaded(ShadingModel::phong, scene, points);
    EXPECT_LT(second.evaluations, surfaces(points) * 55 / 100);
    EXPECT_GT(second.evaluations, surfaces(points) * 50 / 100);
    std::size_t between = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 64 % 2 == 0) {
            EXPECT_EQ(second.linear.at(i, 0), phong.linear.at(i, 0));
        } else if (second.linear.at(i, 0) != phong.linear.at(i, 0)) {
            EXPECT_NEAR(second.linear.at(i, 0), (phong.linear.at(i - 1, 0) + phong.linear.at(i + 1, 0)) / 2, 1e-6);
            ++between;
        }
    }
    EXPECT_GT(between, 100u);
}

/// Equal normals that lean over the edge: linear interpolation sees a flat edge, quadratic one the wave.
TEST(QuadraticNormal, SeesTheWaveBetweenEqualNormals) {
    const dvec3 n = glm::normalize(dvec3(1, 1, 0));
    const std::array<dvec3, 3> corners{dvec3(0), dvec3(1, 0, 0), dvec3(0, 0, 1)}, normals{n, n, n};
    // n(1/2) = n - b / 4 with b = 3 sqrt(2) d.
    const dvec3 middle = quadratic_normal(corners, normals, 0.5, 0);
    EXPECT_NEAR(middle.x, -1 / std::sqrt(5.0), 1e-12);
    EXPECT_NEAR(middle.y, 2 / std::sqrt(5.0), 1e-12);
    for (const dvec2 uv : {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)})
        EXPECT_NEAR(glm::length(quadratic_normal(corners, normals, uv.x, uv.y) - n), 0, 1e-12);
    // Along the edge from the second to the third corner the two tilts differ.
    EXPECT_LT(quadratic_normal(corners, normals, 0.5, 0.5).x, n.x + 1);
}

/// On a circle the formula gives the circle's own normals at the middle of an arc.
TEST(QuadraticNormal, IsSymmetricOnAnArc) {
    const dvec3 left(-std::sin(0.4), std::cos(0.4), 0), right(std::sin(0.4), std::cos(0.4), 0);
    const dvec3 middle = quadratic_normal({left, right, dvec3(0, 0, 1)}, {left, right, dvec3(0, 1, 0)}, 0.5, 0);
    EXPECT_NEAR(middle.x, 0, 1e-12);
    EXPECT_NEAR(middle.y, 1, 1e-12);
}

/// A light that the vertices do not see under a highlight between them.
TEST(ShadingModels, GouraudMissesAHighlightBetweenVertices) {
    Scene scene            = white_scene();
    scene.materials[0].k_d = vec3(0), scene.materials[0].k_s = vec3(1), scene.materials[0].shininess = 200;
    const Mesh floor = make_plane(8, 8);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    scene.lights[0].kind = LightKind::point, scene.lights[0].position = {0, 2, -2};
    scene.camera.eye = {0, 2, 2}, scene.camera.target = {0, 0, 0};
    const PointBatch points = points_of(scene);
    const auto brightest    = [&](ShadingModel model) {
        return std::ranges::max(shaded(model, scene, points).linear.data);
    };
    EXPECT_GT(brightest(ShadingModel::phong), 0.9f);
    EXPECT_LT(brightest(ShadingModel::gouraud), 0.01f);
    EXPECT_LT(brightest(ShadingModel::flat), 0.01f);
}

TEST(ShadingModels, ConstantKnowsNoLights) {
    Scene scene                 = bent_triangle();
    const PointBatch points     = points_of(scene);
    const ShadedPicture shaded_ = shaded(ShadingModel::constant, scene, points);
    const double cosine         = -glm::normalize(dvec3(scene.camera.target) - dvec3(scene.camera.eye)).y;
    EXPECT_EQ(shaded_.evaluations, 1u);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] != kNoTriangle) {
            EXPECT_NEAR(shaded_.linear.at(i, 2), cosine, 1e-6);
        }
}

}  // namespace
}  // namespace umbra
