#include "umbra/bench/pages/values_call.h"

#include <fmt/format.h>

namespace umbra {
namespace {

constexpr std::string_view kCall = "umbraValues(", kEnd = ");\n";

}  // namespace

std::string values_call(const Json& values) {
    return fmt::format("{}{}{}", kCall, values.dump(-1, ' ', true, Json::error_handler_t::replace), kEnd);
}

std::optional<std::string> checked_values(std::string_view script) {
    if (script.size() < kCall.size() + kEnd.size() || !script.starts_with(kCall) || !script.ends_with(kEnd))
        return std::nullopt;
    script.remove_prefix(kCall.size());
    script.remove_suffix(kEnd.size());
    const Json values = Json::parse(script, nullptr, false);
    if (!values.is_object()) return std::nullopt;
    return values_call(values);
}

}  // namespace umbra
