// The lights of KHR_lights_punctual and EXT_lights_area. Internal to core.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/lights.h"

namespace umbra {

inline constexpr std::string_view kPunctualLights = "KHR_lights_punctual";
inline constexpr std::string_view kAreaLights     = "EXT_lights_area";

/// lights[index] of the extension, at the origin and shining along -z until a node places it; nothing, and a warning,
/// where its type is unknown.
[[nodiscard]] std::optional<Light> read_punctual_light(const JsonText& json, const JsonValue& v, std::size_t index,
                                                       GltfNotes& notes, std::vector<std::string>& warnings);

/// The same of EXT_lights_area: a rectangle or disk that faces along -z, of the luminance `intensity` (nits). Its I_j
/// is the luminous intensity along its axis, luminance times area.
[[nodiscard]] std::optional<Light> read_flat_light(const JsonText& json, const JsonValue& v, std::size_t index,
                                                   std::vector<std::string>& warnings);
/// Turns a light of read_flat_light, whose `direction` is that of the node already, and scales it by the largest of the
/// node's scales: one factor, so that a disk stays a disk. `along` is the node's x axis, of length 1.
void scale_area_light(const dmat4& scene_from_node, dvec3 along, Light& light);

}  // namespace umbra
