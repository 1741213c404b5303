// A vector as messages print it. Internal to core.
#pragma once

#include <fmt/format.h>

#include <string>

#include "umbra/core/base/math.h"

namespace umbra {

/// "(1, 0.5, -2e+10)".
[[nodiscard]] inline std::string vector_text(vec3 v) { return fmt::format("({:g}, {:g}, {:g})", v.x, v.y, v.z); }

}  // namespace umbra
