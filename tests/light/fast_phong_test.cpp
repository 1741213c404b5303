// Phong's shading for less against Phong's shading, where the two must agree and as far as they may differ.
#include "umbra/bench/studies/light/fast_phong.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/lit_everywhere.h"

namespace umbra {
namespace {

/// A shining ball over a floor under a sun, whose direction is the same everywhere.
Scene ball_under_sun(Lobe lobe, int longitudes = 16) {
    Scene scene;
    Material material;
    material.k_a = vec3(0), material.k_d = vec3(0.7f), material.k_s = vec3(0.5f);
    material.shininess = 20, material.lobe = lobe;
    scene.materials.push_back(material);
    Light sun;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {-1, -2, -1.5f};
    scene.lights.push_back(sun);
    const Mesh sphere = make_sphere(1, longitudes, longitudes / 2), floor = make_plane(8, 8);
    add_object(scene, "ball", sphere.positions, sphere.normals, sphere.triangles, 0);
    std::vector<vec3> low = floor.positions;
    for (vec3& p : low) p.y -= 1;
    add_object(scene, "floor", low, {}, floor.triangles, 0);
    scene.camera.eye = {1, 2, 5};
    scene.width = 96, scene.height = 72;
    return scene;
}

/// The same under a lamp nearby.
Scene ball_under_lamp(Lobe lobe, int longitudes = 16) {
    Scene scene          = ball_under_sun(lobe, longitudes);
    scene.lights[0].kind = LightKind::point, scene.lights[0].position = {2, 3, 2};
    return scene;
}

constexpr std::uint32_t kBall = 0, kFloor = 1;

/// From Phong's shading, of one object.
double largest_difference(const Scene& scene, ShadingModel model, std::uint32_t object) {
    const PointBatch points = points_of(scene);
    const Image a = shaded(model, scene, points).linear, b = shaded(ShadingModel::phong, scene, points).linear;
    double largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] != kNoTriangle && scene.triangle_object[points.triangle[i]] == object)
            largest = std::max(largest, std::abs(static_cast<double>(a.at(i, 0)) - static_cast<double>(b.at(i, 0))));
    return largest;
}

class FastPhong : public testing::TestWithParam<Lobe> {};

TEST_P(FastPhong, DifferencesArePhongWhereDirectionsAreConstant) {
    Scene scene        = ball_under_sun(GetParam());
    scene.local_viewer = false;
    for (const std::uint32_t object : {kBall, kFloor})
        EXPECT_LT(largest_difference(scene, ShadingModel::differences, object), 1e-5) << "in perspective";
    scene.camera.projection = Projection::orthographic, scene.camera.height = 4;
    for (const std::uint32_t object : {kBall, kFloor})
        EXPECT_LT(largest_difference(scene, ShadingModel::differences, object), 1e-5) << "in parallel";
    EXPECT_GT(largest_difference(ball_under_lamp(GetParam()), ShadingModel::differences, kFloor), 0.1)
        << "a lamp's direction changes over a triangle";
}

TEST_P(FastPhong, TaylorsErrorFallsWithTheThirdPowerOfTheEdge) {
    double last = 0;
    for (const int longitudes : {16, 32, 64}) {
        Scene scene              = ball_under_lamp(GetParam(), longitudes);
        scene.materials[0].k_s   = vec3(0);  // a power of a cosine is no polynomial
        const PictureCosines all = cosines_by_taylor(scene, points_of(scene));
        const double largest     = largest_difference(scene, ShadingModel::taylor, kBall);
        EXPECT_GT(all.evaluations, 50u);
        EXPECT_LT(all.evaluations, scene.triangles.size());
        if (last > 0) {
            EXPECT_LT(largest, last / 6) << longitudes << ": a ratio of 8, where the next term is small";
        }
        last = largest;
    }
    EXPECT_LT(last, 1e-3);
}

TEST_P(FastPhong, TaylorIsCloseOnSmallTrianglesAndWrongOnLargeOnes) {
    const Scene scene = ball_under_lamp(GetParam(), 64);
    EXPECT_LT(largest_difference(scene, ShadingModel::taylor, kBall), 0.01);
    EXPECT_GT(largest_difference(scene, ShadingModel::taylor, kFloor), 0.1);
}

/// Whatever the test leaves out is below its limit, and it leaves most out.
TEST_P(FastPhong, HighlightTestLosesNoHighlight) {
    for (Scene scene : {ball_under_lamp(GetParam(), 32), ball_under_sun(GetParam(), 32)}) {
        scene.materials[0].k_d = vec3(0), scene.materials[0].shininess = 60;
        const PointBatch points = points_of(scene);
        const Image phong       = shaded(ShadingModel::phong, scene, points).linear,
                    tested      = shaded(ShadingModel::highlight_test, scene, points).linear;
        std::size_t left_out = 0, shining = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (tested.at(i, 0) > 0) {
                EXPECT_NEAR(tested.at(i, 0), phong.at(i, 0), 1e-6);
                ++shining;
            } else {
                EXPECT_LT(phong.at(i, 0), 1.0f / 255);
                ++left_out;
            }
        }
        EXPECT_GT(shining, 50u);
        EXPECT_GT(left_out, shining / 2);
    }
}

TEST_P(FastPhong, HighlightTestInterpolatesTheDiffuseTerm) {
    Scene scene             = ball_under_sun(GetParam());
    scene.materials[0].k_s  = vec3(0);
    const PointBatch points = points_of(scene);
    const Image tested      = shaded(ShadingModel::highlight_test, scene, points).linear,
                gouraud     = shaded(ShadingModel::gouraud, scene, points).linear;
    const dvec3 to_sun      = -glm::normalize(dvec3(scene.lights[0].direction));
    std::size_t compared    = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle || scene.triangle_object[points.triangle[i]] != 0) continue;
        bool all_lit = true;  // where a corner is turned away, Gouraud has 0 there, and this less than 0
        for (int k = 0; k < 3; ++k)
            all_lit = all_lit && glm::dot(dvec3(scene.normals[scene.triangles[points.triangle[i]][k]]), to_sun) > 0;
        if (!all_lit || points.facing[0][i] != Facing::front) continue;
        EXPECT_NEAR(tested.at(i, 0), gouraud.at(i, 0), 1e-5);
        ++compared;
    }
    EXPECT_GT(compared, 300u);
}

TEST_P(FastPhong, CountsWhereDirectionsAreFound) {
    Scene scene             = ball_under_sun(GetParam());
    scene.materials[0].k_s  = vec3(0);
    const PointBatch points = points_of(scene);
    const std::size_t sides = cosines_by_differences(scene, points).evaluations;
    EXPECT_EQ(cosines_by_taylor(scene, points).evaluations, sides);
    EXPECT_EQ(cosines_by_highlight_test(scene, points).evaluations, 4 * sides) << "no highlight anywhere";
    EXPECT_LT(sides, scene.triangles.size());
}

INSTANTIATE_TEST_SUITE_P(Lobes, FastPhong, testing::Values(Lobe::phong, Lobe::blinn_phong),
                         [](const auto& lobe) { return std::string(lobe.param == Lobe::phong ? "phong" : "blinn"); });

}  // namespace
}  // namespace umbra
