// The camera of a native scene file. Internal to core.
#pragma once

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/camera.h"

namespace umbra {

/// Relative to `origin`, which is in the file's numbers.
[[nodiscard]] Camera read_native_camera(const JsonText& json, const JsonValue& v, const dvec3& origin);

}  // namespace umbra
