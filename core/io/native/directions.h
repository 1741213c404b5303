// Directions in native scene files. Internal to core.
#pragma once

#include <optional>
#include <string_view>

#include "umbra/core/io/json_text.h"

namespace umbra {

/// [x, y, z], not all 0; any length.
[[nodiscard]] vec3 read_direction(const JsonText& json, const JsonValue& v, std::string_view what);

/// The key "direction", or the vector from `position`, which is relative to `origin`, to "target"; `fallback` where
/// neither is given, if there is one.
[[nodiscard]] vec3 direction_or_target(const JsonText& json, const JsonFields& f, vec3 position, const dvec3& origin,
                                       std::optional<vec3> fallback);

/// "up" of a camera or rectangle: whether it is too nearly parallel to `axis` to orient anything.
[[nodiscard]] bool is_parallel(dvec3 up, dvec3 axis);

}  // namespace umbra
