// Goldens: what every method makes of the teaching scenes, as somebody looked at it and accepted it. The tests refuse
// what is not the same, be it worse or better; `umbra accept` renews.
//
//     FOLDER/SCENE/METHOD.exr    S_j planes of 96 x 54 points, lossless: channel S.<light>, NaN where the method leaves
//                                a point undefined, -1 where it says that the point is on a shadow's boundary. Compared
//                                exactly. No channel for answers that are sampled at random.
//     FOLDER/SCENE/figures.json  errors against `exact` at 320 x 180 points, {"machine": TEXT, "methods": {METHOD:
//                                {LIGHT: {FIGURE: N or [LOW, HIGH]}}}}. N: exactly that. A range, for answers that are
//                                sampled at random: six standard deviations each way from the mean over 32 seeds.
//     FOLDER/SCENE/settings/...  planes of settings other than the defaults
//     FOLDER/SCENE/compared/...  what `umbra compare` writes, of a few scenes
//
// One small file a scene and method, so that changes keep out of each other's way in merges.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/prepare.h"

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
// coded as above, sampled answers too: equal seeds give equal bits.

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
