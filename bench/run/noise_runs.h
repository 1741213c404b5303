// The noise of sampling methods: the same question with other random numbers.
#pragma once

#include <optional>
#include <vector>

#include "umbra/bench/run/run.h"
#include "umbra/core/errors/noise.h"

namespace umbra {

/// Runs of a method with other seeds than its own, for its noise. The relative error of a variance from K runs is
/// sqrt(2 / (K - 1)) at one point, and nothing over the thousands of a penumbra.
inline constexpr int kNoiseRuns = 8;

/// One meter a light, fed with `runs` runs; empty for methods that have no seed (their answers are always the same)
/// and for lights without an area (all their samples are one point).
/// `work` is on this scene; what it has built is shared.
[[nodiscard]] std::vector<std::optional<NoiseMeter>> noise_runs(const MethodAtWork& work, const Scene& scene,
                                                                const PointBatch& points, int runs = kNoiseRuns);

}  // namespace umbra
