// What the page of sweeps shows: each scene, and methods compared at fixed errors.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "umbra/bench/sweep/swept_scene.h"

namespace umbra {

/// Sentence, plots by metric with their fronts, and the table of all settings; `id` is the anchor of the scene.
[[nodiscard]] nlohmann::json swept_scene_view(const SweptScene& scene, const std::vector<SweptMethod>& methods,
                                              const std::string& id);

/// The table of ratios to the cheapest method at errors from 0.1 to 0 of the first metric, its geometric means and
/// performance profile; false where no scene has a setting that takes part.
[[nodiscard]] nlohmann::json fixed_errors_view(const std::vector<SweptScene>& scenes,
                                               const std::vector<SweptMethod>& methods);

}  // namespace umbra
