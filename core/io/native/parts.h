// Bodies of a native scene file under construction. Internal to core.
#pragma once

#include <cstdint>
#include <string>

#include "umbra/core/scene/primitives.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// A part that becomes one object of the scene.
struct NativePart {
    std::string name;
    Mesh mesh;
    std::uint32_t material = 0;  ///< index into Scene::materials
    dvec3 origin{0};             ///< positions of the mesh are relative to it
    ObjectSwitches switches{};
};

}  // namespace umbra
