// Questions about a path, answered without exceptions: names come from files and command lines, and may be too long or
// forbidden.
#pragma once

#include <filesystem>

namespace umbra {

/// All three are false where the file system refuses the name.
[[nodiscard]] inline bool is_there(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}
[[nodiscard]] inline bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}
[[nodiscard]] inline bool is_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

}  // namespace umbra
