// The canonical scenes: those of the report.
#pragma once

#include <filesystem>
#include <vector>

#include "umbra/shadows/method.h"

namespace umbra {

/// In the report's order, as FOLDER/canonical.txt lists them: a file name a line, and behind it names of methods; #
/// begins a comment. Throws InputError.
[[nodiscard]] std::vector<std::filesystem::path> canonical_scenes(const std::filesystem::path& folder);

/// Those of them that are complete in the repository: the teaching scenes. The others, real_NAME, need meshes that are
/// obtained at set-up.
[[nodiscard]] std::vector<std::filesystem::path> teaching_scenes(const std::filesystem::path& folder);

/// Whether the method runs on a scene's file where nobody says which methods: on every scene, or because the list of
/// canonical scenes beside the file names it there.
[[nodiscard]] bool runs_by_itself(const MethodInfo& method, const std::filesystem::path& scene);

}  // namespace umbra
