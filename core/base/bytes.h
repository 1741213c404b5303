// Numbers out of bytes, for the readers of binary files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace umbra {

/// The number whose sizeof(T) bytes begin at `bytes`, at any alignment, in the given order.
template <class T>
[[nodiscard]] T load_number(const char* bytes, std::endian order = std::endian::little) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

}  // namespace umbra
