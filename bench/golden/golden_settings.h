// Goldens of settings other than the defaults: FOLDER/SCENE/settings/METHOD.SETTINGS.exr, S_j planes of 64 x 36 points
// as golden.h has them, sampled answers too: equal seeds give equal bits.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "umbra/bench/golden/golden_change.h"

namespace umbra {

/// A scene on which the settings make a difference.
struct GoldenSetting {
    std::string_view scene, method;  ///< "stairs", "shadow_zbuffer:filter=pcf"
};
[[nodiscard]] std::span<const GoldenSetting> golden_settings();

/// Those of the scene that are not as accepted, and files of settings that are no longer in the list; renews where
/// asked. Throws InputError.
[[nodiscard]] std::vector<GoldenChange> setting_changes(const std::filesystem::path& scene,
                                                        const GoldenOptions& options);

}  // namespace umbra
