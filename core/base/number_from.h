// A number from text.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace umbra {

/// The number that the whole of `text` is, as std::from_chars reads it; nothing where it is none, or too large for T.
/// Of floating point "inf" and "nan" are numbers.
template <class T>
[[nodiscard]] std::optional<T> number_from(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The two numbers before and after the first `between` that the whole of `text` is, as in "640x360".
template <class T>
[[nodiscard]] std::optional<std::pair<T, T>> two_numbers_from(std::string_view text, std::string_view between) {
    const std::size_t at = text.find(between);
    if (at == std::string_view::npos) return std::nullopt;
    const auto first = number_from<T>(text.substr(0, at)), second = number_from<T>(text.substr(at + between.size()));
    return first && second ? std::optional(std::pair(*first, *second)) : std::nullopt;
}

}  // namespace umbra
