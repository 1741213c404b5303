// Scene files: native JSON, glTF 2.0, OBJ/MTL, NFF, and PLY, OFF, STL as bare meshes.
#pragma once

#include <filesystem>
#include <string>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// Reads any scene file by its ending: .json .gltf .glb .obj .nff .ply .off .stl
/// Everything is in world space afterwards. What the file does not say (camera, lights, ...) gets a documented default
/// and a sentence in Scene::warnings. Throws InputError; never returns half a scene. Thread-safe.
///
/// FILE@N, where no file has that name, is frame N of the animation of FILE, a native scene; FILE alone is frame 0. Its
/// Scene::name has @N, too.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file);

/// FILE and "@N"; the latter is empty where a file has the whole name, or where it does not end in a number after an @.
struct FrameOfFile {
    std::string file, frame;
};
[[nodiscard]] FrameOfFile split_frame(const std::string& file);

/// Scene::name of what load_scene reads: "day" of "scenes/day.json", "day@3" of "scenes/day.json@3".
[[nodiscard]] std::string scene_name(const std::filesystem::path& file);

}  // namespace umbra
