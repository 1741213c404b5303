// What the page of sweeps shows of one scene.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "umbra/bench/trade/swept_scene.h"

namespace umbra {

/// Sentence, plots by metric with their fronts, and the table of all settings; `id` is the anchor of the scene.
[[nodiscard]] nlohmann::json swept_scene_view(const SweptScene& scene, const std::vector<SweptMethod>& methods,
                                              const std::string& id);

/// "The camera moves 60 times a second, a light once a second, objects never."
[[nodiscard]] std::string workload_in_words(const Workload& workload);

}  // namespace umbra
