// The lights of KHR_lights_punctual. Internal to core.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/lights.h"

namespace umbra {

/// lights[index] of the extension, at the origin and shining along -z until a node places it; nothing, and a warning,
/// where its type is unknown.
[[nodiscard]] std::optional<Light> read_punctual_light(const JsonText& json, const JsonValue& v, std::size_t index,
                                                       GltfNotes& notes, std::vector<std::string>& warnings);

}  // namespace umbra
