// JSON as records hold it.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace umbra {

using Json = nlohmann::ordered_json;

/// As files hold it: indented, with a newline at the end; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const Json& record);
[[nodiscard]] Json number(double value);  ///< null where it is not finite: JSON has no infinity

}  // namespace umbra
