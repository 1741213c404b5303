// A text file and positions in it: messages with line, column, the line itself and a caret. Internal to core.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace umbra {

struct SourceText {
    std::string file;  ///< as the user named it
    std::string text;

    /// Throws InputError: "FILE:LINE:COLUMN: message", then the line that `offset` lies in with a caret below it.
    [[noreturn]] void fail(std::size_t offset, std::string_view message) const;
};

/// Reads a whole file, at most `max_bytes`. Throws InputError that says why it can't (missing, a folder, unreadable
/// ...).
[[nodiscard]] SourceText read_text(const std::filesystem::path& file, std::size_t max_bytes = std::size_t{1} << 30);

}  // namespace umbra
