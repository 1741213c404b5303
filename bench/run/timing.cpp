#include "umbra/bench/run/timing.h"

#include <algorithm>

#include "umbra/bench/statistics/statistics.h"

namespace umbra {

Timing timing_of(std::span<const double> samples) {
    const double middle         = median(samples);
    const auto [least, largest] = std::minmax_element(samples.begin(), samples.end());
    return {middle, *least, *largest, static_cast<int>(samples.size())};
}

}  // namespace umbra
