// Text without blanks around it.
#pragma once

#include <string_view>

namespace umbra {

/// Blanks are spaces, tabs and carriage returns.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r";
    const std::size_t begin            = text.find_first_not_of(kBlanks);
    return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

}  // namespace umbra
