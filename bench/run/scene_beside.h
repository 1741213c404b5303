// Scenes that a file names: files beside it, or scenes of ours.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "umbra/bench/record/field.h"

namespace umbra {

/// The file of a scene by its name; throws UsageError where there is none.
using FindScene = std::function<std::filesystem::path(const std::string& name)>;

/// The scene that a member of `file` names: a file beside it, or else by `find`. Refuses the member where neither is.
[[nodiscard]] std::filesystem::path scene_beside(const Field& name, const std::filesystem::path& file,
                                                 const FindScene& find);

}  // namespace umbra
