// The script values.js of a comparison: one call with JSON, umbraValues({...}).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "umbra/bench/base/field.h"

namespace umbra {

/// In ASCII, and safe wherever a script is.
[[nodiscard]] std::string values_call(const Json& values);

/// The call again, from the text of a file that may be anything; nothing where that is no such call with JSON alone, so
/// that a report never hands out a stranger's script.
[[nodiscard]] std::optional<std::string> checked_values(std::string_view script);

}  // namespace umbra
