// exact for sphere lights whose disk, as a point sees it, is lost in rounding: tiny ones, far ones, and points that
// nearly touch the sphere. The answer is a bracket that holds the truth, in both arithmetics.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/exact/exact_area.h"
#include "umbra/shadows/geometry/triangle_tree.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using exact_visibility::AimedLight;
using exact_visibility::AreaOccluders;
using exact_visibility::ExactArea;
using Arithmetic = ExactArea::Arithmetic;

void add(Scene& scene, const Mesh& mesh, vec3 by = vec3(0)) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    const Mesh moved = transformed(mesh, glm::translate(mat4(1), by));
    add_object(scene, "part", moved.positions, {}, moved.triangles, 0);
}
void add_sphere_light(Scene& scene, vec3 at, float radius) {
    Light light;
    light.kind     = LightKind::sphere;
    light.position = at;
    light.radius   = radius;
    scene.lights.push_back(light);
}

PointBatch points_anywhere(const Scene& scene, std::size_t count) {
    PointBatch batch;
    batch.eye = vec3(0, 9, 1);
    batch.resize(count);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    for (std::size_t i = 0; i < count; ++i) {
        const float a = unit(random), b = unit(random);
        set_point(batch, i, scene, static_cast<TriangleId>(random() % scene.triangles.size()), a + b > 1 ? 1 - a : a,
                  a + b > 1 ? 1 - b : b);
    }
    face_lights(batch, scene);
    return batch;
}

/// Calls body(i, answer) for every open point, in both arithmetics.
template <class Body>
void ask(const Scene& scene, const PointBatch& points, const Body& body) {
    const TriangleTree tree(scene);
    const AreaOccluders among(scene, tree);
    const AimedLight light(scene.lights[0], among.occluders);
    for (const Arithmetic arithmetic : {Arithmetic::filtered, Arithmetic::rational}) {
        const ExactArea area(among, light, arithmetic);
        ExactArea::Workspace work;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (is_open(points, 0, i))
                body(i, area.seen(points.triangle[i], points.u[i], points.v[i], points.facing[0][i] == Facing::partly,
                                  points.flipped[i] ? -1 : 1, work));
    }
}

/// A light that is a point to every measure, over the side of a box and in its plane.
TEST(ExactRoughLight, OfATinyLightInTheFacePlane) {
    for (const float radius : {1e-13f, 1e-14f, 1e-15f, 1e-17f}) {
        Scene scene;
        add(scene, make_plane(10, 10));
        add(scene, make_box(vec3(1)), vec3(0, 1, 0));
        add_sphere_light(scene, vec3(0.5f, 4, 0), radius);
        const PointBatch points = points_anywhere(scene, 400);
        std::size_t open = 0, known = 0, hidden = 0;
        ask(scene, points, [&](std::size_t i, const ExactArea::Answer& got) {
            ++open;
            if (points.triangle[i] >= 2) return;  // on the floor there is a formula
            const double x = points.px[i], z = points.pz[i];
            // The box's shadow: from x = 0.5 on, which its side lies in, through what its lid and its bottom hide.
            const double at_lid_x = x + (0.5 - x) * 1.5 / 4, at_lid_z = z * (1 - 1.5 / 4);
            const double at_bottom_x = x + (0.5 - x) * 0.5 / 4, at_bottom_z = z * (1 - 0.5 / 4);
            const auto within  = [](double a, double b) { return std::abs(a) < 0.5 && std::abs(b) < 0.5; };
            const bool in_slab = within(at_lid_x, at_lid_z) || within(at_bottom_x, at_bottom_z);
            const double right = in_slab ? 0 : 1;
            EXPECT_NEAR(got.visibility, right, double(got.half_width)) << radius << ": " << x << ", " << z;
            known += got.half_width < 0.01f;
            hidden += right == 0;
        });
        EXPECT_GT(open, 100u);
        EXPECT_GT(hidden, 5u);
        EXPECT_GT(known, 20u);  // where no edge is near
    }
}

/// A sphere that touches the floor, and a box at the contact.
TEST(ExactRoughLight, AtTheContactOfALightAndAFloor) {
    for (const float size : {1e-3f, 1e-4f, 1e-6f}) {
        Scene scene;
        add(scene, make_plane(10, 10));
        add(scene, make_box(vec3(size)), vec3(size / 2, size / 2, 0));
        add_sphere_light(scene, vec3(0, 1, 0), 1);
        PointBatch points = points_anywhere(scene, 100);
        std::mt19937 random(1);
        std::uniform_real_distribution<float> near(-8 * size, 8 * size);
        for (std::size_t i = 0; i < 50; ++i)  // floor: triangle 0 and its diagonal through the contact
            set_point(points, i, scene, 0, std::abs(near(random)) / 10, 0.5f + near(random) / 20);
        face_lights(points, scene);
        std::size_t open = 0, unknown = 0;
        ask(scene, points, [&](std::size_t, const ExactArea::Answer& got) {
            ++open;
            unknown += got.half_width > 0.4f;
            EXPECT_GE(got.visibility, 0.0f);
            EXPECT_LE(got.visibility, 1.0f);
            EXPECT_LE(got.half_width, 0.51f);
        });
        EXPECT_GT(open, 50u);
        EXPECT_LT(unknown, open);
    }
}

/// Whatever lies between, a light 1e18 away is seen whole or hidden by most, and unknown beside edges.
TEST(ExactRoughLight, OfALightFarAway) {
    Scene scene;
    add(scene, make_sphere(1, 6, 4));
    add(scene, make_sphere(0.5f, 12, 6), vec3(0, -0.9f, -1.5f));
    add_sphere_light(scene, vec3(0, -2, -1e18f), 1);
    const PointBatch points = points_anywhere(scene, 500);
    std::size_t open = 0, unknown = 0;
    ask(scene, points, [&](std::size_t, const ExactArea::Answer& got) {
        ++open;
        unknown += got.half_width > 0.4f;
    });
    EXPECT_GT(open, 100u);
    EXPECT_LT(unknown, open);
}

/// A floor below the lowest point of a sphere of radius 1e10, by less than what rounding leaves of the distance: a
/// point there is not within the sphere. A triangle between the two hides most of the light from below.
TEST(ExactRoughLight, NextToTheSurfaceOfALargeSphere) {
    Scene scene;
    const float r = 1e10f;
    add(scene, Mesh{{{-6, -1e-6f, -6}, {6, -1e-6f, -6}, {0, -1e-6f, 6}}, {}, {{0, 2, 1}}});
    add(scene, Mesh{{{-1, -5e-7f, -1}, {1, -5e-7f, -1}, {0, -5e-7f, 1}}, {}, {{0, 1, 2}}});
    add_sphere_light(scene, vec3(0, r, 0), r);
    const TriangleTree tree(scene);
    const AreaOccluders among(scene, tree);
    const AimedLight light(scene.lights[0], among.occluders);
    for (const Arithmetic arithmetic : {Arithmetic::filtered, Arithmetic::rational}) {
        const ExactArea area(among, light, arithmetic);
        ExactArea::Workspace work;
        const ExactArea::Answer got = area.seen(0, 0.5f, 0.25f, false, 1, work);  // under the other's middle
        EXPECT_LT(double(got.visibility) - double(got.half_width), 0.5);
    }
}

}  // namespace
}  // namespace umbra
