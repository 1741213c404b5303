// Keys of what was computed: equal keys, equal answers. A key covers the bits of the scene as it was loaded, the
// settings, and the sources of the code that computes.
//
// Hashes are 128 bits of XXH3 (Yann Collet, xxHash): fast enough for meshes of a gigabyte, and of a quality that no two
// keys of a sweep are ever equal by chance. They do not protect from somebody who wants two equal ones.
#pragma once

#include <string>
#include <string_view>

#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// 32 hexadecimal digits for everything in a scene that an answer or a picture depends on: triangles, materials,
/// lights, camera, names, options; neither the file it came from nor its warnings.
[[nodiscard]] std::string scene_key(const Scene& scene);

/// 32 hexadecimal digits for the sources of a method: its room, what all methods share, and what counts errors; of one
/// from outside for what it is made of (text_of_outside). Throws std::logic_error for a method of neither kind.
[[nodiscard]] std::string code_key(const MethodInfo& method);

/// One key for several texts in their order.
[[nodiscard]] std::string combined_key(std::initializer_list<std::string_view> parts);

}  // namespace umbra
