// Several times of one thing as one figure.
#pragma once

#include <span>

#include "umbra/bench/run/run.h"

namespace umbra {

/// Of samples in any order, milliseconds. Throws std::logic_error where there is none.
[[nodiscard]] Timing timing_of(std::span<const double> samples);

}  // namespace umbra
