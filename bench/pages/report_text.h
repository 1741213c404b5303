// Numbers and words as people read them. Units stand in the tables' heads.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace umbra {

inline constexpr const char* kNone = "–";  ///< where there is no number

/// Three significant digits, as 1.2·10⁻⁵ where they would stand behind too many zeros, and a minus that is one.
[[nodiscard]] std::string score(std::optional<double> value);

/// A whole number as an exponent: ⁻⁵.
[[nodiscard]] std::string superscript(int value);

/// The same as `score`, but nothing below a microsecond: a clock does not tell such times apart.
[[nodiscard]] std::string milliseconds(std::optional<double> ms);

/// Whole numbers in groups of three, parted by a narrow no-break space.
[[nodiscard]] std::string count(std::optional<double> value);

/// A share in per cent, rounded down so that 100 means all of it.
[[nodiscard]] std::string percent(std::optional<double> share);

[[nodiscard]] std::string mebibytes(std::optional<double> bytes);

/// "shadow_zbuffer" as "shadow zbuffer".
[[nodiscard]] std::string in_words(std::string key);

/// Kinds of lights ("point") and their places ("at_infinity") as results.json names them; others are left as they are.
[[nodiscard]] std::string kind_in_words(const std::string& kind);
[[nodiscard]] std::string place_in_words(const std::string& place);

/// A relative path as it may stand in an attribute: every byte that means something in a URL is encoded.
[[nodiscard]] std::string url(const std::filesystem::path& path);

}  // namespace umbra
