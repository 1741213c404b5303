// What is asked of goldens, and one that is not as it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/run/prepare.h"

namespace umbra {

/// Of the pictures that goldens of comparisons and of settings are made of.
inline constexpr Size kGoldenSize{64, 36};

struct GoldenOptions {
    std::filesystem::path folder{};
    std::vector<std::string> names{};  ///< "SCENE", "METHOD" or "SCENE/METHOD"; METHOD may be "compared"; empty: all
    bool renew = false;                ///< write what changed; nothing is written where nothing did
    std::filesystem::path pictures{};  ///< folder for PICTURES/SCENE.METHOD/ of what changed; empty: none
};

/// One golden that is not as it was.
struct GoldenChange {
    enum class Kind : std::uint8_t { changed, added, removed, failed };
    std::string name;  ///< "SCENE/METHOD"; "SCENE" where the reference failed
    Kind kind = Kind::changed;
    std::vector<std::string> lines{};  ///< what changed, a sentence each
    std::filesystem::path pictures{};  ///< where reference, result and difference lie; empty: nowhere
    /// The golden was made by another compiler or on another kind of machine, and nothing but points in the edge band
    /// changed: rounding, most likely.
    bool rounding = false;
};
[[nodiscard]] std::string_view to_string(GoldenChange::Kind kind);

/// Whether the options name this golden, or none at all.
[[nodiscard]] bool is_wanted(const GoldenOptions& options, const std::string& scene, std::string_view method);

/// What decides how floats are rounded here: system, compiler, whether the machine multiplies and adds in one step. Our
/// own code is compiled so that this changes nothing; Embree is not.
[[nodiscard]] std::string rounding_machine();

// Goldens of settings other than the defaults: FOLDER/SCENE/settings/METHOD.SETTINGS.exr, S_j planes of 64 x 36 points
// as golden.h has them, sampled answers too: equal seeds give equal bits.

/// A scene on which the settings make a difference.
struct GoldenSetting {
    std::string_view scene, method;  ///< "stairs", "shadow_zbuffer:filter=pcf"
};
[[nodiscard]] std::span<const GoldenSetting> golden_settings();

/// Those of the scene that are not as accepted, and files of settings that are no longer in the list; renews where
/// asked. Throws InputError.
[[nodiscard]] std::vector<GoldenChange> setting_changes(const std::filesystem::path& scene,
                                                        const GoldenOptions& options);

// Goldens of what reaches the user: FOLDER/SCENE/compared/ holds what `umbra compare` writes for a few scenes at 64 x
// 36 pixels: every PNG, the reference's linear R, G, B as EXR, and results.json without times, paths and machine.

/// One entry, "SCENE/compared", where any of the files is not as accepted; a line for each file or figure. Empty for
/// scenes without such goldens. Renews where asked. Throws InputError.
[[nodiscard]] std::vector<GoldenChange> comparison_changes(const std::filesystem::path& scene,
                                                           const GoldenOptions& options);

}  // namespace umbra
