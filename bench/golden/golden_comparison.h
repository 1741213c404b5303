// Goldens of what reaches the user: FOLDER/SCENE/compared/ holds what `umbra compare` writes for a few scenes at 64 x
// 36 pixels: every PNG, the reference's linear R, G, B as EXR, and results.json without times, paths and machine.
#pragma once

#include <filesystem>
#include <vector>

#include "umbra/bench/golden/golden_change.h"

namespace umbra {

/// One entry, "SCENE/compared", where any of the files is not as accepted; a line for each file or figure. Empty for
/// scenes without such goldens. Renews where asked. Throws InputError.
[[nodiscard]] std::vector<GoldenChange> comparison_changes(const std::filesystem::path& scene,
                                                           const GoldenOptions& options);

}  // namespace umbra
