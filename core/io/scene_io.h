// Scene files: native JSON, glTF 2.0, OBJ/MTL, NFF, and PLY, OFF, STL as bare meshes.
#pragma once

#include <filesystem>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// Reads any scene file by its ending: .json .gltf .glb .obj .nff .ply .off .stl
/// Everything is in world space afterwards. What the file does not say (camera, lights, ...) gets a documented default
/// and a sentence in Scene::warnings. Throws InputError; never returns half a scene. Thread-safe.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file);

}  // namespace umbra
