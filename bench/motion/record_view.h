// What the pages of motion and growth read from their records alike. Internal to bench/motion.
#pragma once

#include <optional>
#include <string>

#include "umbra/bench/run/describe.h"

namespace umbra {

[[nodiscard]] inline std::string text(const Json& value) { return value.get<std::string>(); }
/// Nothing for null.
[[nodiscard]] inline std::optional<double> value(const Json& number) {
    return number.is_null() ? std::nullopt : std::optional(number.get<double>());
}

/// Whether noise lets times be ranked; it does not where the bar is not known.
[[nodiscard]] bool is_ranked(const Json& noise_bar);

/// "97.9 %": the probability with which a ratio's interval holds it; "-" where it has none.
[[nodiscard]] std::string coverage_text(const Json& ratio);

/// The share of the points of a movement's frames that the method answers; nothing where none was asked for.
[[nodiscard]] std::optional<double> answered_share(const Json& movement);

/// The terms of a page's template that say which program measured on what machine, and what failed; `place` is the
/// member of a failure that says where: "scene" or "family".
[[nodiscard]] nlohmann::json record_view(const Json& record, const char* place);

}  // namespace umbra
