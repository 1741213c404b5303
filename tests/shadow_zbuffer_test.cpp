#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "core/primitives.h"
#include "shadows/method.h"

namespace umbra {
namespace {

// ---- scenes --------------------------------------------------------------------------------------------------------

std::uint32_t add_mesh(Scene& scene, std::string name, const Mesh& mesh) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    return add_object(scene, std::move(name), mesh.positions, mesh.normals, mesh.triangles, 0);
}
Mesh moved(const Mesh& mesh, vec3 by) {
    mat4 m(1);
    m[3] = vec4(by, 1);
    return transformed(mesh, m);
}

Light point_light(vec3 position) {
    Light light;
    light.name     = "light";
    light.position = position;
    return light;
}
Light directional_light(vec3 direction) {
    Light light;
    light.name      = "light";
    light.kind      = LightKind::directional;
    light.direction = direction;
    return light;
}
Light spot_light(vec3 position, vec3 axis, float cutoff_degrees) {
    Light light       = point_light(position);
    light.kind        = LightKind::spot;
    light.direction   = glm::normalize(axis);
    light.spot.cutoff = glm::radians(cutoff_degrees);
    return light;
}

constexpr float kFloor  = 4;  ///< side of the floor, in y = 0
constexpr float kSquare = 1;  ///< side of the square above it
constexpr float kHeight = 1;

/// A square parallel to a floor, both centred on the y axis. Object 0 is the floor.
Scene square_over_floor(const Light& light) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(kFloor, kFloor));
    add_mesh(scene, "square", moved(make_plane(kSquare, kSquare), {0, kHeight, 0}));
    scene.lights.push_back(light);
    scene.camera.eye = {0, 10, 0};
    return scene;
}

/// Signed distance of the floor's point from the shadow's border, in world units on the floor: inside positive.
double depth_in_shadow(const Light& light, dvec3 p) {
    // Where the segment to the light passes the square's plane, and how lengths scale from there to the floor.
    dvec3 q;
    double scale = 1;
    if (light.kind == LightKind::directional) {
        const dvec3 d(light.direction);
        q = p + d * (kHeight / d.y);
    } else {
        const dvec3 l(light.position);
        q     = p + (l - p) * (kHeight / l.y);
        scale = l.y / (l.y - kHeight);
    }
    return scale * std::min(kSquare / 2 - std::abs(q.x), kSquare / 2 - std::abs(q.z));
}

// ---- running -------------------------------------------------------------------------------------------------------

/// n (n + 1) / 2 points inside each triangle of an object.
PointBatch points_on(const Scene& scene, std::uint32_t object, int n) {
    PointBatch batch;
    batch.eye        = scene.camera.eye;
    const Object& o  = scene.objects[object];
    std::size_t next = 0;
    batch.resize(static_cast<std::size_t>(o.triangle_count) * n * (n + 1) / 2);
    for (TriangleId t = o.first_triangle; t < o.first_triangle + o.triangle_count; ++t)
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j)
                set_point(batch, next++, scene, t, (static_cast<float>(i) + 0.31f) / static_cast<float>(n),
                          (static_cast<float>(j) + 0.37f) / static_cast<float>(n));
    face_lights(batch, scene);
    return batch;
}

struct Plane {
    std::vector<float> s;
    std::vector<std::uint8_t> defined;
};

Plane look_up(const Scene& scene, const PointBatch& batch, std::string_view choice) {
    const MethodChoice method = parse_method(choice);
    const auto zbuffer        = method.info->make(method.settings);
    const SceneFacts facts    = find_facts(scene);
    EXPECT_EQ(zbuffer->serves(facts).how, How::approximately);
    zbuffer->build(scene, facts);
    zbuffer->aim(0);
    Plane plane{std::vector<float>(batch.size(), 0), std::vector<std::uint8_t>(batch.size(), 1)};
    zbuffer->visibility(batch, 0, plane.s, plane.defined);
    return plane;
}

/// Counts against the closed form, and how far from the border the farthest wrong point lies.
struct Wrong {
    int points = 0, false_shadow = 0, false_light = 0;
    double farthest = 0;
    [[nodiscard]] int all() const { return false_shadow + false_light; }
};
Wrong against_closed_form(const Light& light, std::string_view choice, int n = 300) {
    const Scene scene      = square_over_floor(light);
    const PointBatch batch = points_on(scene, 0, n);
    const Plane plane      = look_up(scene, batch, choice);
    Wrong wrong;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        EXPECT_EQ(plane.defined[i], 1);
        EXPECT_TRUE(plane.s[i] == 0 || plane.s[i] == 1);
        const double depth = depth_in_shadow(light, dvec3(batch.position(i)));
        const bool shadow  = depth > 0;
        ++wrong.points;
        if (shadow == (plane.s[i] == 0)) continue;
        ++(shadow ? wrong.false_light : wrong.false_shadow);
        wrong.farthest = std::max(wrong.farthest, std::abs(depth));
    }
    return wrong;
}

const Light kLights[] = {directional_light({0.3f, -1, 0.2f}),
                         directional_light({1, -1, 0}),
                         directional_light({-2, -1, 1}),
                         directional_light({0, -1, 0}),
                         point_light({0.3f, 3, 0.4f}),
                         point_light({3, 4, 1}),
                         point_light({0, 30, 0}),
                         point_light({0.1f, 1.5f, 0.1f}),
                         spot_light({1, 4, 0}, {-0.3f, -1, 0}, 40),
                         spot_light({0, 3, 0}, {0.2f, -1, 0}, 90),
                         spot_light({0.5f, 2.5f, 0}, {0, -1, 0}, 25)};

// ---- tests ---------------------------------------------------------------------------------------------------------

TEST(ShadowZBuffer, ErrsOnlyWithinASampleOfTheShadowsBorder) {
    for (const Light& light : kLights) {
        const Wrong wrong = against_closed_form(light, "shadow_zbuffer:resolution=1024");
        // A map's window is at most 3 times the floor's diagonal wide, a cube's side at most 2 heights of 30.
        const double sample = 3 * kFloor * std::sqrt(2.0) / 1024;
        EXPECT_LT(wrong.farthest, 2 * sample) << to_string(light.kind) << ' ' << light.position.y;
        EXPECT_LT(wrong.all(), wrong.points / 100) << to_string(light.kind) << ' ' << light.position.y;
    }
}

}  // namespace
}  // namespace umbra
