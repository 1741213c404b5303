// Eyes and lights so far from the scene, or so much larger, that floats cannot hold both: the picture stays right, or
// is refused with the reason. Embree's rays have coordinates below 2^60; beyond, it ends the process.
#include <gtest/gtest.h>

#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

/// A box of the given size around the origin, on material 0.
Scene box_scene(float size) {
    Scene scene;
    scene.name = "box";
    scene.materials.emplace_back();
    const Mesh box = make_box(vec3(size));
    add_object(scene, "box", box.positions, box.normals, box.triangles, 0);
    return scene;
}

Camera camera_at(vec3 eye, float fov_y) {
    Camera camera;
    camera.eye   = eye;
    camera.up    = {0, 1, 0};
    camera.fov_y = fov_y;
    return camera;
}

Camera window_at(vec3 eye, float height) {
    Camera camera     = camera_at(eye, 45);
    camera.projection = Projection::orthographic;
    camera.height     = height;
    return camera;
}

PointBatch seen(const Scene& scene, const Camera& camera, int side = 31) {
    return primary_points(RayScene(scene), scene, camera, side, side);
}

std::size_t surface_points(const PointBatch& points) {
    return points.size() - static_cast<std::size_t>(std::ranges::count(points.triangle, kNoTriangle));
}

/// Points whose place is more than `share` of a pixel off the pixel's centre.
std::size_t off_centre(const Scene& scene, const PointBatch& points, double share) {
    std::size_t off = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const dvec3 pixel       = points.raster->project(exact_position(scene, points, i));
        const std::size_t width = static_cast<std::size_t>(points.raster->width), column = i % width, row = i / width;
        const double x = static_cast<double>(column) + 0.5, y = static_cast<double>(row) + 0.5;
        off += !(std::abs(pixel.x - x) <= share && std::abs(pixel.y - y) <= share);
    }
    return off;
}

// An orthographic view does not depend on how far the eye is, as long as a double can place it to a part of a pixel.
TEST(FarEye, OrthographicViewsDoNotDependOnTheDistance) {
    const Scene scene     = box_scene(1);
    const PointBatch near = seen(scene, window_at({0, 0, 8}, 1.5f));
    ASSERT_GT(surface_points(near), 300u);
    for (const float distance : {1e4f, 1e6f, 1e7f, 1e9f, 1e12f, 1e15f}) {
        const PointBatch far = seen(scene, window_at({0, 0, distance}, 1.5f));
        EXPECT_EQ(far.triangle, near.triangle) << distance;
        EXPECT_EQ(off_centre(scene, far, 0.01), 0u) << distance;
    }
}

// From three million widths away, in a view of a thousandth of a degree.
TEST(FarEye, NarrowPerspectiveViewsHitTheirPixels) {
    for (const float size : {1e-6f, 1.0f, 1e6f}) {
        const Scene scene     = box_scene(size);
        const PointBatch view = seen(scene, camera_at(vec3(0.3f, 0.4f, 1.0f) * (3e6f * size), 1e-3f));
        EXPECT_GT(surface_points(view), 0u) << size;
        EXPECT_EQ(off_centre(scene, view, 0.01), 0u) << size;
    }
}

TEST(FarEye, IsRefusedWhereRoundingDecidesWhatAPixelSees) {
    for (const auto& [size, distance] : {std::pair{1.0f, 1e18f}, std::pair{1e-18f, 1.0f}, std::pair{1e-18f, 1e18f}}) {
        const Scene scene = box_scene(size);
        for (const Camera& camera :
             {camera_at({0, 0, distance}, 45), window_at({0, 0, distance}, 1), window_at({0, 0, size}, distance)}) {
            try {
                (void)seen(scene, camera);
                ADD_FAILURE() << "an eye at " << distance << " from a box of " << size;
            } catch (const InputError& e) {
                EXPECT_NE(std::string(e.what()).find("box: camera: "), std::string::npos) << e.what();
            }
        }
    }
}

TEST(FarEye, SeesNothingWhereNothingHasAnArea) {
    Scene scene;
    EXPECT_EQ(surface_points(seen(scene, camera_at({0, 0, 1e18f}, 45))), 0u);
    scene.materials.emplace_back();
    add_object(scene, "point", {{0, 1, 0}}, {}, {{0, 0, 0}}, 0);
    EXPECT_EQ(surface_points(seen(scene, camera_at({0, 0, 1e18f}, 45))), 0u);
}

TEST(FarEye, LooksPastTheScene) {
    const Scene scene = box_scene(1);
    EXPECT_EQ(surface_points(seen(scene, camera_at({0, 0, 1e9f}, 45))), 1u);  // the middle one
    Camera away = camera_at({0, 0, 1e9f}, 45);
    away.target = {0, 0, 2e9f};
    EXPECT_EQ(surface_points(seen(scene, away)), 0u);
}

// On top of a convex body every method sees a light above it, at any distance and of any size; where the light is far
// wider than it is high, all but a millionth of its directions graze the top, and all that is asked is a fraction.
TEST(FarLight, IsSeenByEveryMethodThatServesIt) {
    const Scene base        = box_scene(1e-9f);
    const PointBatch points = seen(base, camera_at({1e-9f, 2e-9f, 1.5e-9f}, 50), 9);
    for (const LightKind kind : {LightKind::point, LightKind::rectangle, LightKind::disk, LightKind::sphere})
        for (const float distance : {1e-6f, 1.0f, 1e9f, 1e18f})
            for (const float size : {1e-18f, 1.0f, 1e9f, 1e18f}) {
                if (kind == LightKind::point && size != 1) continue;
                if (kind == LightKind::sphere && size >= distance) continue;
                Light light;
                light.name      = "light";
                light.kind      = kind;
                light.position  = {0, distance, 0};
                light.direction = {0, -1, 0};
                light.edge_u    = {size, 0, 0};
                light.edge_v    = {0, 0, size};
                light.radius    = size;
                Scene scene     = base;
                scene.lights.push_back(light);
                PointBatch lit = points;
                face_lights(lit, scene);
                const SceneFacts facts = find_facts(scene);
                for (const MethodInfo* info : methods()) {
                    if (info->reference) continue;
                    Asked method(*info);
                    if (!method.serves(facts)) continue;
                    method.build(scene, facts);
                    method.aim(0);
                    const VisibilityPlane plane = method.visibility(lit, 0);
                    std::size_t top = 0, wrong = 0;
                    for (std::size_t i = 0; i < lit.size(); ++i) {
                        if (lit.facing[0][i] != Facing::front || !plane.defined(i)) continue;
                        ++top;
                        wrong += size <= 1e3f * distance ? plane.s[i] != 1 : !(plane.s[i] >= 0 && plane.s[i] <= 1);
                    }
                    EXPECT_EQ(wrong, 0u) << info->name << ", " << to_string(kind) << " of " << size << " at "
                                         << distance << ", of " << top << " points";
                }
            }
}

}  // namespace
}  // namespace umbra
