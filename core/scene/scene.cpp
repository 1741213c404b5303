#include "umbra/core/scene/scene.h"

#include <algorithm>

#include <fmt/format.h>

#include <stdexcept>

namespace umbra {

bool has_coloured_filters(const Scene& scene) {
    return scene.transparent == TransparentOccluders::multiply &&
           std::ranges::any_of(scene.objects, [&](const Object& object) {
               const vec3 passes = coloured_transmittance(scene.materials[object.material]);
               return object.triangle_count > 0 && object.switches.casts_shadows && passes != vec3(passes.r);
           });
}

void place_fixed_lights(Scene& scene) {
    const CameraFrame camera = frame(scene.camera, 1, 1);
    const auto turned        = [&](vec3 v) {
        return static_cast<double>(v.x) * camera.right + static_cast<double>(v.y) * camera.up -
               static_cast<double>(v.z) * camera.forward;
    };
    for (Light& light : scene.lights) {
        if (!light.camera_pose) continue;
        const LightPose& pose = *light.camera_pose;
        const dvec3 direction = turned(pose.direction);
        set_pose(light, {vec3(camera.eye + turned(pose.position)), vec3(glm::normalize(direction)),
                         vec3(turned(pose.edge_u)), vec3(turned(pose.edge_v)), vec3(turned(pose.along))});
        if (light.kind == LightKind::rectangle)
            light.direction = vec3(glm::normalize(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v))));
    }
}

Box bounds(const Scene& scene) {
    Box box;
    for (const uvec3& t : scene.triangles)
        for (int k = 0; k < 3; ++k) box = extend(box, scene.positions[t[k]]);
    return box;
}

dvec3 area_normal(const Scene& scene, TriangleId t) {
    const dvec3 a(scene.vertex(t, 0));
    return glm::cross(dvec3(scene.vertex(t, 1)) - a, dvec3(scene.vertex(t, 2)) - a);
}

std::uint32_t add_object(Scene& scene, std::string name, const std::vector<vec3>& positions,
                         const std::vector<vec3>& normals, const std::vector<uvec3>& triangles,
                         std::uint32_t material) {
    if (!normals.empty() && normals.size() != positions.size())
        throw std::invalid_argument(
            fmt::format("object \"{}\" has {} normals for {} positions", name, normals.size(), positions.size()));
    for (const uvec3& t : triangles)
        for (int k = 0; k < 3; ++k)
            if (t[k] >= positions.size())
                throw std::invalid_argument(
                    fmt::format("object \"{}\": a triangle names position {} of {}", name, t[k], positions.size()));

    const auto index = static_cast<std::uint32_t>(scene.objects.size());
    const auto base  = static_cast<std::uint32_t>(scene.positions.size());
    scene.objects.push_back({std::move(name), static_cast<std::uint32_t>(scene.triangles.size()),
                             static_cast<std::uint32_t>(triangles.size()), material});
    scene.positions.insert(scene.positions.end(), positions.begin(), positions.end());
    if (normals.empty())
        scene.normals.resize(scene.positions.size(), vec3(0));
    else
        scene.normals.insert(scene.normals.end(), normals.begin(), normals.end());
    // No reserve: one of the exact size for each object copies all triangles for each, quadratic in the objects.
    for (const uvec3& t : triangles) scene.triangles.push_back(t + uvec3(base));
    scene.triangle_object.resize(scene.triangles.size(), index);
    return index;
}

}  // namespace umbra
