// The page of methods from outside: each renderer on each scene beside the truth.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "umbra/bench/pages/report_page.h"

namespace umbra {

/// Everything that renderers.html shows; `files` one per scene, in the same order; `out` the folder of the page. False where
/// no scene has a method from outside.
[[nodiscard]] nlohmann::json renderers_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files,
                                            const std::filesystem::path& out);

}  // namespace umbra
