// The comparison at fixed errors: the cheapest setting of each method, scene by scene, and over all of them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "umbra/bench/trade/swept_scene.h"

namespace umbra {

/// The table of ratios to the cheapest method at errors from 0.1 to 0 of the first metric, its geometric means and
/// performance profile; false where no scene has a setting that takes part.
[[nodiscard]] nlohmann::json fixed_errors_view(const std::vector<SweptScene>& scenes,
                                               const std::vector<SweptMethod>& methods);

}  // namespace umbra
