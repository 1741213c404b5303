// Scene files: native JSON, glTF 2.0, OBJ/MTL, NFF, and PLY, OFF, STL as bare meshes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// Reads any scene file by its ending: .json .gltf .glb .obj .nff .ply .off .stl
/// Everything is in world space afterwards. Terms that the file leaves out (camera, lights, ...) get a documented
/// default and a sentence in Scene::warnings. Throws InputError; never returns half a scene. Thread-safe.
///
/// FILE@N, where no file has that name, is frame N of the animation of FILE, a native scene; FILE alone is frame 0. Its
/// Scene::name has @N, too. FILE@z of a mesh file (is_mesh_file) turns the file's z axis up; FILE alone is FILE@y.
///
/// A scene far from the file's origin is moved to it before positions are rounded to float; Scene::origin is the
/// distance.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file);
/// As if FILE, a native scene that need not be there, held this text: meshes are those beside it.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const std::string& text);

/// FILE and "@N" or "@z"; the latter is empty where a file has the whole name, or where it does not end in a number or
/// an axis (up_axis) after an @.
struct FrameOfFile {
    std::string file, frame;
};
[[nodiscard]] FrameOfFile split_frame(const std::string& file);

/// "y", "z" or "-y" as an axis.
[[nodiscard]] std::optional<UpAxis> up_axis(std::string_view name);
/// Whether the ending is of a format that says nothing of camera, light and which way is up.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);
[[nodiscard]] std::string mesh_endings();  ///< of those formats: ".obj .ply .off .stl"

/// Scene::name of the scene that load_scene reads: "day" of "scenes/day.json", "day@3" of "scenes/day.json@3", "part"
/// of "part.stl@z".
[[nodiscard]] std::string scene_name(const std::filesystem::path& file);

}  // namespace umbra
