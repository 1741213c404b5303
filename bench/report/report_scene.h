// What the page of one scene shows.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "umbra/bench/pages/report_page.h"

namespace umbra {

/// Everything that scene.html shows, except the links to its neighbours. The index of a method in `settings` gives it
/// the same mark in the charts of all pages.
[[nodiscard]] nlohmann::json scene_view(const SceneFiles& files, const std::vector<MethodRecord>& settings);

}  // namespace umbra
