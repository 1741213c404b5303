// Goldens: what every method makes of the teaching scenes, as somebody looked at it and accepted it. The tests refuse
// what is not the same, be it worse or better; `umbra accept` renews.
//
//     FOLDER/SCENE/METHOD.exr    S_j planes of 96 x 54 points, lossless: channel S.<light>, NaN where the method leaves
//                                a point undefined, -1 where it says that the point is on a shadow's boundary. Compared
//                                exactly. No channel for answers that are sampled at random.
//     FOLDER/SCENE/figures.json  errors against `exact` at 320 x 180 points, {"machine": TEXT, "methods": {METHOD:
//                                {LIGHT: {FIGURE: N or [LOW, HIGH]}}}}. N: exactly that. A range, for answers that are
//                                sampled at random: six standard deviations each way from the mean over 32 seeds.
//     FOLDER/SCENE/settings/...  planes of settings other than the defaults (golden_change.h)
//     FOLDER/SCENE/compared/...  what `umbra compare` writes, of a few scenes (golden_change.h)
//
// One small file a scene and method, so that changes keep out of each other's way in merges.
#pragma once

#include <filesystem>
#include <vector>

#include "umbra/bench/golden/golden_change.h"

namespace umbra {

/// Runs all methods on the scene and compares them with their goldens. Empty where all is the same. A method that
/// throws has an entry that says so, and its golden stays; so do all of the scene where the reference throws. Throws
/// InputError.
[[nodiscard]] std::vector<GoldenChange> golden_changes(const std::filesystem::path& scene,
                                                       const GoldenOptions& options);

/// Goldens of scenes that are not among these.
[[nodiscard]] std::vector<GoldenChange> golden_leftovers(const std::vector<std::filesystem::path>& scenes,
                                                         const GoldenOptions& options);

/// Throws UsageError where a name is neither one of these scenes nor a method.
void check_golden_names(const std::vector<std::filesystem::path>& scenes, const GoldenOptions& options);

}  // namespace umbra
