// Scenes of benchmarks, generated: nothing has to be downloaded, and no file can change under an accepted run.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

inline mat4 placed(vec3 position, vec3 axis) {  // turns +y to `axis`
    const vec3 y = glm::normalize(axis);
    const vec3 x = glm::normalize(glm::cross(y, std::abs(y.x) < 0.9f ? vec3(1, 0, 0) : vec3(0, 0, 1)));
    return {vec4(x, 0), vec4(y, 0), vec4(glm::cross(x, y), 0), vec4(position, 1)};
}

inline void add(Scene& scene, const std::string& name, const Mesh& mesh, const mat4& place) {
    const Mesh m = transformed(mesh, place);
    add_object(scene, name, m.positions, m.normals, m.triangles, 0);
}

inline void add_lights(Scene& scene, vec3 place, vec3 target, float size) {
    const vec3 down = glm::normalize(target - place), u = glm::normalize(glm::cross(down, vec3(0, 1, 0)));
    Light point;
    point.name     = "point";
    point.position = place;
    Light area     = point;
    area.name      = "area";
    area.kind      = LightKind::rectangle;
    area.direction = down;
    area.edge_u    = u * size;
    area.edge_v    = glm::cross(down, u) * size;
    scene.lights   = {point, area};
}

/// A few bodies of 9,000 triangles on a floor.
inline Scene simple_scene() {
    Scene scene;
    scene.materials.emplace_back();
    add(scene, "floor", make_plane(12, 12), mat4(1));
    add(scene, "box", make_box({0.8f, 1.1f, 0.8f}), placed({-1.3f, 0.55f, -0.2f}, {0, 1, 0}));
    add(scene, "ball", make_sphere(0.6f, 64, 32), placed({0.1f, 0.6f, -0.4f}, {0, 1, 0}));
    add(scene, "ring", make_torus(0.45f, 0.15f, 64, 32), placed({1.3f, 0.62f, 0.1f}, {0.35f, 0.25f, 1}));
    add(scene, "marble", make_sphere(0.25f, 32, 16), placed({0.45f, 0.25f, 0.9f}, {0, 1, 0}));
    scene.camera.eye    = {0, 2.2f, 4.8f};
    scene.camera.target = {0, 0.55f, 0};
    add_lights(scene, {3, 5, 2}, scene.camera.target, 1);
    return scene;
}

/// 64 rings, each with another axis, of 2 `around` `tube` triangles: 1,024,000 of 125 x 64.
inline Scene tori_scene(int around, int tube) {
    Scene scene;
    scene.materials.emplace_back();
    add(scene, "floor", make_plane(12, 12), mat4(1));
    const Mesh ring = make_torus(0.22f, 0.07f, around, tube);
    for (int i = 0; i < 64; ++i) {
        const int row = i / 8, column = i % 8;
        const auto a = static_cast<float>(row), b = static_cast<float>(column);
        add(scene, fmt::format("ring{}", i), ring,
            placed({(a - 3.5f) * 0.62f, 0.42f + 0.25f * std::sin(1.7f * a + b), (b - 3.5f) * 0.62f},
                   {std::sin(2.1f * a), std::cos(a + 3 * b), std::sin(1.3f * b)}));
    }
    scene.camera.eye    = {0, 3.2f, 5.2f};
    scene.camera.target = {0, 0.55f, 0};
    add_lights(scene, {3, 5, 2}, scene.camera.target, 1);
    return scene;
}

/// 9,000, 65,000 and 1,024,000 triangles.
inline std::vector<std::pair<std::string, std::function<Scene()>>> scenes_of_three_sizes() {
    const auto tori = [](int around, int tube) { return [=] { return tori_scene(around, tube); }; };
    return {{"small", simple_scene}, {"medium", tori(32, 16)}, {"million", tori(125, 64)}};
}

/// The same scenes without the area light.
inline std::function<Scene()> with_point_light_alone(std::function<Scene()> make) {
    return [make = std::move(make)] {
        Scene scene = make();
        scene.lights.resize(1);
        return scene;
    };
}

/// A scene with what its benchmarks share, made at the first use.
struct SpeedStage {
    std::string name;
    std::function<Scene()> make;
    int width = 1920, height = 1080;
    Scene scene{};
    SceneFacts facts{};
    std::unique_ptr<RayScene> rays{};
    PointBatch points{};

    void prepare() {
        if (rays) return;
        scene = make();
        facts = find_facts(scene);
        rays  = std::make_unique<RayScene>(scene);
        find_points(points);
    }
    /// The G-buffer, into `batch`.
    void find_points(PointBatch& batch) const { primary_points(*rays, scene, scene.camera, width, height, batch); }
};

}  // namespace umbra
