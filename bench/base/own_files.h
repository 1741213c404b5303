// Which files in an output folder are ours: others are neither removed nor written over.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace umbra {

/// For a folder that a new result replaces as a whole. Throws InputError that names the first thing in it that no
/// results.json of ours accounts for. A folder that is missing, empty, or a result of ours passes.
void check_replaceable(const std::filesystem::path& folder);

/// Whether the folder holds a results.json of ours, of any version, that has no such member: of another command.
[[nodiscard]] bool holds_record_without(const std::filesystem::path& folder, std::string_view key);

/// For a folder into which a results.json, pages and `more` files are written beside other files. Throws InputError
/// where one of them is there and is not ours: of `more`, one that no results.json of ours there names.
void check_writable_beside(const std::filesystem::path& folder, const std::vector<std::string>& more = {});

}  // namespace umbra
