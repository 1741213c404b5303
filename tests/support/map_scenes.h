// What tests of shadow maps build their scenes of, and the points at which they ask.
#pragma once

#include <string>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// One object more, of the scene's first material.
inline void add_mesh(Scene& scene, std::string name, const Mesh& mesh, vec3 by = vec3(0)) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    mat4 m(1);
    m[3]              = vec4(by, 1);
    const Mesh placed = transformed(mesh, m);
    add_object(scene, std::move(name), placed.positions, placed.normals, placed.triangles, 0);
}

inline Light point_light(vec3 position) {
    Light light;
    light.name     = "light";
    light.position = position;
    return light;
}
inline Light directional_light(vec3 direction) {  // of any length
    Light light;
    light.name      = "light";
    light.kind      = LightKind::directional;
    light.direction = direction;
    return light;
}
inline Light spot_light(vec3 position, vec3 axis, float cutoff_degrees) {
    Light light       = point_light(position);
    light.kind        = LightKind::spot;
    light.direction   = glm::normalize(axis);
    light.spot.cutoff = glm::radians(cutoff_degrees);
    return light;
}

/// n (n + 1) / 2 points inside each triangle of an object, without a raster.
inline PointBatch points_on(const Scene& scene, std::uint32_t object, int n) {
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

}  // namespace umbra
