// Characters of UTF-8 in text from outside, which may be anything.
#pragma once

#include <cstddef>
#include <string_view>

namespace umbra {

/// Length of the UTF-8 character at `at` < text.size(); 0 where there is none.
[[nodiscard]] inline std::size_t utf8_length(std::string_view text, std::size_t at) {
    const auto byte         = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::size_t bytes = byte(at) < 0x80   ? 1
                              : byte(at) < 0xc2 ? 0
                              : byte(at) < 0xe0 ? 2
                              : byte(at) < 0xf0 ? 3
                              : byte(at) < 0xf5 ? 4
                                                : 0;
    if (at + bytes > text.size()) return 0;
    for (std::size_t i = at + 1; i < at + bytes; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    return bytes;
}

}  // namespace umbra
