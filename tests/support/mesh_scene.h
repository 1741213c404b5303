// A scene of one object, of the plain material.
#pragma once

#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

inline Scene scene_of(const std::vector<vec3>& positions, const std::vector<uvec3>& triangles) {
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "object", positions, {}, triangles, 0);
    return scene;
}

}  // namespace umbra
