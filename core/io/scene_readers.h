// The readers behind load_scene, one a family of formats. Internal to core.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// A scene as its file says it, everything in world space. `name`, `title` and `source` may stay empty. Lights may have
/// any names and any length of `direction`; a rectangle's `direction` follows from its edges. finish_scene does the
/// rest.
struct SceneFile {
    Scene scene;
    bool has_camera  = false;  ///< the file says where the eye is
    bool may_be_dark = false;  ///< the file means to have no light (an explicit empty list)
};

[[nodiscard]] SceneFile read_native(const std::filesystem::path& file);     ///< .json
[[nodiscard]] SceneFile read_gltf(const std::filesystem::path& file);       ///< .gltf .glb
[[nodiscard]] SceneFile read_obj(const std::filesystem::path& file);        ///< .obj, with its .mtl
[[nodiscard]] SceneFile read_nff(const std::filesystem::path& file);        ///< .nff
[[nodiscard]] SceneFile read_bare_mesh(const std::filesystem::path& file);  ///< .ply .off .stl

/// The reader that the ending names; `endings` are those allowed here. Throws InputError that lists them.
[[nodiscard]] SceneFile read_by_ending(const std::filesystem::path& file, const std::vector<std::string_view>& endings);

/// What every format shares. Checks that numbers are finite and within kMaxCoordinate, that indices are in range, that
/// the camera can see and the lights can shine; makes light names unique and fit for a channel `S.<name>`, directions
/// unit; gives a camera that frames the scene and a light where there are none, and says so. Throws InputError.
[[nodiscard]] Scene finish_scene(SceneFile&& read, const std::filesystem::path& file);

/// Refused before memory is taken, in one scene.
inline constexpr std::uint64_t kMaxTriangles = 50'000'000;
inline constexpr std::size_t kMaxLights      = 1024;

}  // namespace umbra
