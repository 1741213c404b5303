// The lights of a native scene file. Internal to core.
#pragma once

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/lights.h"

namespace umbra {

[[nodiscard]] Light read_native_light(const JsonText& json, const JsonValue& v);

}  // namespace umbra
