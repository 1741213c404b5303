// What the first page shows: the scenes, the summary of methods by scenes, what was measured with what.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "umbra/bench/pages/report_page.h"

namespace umbra {

/// Everything that index.html shows; `files` one per scene, in the same order; `out` the folder of the page.
[[nodiscard]] nlohmann::json index_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files,
                                        const std::filesystem::path& out, const std::string& title);

}  // namespace umbra
