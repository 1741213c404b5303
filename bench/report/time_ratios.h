// Which method is faster, and by how much, as far as the samples of a run in turns can say.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "umbra/bench/run/results.h"

namespace umbra {

/// A row for each method with its ratio to the fastest for each kind of movement: "fastest", "no difference", the ratio
/// with its interval and what that covers, or the ratio alone, of fewer than six rounds; and the noise bars behind it.
/// false where the record has no times in turns.
[[nodiscard]] nlohmann::json time_ratio_view(const Results& results);

}  // namespace umbra
