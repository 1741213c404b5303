// The sun of a native scene file, by place and time. Internal to core.
#pragma once

#include "umbra/core/io/json_text.h"

namespace umbra {

/// The direction of the sun's light in a scene whose y points up, of length 1, by the members latitude, longitude, time
/// and north. Fails where the sun is not above the horizon.
[[nodiscard]] vec3 read_sun(const JsonText& json, const JsonValue& v);

}  // namespace umbra
