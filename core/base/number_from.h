// A number from text.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace umbra {

/// The number that the whole of `text` is, as std::from_chars reads it; nothing where it is none, or too large for T.
/// Of floating point "inf" and "nan" are numbers.
template <class T>
[[nodiscard]] std::optional<T> number_from(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace umbra
