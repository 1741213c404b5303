// Text files and folders, with errors that name them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace umbra {

/// What a file holds; nothing where it cannot be read.
[[nodiscard]] std::string bytes_of(const std::filesystem::path& file);

/// Writes a file of text as it is. Throws InputError naming it.
void write_text(const std::filesystem::path& file, std::string_view text);

/// Makes the folder and those above it where they are missing; an empty path is the working folder. Throws InputError
/// naming it.
void make_folder(const std::filesystem::path& folder);

/// A name from a file, such as a scene's, as the name of a folder that any system accepts and that is none of ours:
/// letters of any language stay, separators, control characters and dots at the ends do not, long names are cut so that
/// two of them stay two.
[[nodiscard]] std::string folder_name(const std::string& name);

}  // namespace umbra
