// The tables of a scene's page.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "umbra/bench/run/results.h"

namespace umbra {

/// Counts and errors of S: a group of rows per light. Columns that no method fills are left out.
[[nodiscard]] nlohmann::json error_view(const Results& results);

/// Where errors occur and what causes them: a group of rows per light.
[[nodiscard]] nlohmann::json cause_view(const Results& results);

/// Phases, movements and memory; by light where there are several; what all methods share.
[[nodiscard]] nlohmann::json time_view(const Results& results);

/// Requirements of the scene, and its objects with the faults of their meshes.
[[nodiscard]] nlohmann::json fact_view(const FactsRecord& facts);

}  // namespace umbra
