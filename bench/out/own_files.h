// Which files in an output folder are ours: others are neither removed nor written over.
#pragma once

#include <filesystem>

namespace umbra {

/// For a folder that a new result replaces as a whole. Throws InputError that names the first thing in it that no
/// results.json of ours accounts for. A folder that is missing, empty, or a result of ours passes.
void check_replaceable(const std::filesystem::path& folder);

/// For a folder into which a results.json and pages are written beside other files. Throws InputError where one of them
/// is there and is not ours.
void check_writable_beside(const std::filesystem::path& folder);

}  // namespace umbra
