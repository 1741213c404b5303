// The readers behind load_scene, one a family of formats. Internal to core.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/io/reading.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// A scene as its file says it, everything in world space, relative to Reading::origin. `name`, `title` and `source`
/// may stay empty. Lights may have any names and any length of `direction`; a rectangle's `direction` follows from its
/// edges. check_scene and complete_scene do the rest.
struct SceneFile {
    Scene scene;
    bool has_camera  = false;  ///< the file says where the eye is
    bool may_be_dark = false;  ///< the file means to have no light (an explicit empty list)
    bool has_origin  = false;  ///< the file states the origin of its numbers: Scene::origin
    Box at_rest;               ///< bounds of the objects before an animation moves them; empty: those of the scene
};

/// .json: the frame of its animation that `reading` names. The axis that points up is that of mesh files alone. Where
/// the scene is to be moved (local_origin), and `reading` has no origin yet, it has its objects alone.
[[nodiscard]] SceneFile read_native(const std::filesystem::path& file, const Reading& reading);
[[nodiscard]] SceneFile read_gltf(const std::filesystem::path& file, const Reading& reading);  ///< .gltf .glb
[[nodiscard]] SceneFile read_obj(const std::filesystem::path& file, const Reading& reading);   ///< .obj, with its .mtl
[[nodiscard]] SceneFile read_nff(const std::filesystem::path& file, const Reading& reading);   ///< .nff
[[nodiscard]] SceneFile read_ply(const std::filesystem::path& file, const Reading& reading);   ///< .ply
[[nodiscard]] SceneFile read_off(const std::filesystem::path& file, const Reading& reading);   ///< .off
[[nodiscard]] SceneFile read_stl(const std::filesystem::path& file, const Reading& reading);   ///< .stl

/// The reader that the ending names; `endings` are those allowed here. A file whose scene lies far from its origin is
/// read again relative to an origin of its own (local_origin), which Scene::origin then says. Throws InputError that
/// lists the endings, or where another axis than y is to point up of a file that says itself which does.
[[nodiscard]] SceneFile read_by_ending(const std::filesystem::path& file, const std::vector<std::string_view>& endings,
                                       Reading reading = {});

/// The first half of loading that every format shares: refuses scenes that cannot be rendered and changes nothing.
/// Numbers are finite and within those of io/limits.h, indices in range, the camera of the file can see, the lights can
/// shine. Throws InputError.
void check_scene(const SceneFile& read, const std::filesystem::path& file);

/// The second half, for scenes that check_scene accepted: gives a camera that frames the scene and a light where there
/// are none, makes directions and normals unit, and light names unique and fit for a channel `S.<name>`. Adds warnings
/// of its assumptions and of lights that cannot be seen. Throws InputError where the scene is too large for a camera
/// outside it.
[[nodiscard]] Scene complete_scene(SceneFile&& read, const std::filesystem::path& file);

}  // namespace umbra
