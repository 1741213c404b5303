// The canonical scenes: those of the report.
#pragma once

#include <filesystem>
#include <vector>

namespace umbra {

/// In the report's order, as FOLDER/canonical.txt lists them: one file name a line, # begins a comment. Throws
/// InputError.
[[nodiscard]] std::vector<std::filesystem::path> canonical_scenes(const std::filesystem::path& folder);

/// Those of them that are complete in the repository: the teaching scenes. The others, real_NAME, need meshes that are
/// obtained at set-up.
[[nodiscard]] std::vector<std::filesystem::path> teaching_scenes(const std::filesystem::path& folder);

}  // namespace umbra
