// Numbers and words as people read them. Units are in the heads of the tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace umbra {

inline constexpr const char* kNone = "–";  ///< where there is no number

/// Three significant digits, as 1.2·10⁻⁵ where more than four zeros would lead, with a true minus sign.
[[nodiscard]] std::string score(std::optional<double> value);

/// A whole number as an exponent: ⁻⁵.
[[nodiscard]] std::string superscript(int value);

/// The same as `score`, but nothing below a microsecond, which clocks do not resolve.
[[nodiscard]] std::string milliseconds(std::optional<double> ms);

/// Whole numbers in groups of three with a narrow no-break space between.
[[nodiscard]] std::string count(std::optional<double> value);

/// A fraction in per cent, to the nearest tenth. 100 is all of it and 0 nothing: what is nearly so is "> 99.9" or
/// "< 0.1".
[[nodiscard]] std::string percent(std::optional<double> fraction);

[[nodiscard]] std::string mebibytes(std::optional<double> bytes);

/// "shadow_zbuffer" as "shadow zbuffer".
[[nodiscard]] std::string in_words(std::string_view key);

/// Kinds of lights ("point") and their positions ("at_infinity") as results.json names them; others are left as they
/// are.
[[nodiscard]] std::string kind_in_words(const std::string& kind);
[[nodiscard]] std::string place_in_words(const std::string& place);

/// "1 point", "2 points": `count` and the noun, which takes an s.
[[nodiscard]] std::string counted(double n, const std::string& noun);

/// Figures in a text as German and Greek write them: a comma for each point between digits.
[[nodiscard]] std::string with_decimal_comma(std::string text);

/// A command line without the folders of the machine that it ran on: "/home/x/scenes/a.json" as "a.json".
[[nodiscard]] std::string without_folders(const std::string& command);

/// The text with U+FFFD for what is not UTF-8.
[[nodiscard]] std::string utf8_text(const std::string& text);

/// Text for an element or an attribute of XML: markup and line ends are escaped, other control characters become "?",
/// and what is not UTF-8 becomes U+FFFD.
[[nodiscard]] std::string xml_text(const std::string& text);

/// A test case of JUnit XML.
struct JunitCase {
    std::string classname, name;
    std::string problem{};                  ///< "failure" or "error"; empty: it is passed
    std::string type{}, message{}, text{};  ///< of the problem: its kind, one line, all of it
};
/// JUnit XML of one suite.
[[nodiscard]] std::string junit_text(const std::string& suite, const std::vector<JunitCase>& cases);

/// A relative path for an attribute: every byte with a meaning in a URL is encoded.
[[nodiscard]] std::string url(const std::filesystem::path& path);
/// The path that `url` made such an address of.
[[nodiscard]] std::filesystem::path path_of_url(const std::string& url);

}  // namespace umbra
