#include "umbra/bench/base/shell.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/core/base/utf8.h"

namespace umbra {

std::string shell_quoted(const std::string& text) {
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
    bool plain            = std::none_of(text.begin(), text.end(), is_control);
    for (std::size_t at = 0; plain && at < text.size();) {
        const std::size_t length = utf8_length(text, at);
        plain                    = length > 0;
        at += length;
    }
    std::string word = plain ? "'" : "$'";
    for (const char c : text) {
        if (plain)
            word += c == '\'' ? std::string("'\\''") : std::string(1, c);
        else if (is_control(c) || static_cast<unsigned char>(c) >= 0x80)
            word += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
        else
            word += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    }
    return word + "'";
}

}  // namespace umbra
