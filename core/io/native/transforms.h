// The "transform" of an object in a native scene file. Internal to core.
#pragma once

#include <vector>

#include "umbra/core/io/json_text.h"
#include "umbra/core/io/native/parts.h"

namespace umbra {

/// A list of steps, each applied to the result of those before it. The step "fit" depends on the extent of `parts`.
[[nodiscard]] dmat4 read_transform(const JsonText& json, const JsonValue& v, const std::vector<NativePart>& parts);

}  // namespace umbra
