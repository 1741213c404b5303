// Rectangle lights behind what lets a part of the light through: against closed forms, against the visible area that
// another algorithm finds, and against many samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// A floor under a square light of side 2 at height 4, and nothing between.
Scene floor_under_light() {
    Scene scene;
    scene.transparent = TransparentOccluders::multiply;
    scene.materials.resize(1);
    add_object(scene, "floor", {{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    Light light;
    light.name = "light", light.kind = LightKind::rectangle, light.position = {0, 4, 0};
    light.direction = {0, -1, 0}, light.edge_u = {2, 0, 0}, light.edge_v = {0, 0, -2};
    scene.lights     = {light};
    scene.camera.eye = {0, 3, 8};
    scene.width = 48, scene.height = 36;
    return scene;
}

/// A level sheet at height y over [x0, x1] x [-9, 9], of a material that lets the rest through.
void add_sheet(Scene& scene, float y, float x0, float x1, float opacity, vec3 colour = vec3(1)) {
    Material m;
    m.name = "sheet", m.opacity = opacity, m.transmit_colour = colour;
    scene.materials.push_back(m);
    add_object(scene, "sheet", {{x0, y, -9}, {x1, y, -9}, {x1, y, 9}, {x0, y, 9}}, {}, {{0, 2, 1}, {0, 3, 2}},
               static_cast<std::uint32_t>(scene.materials.size() - 1));
}

/// Points of the floor alone, all or every `step`-th.
PointBatch floor_points(const Scene& scene, std::uint32_t step = 1) {
    PointBatch points = primary(scene);
    std::vector<std::uint32_t> on_floor;
    for (std::uint32_t i = 0; i < points.size(); i += step)
        if (points.triangle[i] != kNoTriangle && scene.triangle_object[points.triangle[i]] == 0) on_floor.push_back(i);
    PointBatch picked = pick(points, on_floor);
    face_lights(picked, scene);
    return picked;
}

VisibilityPlane answers(const char* method, const Scene& scene, const PointBatch& points, bool is_coloured = false) {
    MethodCase run(method, scene);
    EXPECT_TRUE(run.verdict()) << run.verdict().why;
    run.prepare(0);
    VisibilityPlane plane(points.size(), is_coloured);
    run.visibility(points, 0, plane.out());
    return plane;
}

/// The fraction of the light, from x = -1 to 1 at height 4, behind a sheet over [x0, x1] at height y, from (x, 0, z).
double behind(double x, double y, double x0, double x1) {
    const auto on_light = [&](double edge) { return std::clamp(x + (edge - x) * 4 / y, -1.0, 1.0); };
    return (on_light(x1) - on_light(x0)) / 2;
}

TEST(FilteredLight, ASheetDimsThePartThatIsBehindIt) {
    Scene scene = floor_under_light();
    add_sheet(scene, 1, 0.25f, 9, 0.6f);
    const PointBatch points     = floor_points(scene);
    const VisibilityPlane plane = answers("exact", scene, points);
    std::size_t between         = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double x = exact_position(scene, points, i).x, part = behind(x, 1, 0.25, 9);
        EXPECT_NEAR(plane.s[i], 1 - double(0.6f) * part, 1e-6);
        between += part > 0.01 && part < 0.99 ? 1 : 0;
    }
    EXPECT_GT(between, 50u);
}

/// Where two sheets overlap, as the point sees them, what passes one is multiplied by what passes the other.
TEST(FilteredLight, SheetsBehindOneAnotherMultiplyPerChannel) {
    Scene scene = floor_under_light();
    add_sheet(scene, 1, -9, 0.25f, 0.5f, {1, 0.5f, 0.25f});
    add_sheet(scene, 2, -0.25f, 9, 0.25f, {0, 1, 0.5f});
    scene.camera.eye            = {0, 0.6f, 8};  // below both
    const PointBatch points     = floor_points(scene);
    const VisibilityPlane plane = answers("exact", scene, points, true);
    std::size_t seen            = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double x   = exact_position(scene, points, i).x;
        const double low = behind(x, 1, -9, 0.25), high = behind(x, 2, -0.25, 9);
        const double both = std::max(0.0, low + high - 1);  // one ends where the light begins, the other where it ends
        const dvec3 a = 0.5 * dvec3(1, 0.5, 0.25), b = 0.75 * dvec3(0, 1, 0.5);
        const dvec3 right = both * a * b + (low - both) * a + (high - both) * b + (1 - low - high + both) * dvec3(1);
        EXPECT_NEAR(glm::distance(dvec3(plane.colour[i]), right), 0, 1e-6) << x;
        EXPECT_EQ(plane.s[i], mean_of(plane.colour[i]));
        seen += both > 0.01 && low < 0.99 && high < 0.99 ? 1 : 0;
    }
    EXPECT_GT(seen, 20u);
}

/// A ball, a slanted sheet, a post and a sheet that passes through the light's plane and through the floor.
Scene obstacles(float opacity) {
    Scene scene = floor_under_light();
    scene.materials.resize(2);
    scene.materials[1].opacity = opacity;
    const Mesh ball = make_sphere(0.7f, 12, 6), post = make_box({0.3f, 3, 0.3f});
    std::vector<vec3> high = ball.positions, aside = post.positions;
    for (vec3& p : high) p += vec3(0.4f, 1.7f, 0.2f);
    for (vec3& p : aside) p += vec3(-1.5f, 1.2f, 1);
    add_object(scene, "ball", high, ball.normals, ball.triangles, 1);
    add_object(scene, "slanted", {{-2, 0.5f, -2}, {0, 2.5f, -2}, {0, 2, 1.5f}, {-2, 0.3f, 1}}, {},
               {{0, 1, 2}, {0, 2, 3}}, 1);
    add_object(scene, "through", {{1.2f, -1, 0}, {0.9f, 6, -1}, {0.9f, 5, 2}}, {}, {{0, 1, 2}}, 1);
    add_object(scene, "post", aside, {}, post.triangles, 0);
    return scene;
}

/// What lets almost nothing through hides what the visible area, which silhouettes find, says.
TEST(FilteredLight, NearlyOpaqueOnesHideWhatOpaqueOnesHide) {
    const Scene filters = obstacles(1 - 0x1p-24f), opaque = obstacles(1);
    ASSERT_FALSE(filters.blocks(filters.objects[1].first_triangle));
    const PointBatch points   = floor_points(filters, 17);
    const VisibilityPlane got = answers("exact", filters, points), right = answers("exact", opaque, points);
    std::size_t penumbra = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_NEAR(got.s[i], right.s[i], 2e-7) << i;
        penumbra += right.s[i] > 0.01f && right.s[i] < 0.99f ? 1 : 0;
    }
    EXPECT_GT(penumbra, 15u);
}

