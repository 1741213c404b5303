// Points of a picture, written eight at a time, have the bits of points written one by one.
#include "umbra/core/render/point_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/same_points.h"

namespace umbra {
namespace {

Light light_at(LightKind kind, vec3 position) {
    Light light;
    light.kind     = kind;
    light.position = position;
    return light;
}

/// A slanted quad of two triangles with a wall on it, and a soup of triangles, slivers among them.
Scene slope_and_soup(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> both(-1, 1);
    const auto vector = [&] { return vec3(both(random), both(random), both(random)); };
    Scene scene;
    scene.materials.resize(2);
    scene.materials[0].two_sided = true;
    scene.materials[1].two_sided = false;
    const vec3 a(-3.125f, 0.25f, 1.75f), u(8.5f, 1, 1.125f), v(3.875f, -1.125f, -6);
    add_object(scene, "slope", {a, a + u, a + u + v, a + v}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
    const vec3 on = a + 0.5f * u + 0.25f * v, foot = on + 0.125f * u, up(0, 1, 0);
    add_object(scene, "wall on the slope", {foot, foot + 0.25f * u, foot + 0.25f * u + up, foot + up}, {},
               {{0, 1, 2}, {0, 2, 3}}, 0);
    std::vector<vec3> corners;
    std::vector<uvec3> triangles;
    for (std::uint32_t t = 0; t < 400; ++t) {
        const vec3 p = 2.5f * vector(), side = 0.6f * vector();
        corners.insert(corners.end(),
                       {p, p + side, p + (t % 8 == 0 ? 0.5f * side + 1e-5f * vector() : 0.6f * vector())});
        triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
    }
    add_object(scene, "soup", corners, {}, triangles, 1);

    // Each kind of light anywhere, in the plane of the slope, and next to it.
    for (const float lift : {4.0f, 0.0f, 1e-6f, -1e-6f, 0.3f}) {
        const vec3 at = on + vec3(0, lift, 0);
        for (const LightKind kind : {LightKind::point, LightKind::spot}) scene.lights.push_back(light_at(kind, at));
        Light sun     = light_at(LightKind::directional, {});
        sun.direction = lift == 4 ? vec3(0.3f, -1, 0.2f) : u + vec3(0, lift, 0);
        scene.lights.push_back(sun);
        for (const vec3 edge_v : {v, vec3(0, 1, 0)}) {
            Light rectangle  = light_at(LightKind::rectangle, at);
            rectangle.edge_u = u, rectangle.edge_v = edge_v;
            scene.lights.push_back(rectangle);
        }
        Light disk     = light_at(LightKind::disk, at);
        disk.direction = lift > 1 ? vec3(0.2f, -1, 0.1f) : glm::cross(u, v), disk.radius = 0.4f;
        scene.lights.push_back(disk);
        Light sphere  = light_at(LightKind::sphere, at);
        sphere.radius = 0.3f;
        scene.lights.push_back(sphere);
    }
    // All of it over the slope, which its lower edge touches, and in the plane of the wall: in front of one and away
    // from the other, both too close to tell without rationals.
    Light upright  = light_at(LightKind::rectangle, on + 0.5f * up);
    upright.edge_u = u, upright.edge_v = up;
    scene.lights.push_back(upright);
    return scene;
}

struct Found {
    std::size_t points = 0, none = 0, away = 0, partly = 0, front = 0, unshadowed = 0;
};

void expect_one_by_one(const Scene& scene, int width, int height, Found& found) {
    const PointBatch batch = primary_points(RayScene(scene), scene, scene.camera, width, height);
    PointBatch one         = batch;
    for (std::vector<Facing>& plane : one.facing) std::fill(plane.begin(), plane.end(), Facing::none);
    for (std::size_t i = 0; i < one.size(); ++i) {
        if (batch.triangle[i] == kNoTriangle) continue;
        ++found.points;
        one.px[i] = one.py[i] = one.pz[i] = one.nx[i] = one.ny[i] = one.nz[i] = -1, one.flipped[i] = 2;
        set_point(one, i, scene, batch.triangle[i], batch.u[i], batch.v[i]);
    }
    face_lights(one, scene);
    ASSERT_EQ(batch.facing.size(), scene.lights.size());
    expect_same(one, batch);
    for (LightId j = 0; j < scene.lights.size(); ++j)
        for (const Facing f : batch.facing[j])
            ++(f == Facing::none     ? found.none
               : f == Facing::away   ? found.away
               : f == Facing::partly ? found.partly
               : f == Facing::front  ? found.front
                                     : found.unshadowed);
}

TEST(PointWriter, WritesWhatPointsWrittenOneByOneHave) {
    Found found;
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
        for (unsigned seed = 1; seed <= 4; ++seed) {
            Scene scene             = slope_and_soup(seed);
            scene.camera.projection = projection;
            scene.camera.height     = 9;
            scene.camera.eye        = {2, seed % 2 == 0 ? 6.0f : -6.0f, 9};
            scene.camera.target     = {0, 0, 0};
            expect_one_by_one(scene, 163, 91, found);  // no whole tiles, no whole packets
        }
    EXPECT_GT(found.points, 30000u);
    EXPECT_GT(found.none, 10000u);
    EXPECT_GT(found.away, 100000u);
    EXPECT_GT(found.partly, 100000u);
    EXPECT_GT(found.front, 100000u);
    EXPECT_GT(found.unshadowed, 200u) << "within a sphere light";
}

/// A scene may have no lights, and a picture fewer pixels than a packet.
TEST(PointWriter, SmallPicturesAndNoLights) {
    Scene scene      = slope_and_soup(5);
    scene.camera.eye = {2, 6, 9};
    Found found;
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {5, 3}, {16, 8}, {17, 9}})
        expect_one_by_one(scene, width, height, found);
    scene.lights.clear();
    expect_one_by_one(scene, 33, 17, found);
    EXPECT_GT(found.points, 150u);
}

/// Embree's floats may give an area to a triangle that has none.
TEST(PointWriter, ATriangleWithoutAreaIsNoSurface) {
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "line", {{-1, 0, 0}, {0, 0, 0}, {2, 0, 0}}, {}, {{0, 1, 2}}, 0);
    scene.lights = {light_at(LightKind::point, {0, 5, 0}), light_at(LightKind::sphere, {0, 5, 1})};
    PointBatch batch;
    batch.raster = frame(scene.camera, 4, 2);
    batch.eye    = scene.camera.eye;
    batch.resize(8);
    const PointWriter writer(scene, batch);
    const PointTile tile{0, 0, 4, 2, 8};
    writer.claim(tile);
    Hits8 hits{};  // all of triangle 0
    std::fill_n(hits.along[2], 8, -1.0);
    EXPECT_FALSE(writer.write(hits, 0, 0));
    writer.face_open_points(tile);
    EXPECT_EQ(batch.triangle, std::vector<TriangleId>(8, kNoTriangle));
    for (const std::vector<Facing>& plane : batch.facing) EXPECT_EQ(plane, std::vector<Facing>(8, Facing::none));
    for (const std::vector<float>* plane : {&batch.u, &batch.v, &batch.px, &batch.py, &batch.pz, &batch.nx, &batch.nz})
        EXPECT_EQ(*plane, std::vector<float>(8, 0.0f));
}

}  // namespace
}  // namespace umbra
