// A text file and positions in it: messages with line, column, the line itself and a caret. Internal to core.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace umbra {

/// Whether a line ends at text[i], i < text.size(): LF, CR LF (at its LF), or CR alone.
[[nodiscard]] inline bool ends_line(std::string_view text, std::size_t i) {
    return text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'));
}
/// The end of the line that `at` <= text.size() lies in: a character for which ends_line() holds, or the end of the
/// text.
[[nodiscard]] inline std::size_t line_end(std::string_view text, std::size_t at) {
    while (at < text.size() && !ends_line(text, at)) ++at;
    return at;
}

struct SourceText {
    std::string file;  ///< as the user named it
    std::string text;

    /// Throws InputError: "FILE:LINE:COLUMN: message", then the line that `offset` lies in with a caret below it.
    [[noreturn]] void fail(std::size_t offset, std::string_view message) const;
};

/// Reads a whole regular file, at most `max_bytes`, asked for before memory is taken. Throws InputError that says why
/// it can't (missing, a folder, a device, unreadable ...).
[[nodiscard]] SourceText read_text(const std::filesystem::path& file, std::size_t max_bytes = std::size_t{1} << 30);

}  // namespace umbra
