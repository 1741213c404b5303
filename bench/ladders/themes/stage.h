// What the scenes of the ladders are put together from: bodies, a point light, the sun, a camera that sees the floor.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "umbra/core/scene/primitives.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// An empty scene with one grey material and a picture of 128 x 96: large enough for an interior beside the edge band.
inline Scene empty_stage() {
    Scene scene;
    scene.materials.push_back({.name = "grey"});
    scene.width  = 128;
    scene.height = 96;
    return scene;
}

inline void add_body(Scene& scene, const std::string& name, const Mesh& mesh, const mat4& placed = mat4(1)) {
    const Mesh moved = transformed(mesh, placed);
    add_object(scene, name, moved.positions, moved.normals, moved.triangles, 0);
}

/// An empty stage with a square floor in y = 0, cut into this many cells a side.
inline Scene floor_stage(float side, int cells = 1) {
    Scene scene = empty_stage();
    add_body(scene, "floor", make_plane(side, side, cells));
    return scene;
}

/// A rectangle that faces up, between two opposite corners of one height, that with the smaller x and z first.
inline void add_lid(Scene& scene, dvec3 from, dvec3 to) {
    const dvec3 right{to.x, from.y, from.z}, left{from.x, from.y, to.z};
    add_object(scene, "lid", {vec3(from), vec3(right), vec3(to), vec3(left)}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
}

inline mat4 at(vec3 place) { return glm::translate(mat4(1), place); }

inline Light& add_point_light(Scene& scene, vec3 position) {
    Light light;
    light.name     = scene.lights.empty() ? "light" : "light_" + std::to_string(scene.lights.size() + 1);
    light.position = position;
    return scene.lights.emplace_back(light);
}

inline void add_sun(Scene& scene, vec3 direction) {
    Light& sun    = scene.lights.emplace_back();
    sun.name      = "sun";
    sun.kind      = LightKind::directional;
    sun.direction = direction;
}

inline void look(Scene& scene, vec3 eye, vec3 target, float fov_y = 45) {
    scene.camera.eye    = eye;
    scene.camera.target = target;
    scene.camera.fov_y  = fov_y;
}

/// A floor of 8 x 8, on it a box of 2 x 2 x 2 and above it a tetrahedron in the air, one light; all coordinates are
/// multiples of 1/2, so that the shape survives rough rounding.
inline Scene harmless_stage() {
    Scene scene = floor_stage(8);
    add_body(scene, "box", make_box(vec3(2)), at({-1, 1, 0}));
    add_object(scene, "tetrahedron", {{1, 2, -1}, {3, 2, -1}, {2, 2, 1}, {2, 4, 0}}, {},
               {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}, 0);
    add_point_light(scene, {4, 6, 1.5f});
    look(scene, {-1, 8, 7}, {0, 0.5f, 0}, 38);
    return scene;
}

/// Rungs 10^first, and so on to 10^last, growing or shrinking; each as a literal is rounded.
inline std::vector<double> powers_of_ten(int first, int last) {
    std::vector<double> rungs;
    const int step = first < last ? 1 : -1;
    for (int n = first; n != last + step; n += step) rungs.push_back(std::stod("1e" + std::to_string(n)));
    return rungs;
}

/// From 0.1 to 10^-7, and then 0.
inline std::vector<double> tenths_to_0() {
    std::vector<double> rungs = powers_of_ten(-1, -7);
    rungs.push_back(0);
    return rungs;
}

}  // namespace umbra
