#include "umbra/core/render/off_pixel.h"

#include <gtest/gtest.h>

#include "umbra/core/render/gbuffer.h"

namespace umbra {
namespace {

/// The points of a floor of the given width, and of a box on it, that a camera at the height of a person sees.
PointBatch view_of_floor(float width, Scene& scene) {
    scene = Scene{};
    scene.materials.emplace_back();
    const float h = width / 2;
    add_object(scene, "floor", {{-h, 0, -h}, {h, 0, -h}, {h, 0, h}, {-h, 0, h}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    scene.camera.eye    = {3, 2.5f, 4};
    scene.camera.target = {0, 0.5f, 0};
    scene.camera.fov_y  = 35;
    return primary_points(RayScene(scene), scene, scene.camera, 320, 180);
}

// A float step of a barycentric is up to 2^-24: 6e-7 on a floor 10 wide, 0.6 on one of 1e7, where a pixel of this view
// spans about 0.02.
TEST(OffPixel, CountsPointsOnTrianglesTooLargeForFloats) {
    Scene scene;
    PointBatch points    = view_of_floor(10, scene);
    const OffPixel small = off_pixel(scene, points);
    EXPECT_EQ(small.points, 0u);
    EXPECT_GT(small.worst, 0);
    EXPECT_LT(small.worst, 0.01);

    // One point is put two pixels aside.
    std::size_t i = points.size() / 2;
    while (points.triangle[i] == kNoTriangle || points.triangle[i + 2] != points.triangle[i]) ++i;
    points.u[i] = points.u[i + 2], points.v[i] = points.v[i + 2];
    const OffPixel one = off_pixel(scene, points);
    EXPECT_EQ(one.points, 1u);
    EXPECT_NEAR(one.worst, 2, 0.01);

    points               = view_of_floor(1e7f, scene);
    const OffPixel large = off_pixel(scene, points);
    EXPECT_GT(large.points, points.size() / 4);
    EXPECT_GT(large.worst, 5);
}

}  // namespace
}  // namespace umbra
