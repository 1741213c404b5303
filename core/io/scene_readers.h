// The readers behind load_scene, one a family of formats. Internal to core.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// A scene as its file says it, everything in world space. `name`, `title` and `source` may stay empty. Lights may have
/// any names and any length of `direction`; a rectangle's `direction` follows from its edges. check_scene and
/// complete_scene do the rest.
struct SceneFile {
    Scene scene;
    bool has_camera  = false;  ///< the file says where the eye is
    bool may_be_dark = false;  ///< the file means to have no light (an explicit empty list)
};

[[nodiscard]] SceneFile read_native(const std::filesystem::path& file);  ///< .json
/// A frame of its animation, counted from 0; read_native without a frame reads the first.
[[nodiscard]] SceneFile read_native(const std::filesystem::path& file, int frame);
[[nodiscard]] SceneFile read_gltf(const std::filesystem::path& file);  ///< .gltf .glb
[[nodiscard]] SceneFile read_obj(const std::filesystem::path& file);   ///< .obj, with its .mtl
[[nodiscard]] SceneFile read_nff(const std::filesystem::path& file);   ///< .nff
[[nodiscard]] SceneFile read_ply(const std::filesystem::path& file);   ///< .ply
[[nodiscard]] SceneFile read_off(const std::filesystem::path& file);   ///< .off
[[nodiscard]] SceneFile read_stl(const std::filesystem::path& file);   ///< .stl

/// The reader that the ending names; `endings` are those allowed here. Throws InputError that lists them.
[[nodiscard]] SceneFile read_by_ending(const std::filesystem::path& file, const std::vector<std::string_view>& endings);

/// What every format shares, first half: refuses what cannot be rendered and changes nothing. Numbers are finite and
/// within those of io/limits.h, indices in range, the camera of the file can see, the lights can shine. Throws
/// InputError.
void check_scene(const SceneFile& read, const std::filesystem::path& file);

/// The second half, for what check_scene accepted: gives a camera that frames the scene and a light where there are
/// none, makes directions and normals unit, and light names unique and fit for a channel `S.<name>`. Adds warnings of
/// what it assumed and of what cannot be seen. Throws InputError where the scene is too large for a camera outside it.
[[nodiscard]] Scene complete_scene(SceneFile&& read, const std::filesystem::path& file);

}  // namespace umbra