/// A closed body is passed twice.
TEST(FilteredLight, ManySamplesComeToTheSame) {
    const Scene scene           = obstacles(0.4f);
    const PointBatch points     = floor_points(scene, 17);
    const VisibilityPlane right = answers("exact", scene, points),
                          many  = answers("brute_force:samples=1024", scene, points);
    double largest = 0, sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double error = std::abs(static_cast<double>(right.s[i]) - static_cast<double>(many.s[i]));
        largest            = std::max(largest, error);
        sum += error;
    }
    EXPECT_LT(largest, 0.02);
    EXPECT_LT(sum / static_cast<double>(points.size()), 0.002);
    EXPECT_LT(*std::ranges::min_element(right.s), 0.5f) << "a closed body is passed twice: 0.36 where it covers all";
}

/// The floor's own plane cuts a light that stands on it.
TEST(FilteredLight, WhatIsBelowThePlaneIsNoLight) {
    Scene scene              = floor_under_light();
    scene.lights[0].position = {0, 0.5f, -2}, scene.lights[0].direction = {0, 0, 1};
    scene.lights[0].edge_u = {2, 0, 0}, scene.lights[0].edge_v = {0, 2, 0};
    Material m;
    m.opacity = 0.5f;
    scene.materials.push_back(m);
    add_object(scene, "pane", {{-9, -1, -1.5f}, {9, -1, -1.5f}, {9, 9, -1.5f}, {-9, 9, -1.5f}}, {},
               {{0, 1, 2}, {0, 2, 3}}, 1);
    const PointBatch points     = floor_points(scene);
    const VisibilityPlane plane = answers("exact", scene, points);
    std::size_t before          = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points.asks(0, i)) continue;
        ASSERT_EQ(points.facing[0][i], Facing::partly);
        EXPECT_NEAR(plane.s[i], 0.75 * (exact_position(scene, points, i).z > -1.5 ? 0.5 : 1), 1e-6);
        ++before;
    }
    EXPECT_GT(before, 300u);
}

TEST(FilteredLight, DisksAndIrradianceAreRefused) {
    Scene scene           = obstacles(0.5f);
    const auto service_of = [&](const char* method) { return MethodCase(method, scene).verdict(); };
    EXPECT_EQ(service_of("exact").how, How::exactly);
    EXPECT_EQ(service_of("exact:measure=irradiance").how, How::not_at_all);
    scene.lights[0].kind = LightKind::disk, scene.lights[0].radius = 1;
    EXPECT_EQ(service_of("exact").how, How::not_at_all);
    EXPECT_NE(service_of("exact").why.find("disks"), std::string::npos);
}

}  // namespace
}  // namespace umbra
