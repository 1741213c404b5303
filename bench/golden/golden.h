// Goldens: what every method makes of the teaching scenes, as somebody looked at it and accepted it. The tests refuse
// what is not the same, be it worse or better; `umbra accept` renews.
//
//     FOLDER/SCENE/METHOD.exr    S_j planes of 96 x 54 points, lossless: channel S.<light>, NaN where the method leaves
//                                a point undefined, -1 where it says that the point is on a shadow's boundary. Compared
//                                exactly. No channel for answers that are sampled at random.
//     FOLDER/SCENE/figures.json  errors against `exact` at 320 x 180 points, {"machine": TEXT, "methods": {METHOD:
//                                {LIGHT: {FIGURE: N or [LOW, HIGH]}}}}. N: exactly that. A range, for answers that are
//                                sampled at random: six standard deviations each way from the mean over 32 seeds.
//
// One small file a scene and method, so that changes keep out of each other's way in merges.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/run/run.h"

namespace umbra {

struct GoldenOptions {
    std::filesystem::path folder{};
    std::vector<std::string> names{};  ///< "SCENE", "METHOD" or "SCENE/METHOD"; empty: all
    bool renew = false;                ///< write what changed; nothing is written where nothing did
    std::filesystem::path pictures{};  ///< folder for PICTURES/SCENE.METHOD/ of what changed; empty: none
};

/// One golden that is not as it was.
struct GoldenChange {
    enum class Kind : std::uint8_t { changed, added, removed };
    std::string name;  ///< "SCENE/METHOD"
    Kind kind = Kind::changed;
    std::vector<std::string> lines;  ///< what changed, a sentence each
    std::filesystem::path pictures;  ///< where reference, result and difference lie; empty: nowhere
    /// The golden was made by another compiler or on another kind of machine, and nothing but points in the edge band
    /// changed: rounding, most likely.
    bool rounding = false;
};
[[nodiscard]] std::string_view to_string(GoldenChange::Kind kind);

/// Runs all methods on the scene and holds them against their goldens. Empty where all is the same. Throws InputError.
[[nodiscard]] std::vector<GoldenChange> golden_changes(const std::filesystem::path& scene,
                                                       const GoldenOptions& options);

/// Goldens of scenes that are not among these.
[[nodiscard]] std::vector<GoldenChange> golden_leftovers(const std::vector<std::filesystem::path>& scenes,
                                                         const GoldenOptions& options);

/// Throws UsageError where a name is neither one of these scenes nor a method.
void check_golden_names(const std::vector<std::filesystem::path>& scenes, const GoldenOptions& options);

/// What decides how floats are rounded here: system, compiler, whether the machine multiplies and adds in one step. Our
/// own code is compiled so that this changes nothing; Embree is not.
[[nodiscard]] std::string rounding_machine();

/// The method's answer is an estimate that depends on a seed.
[[nodiscard]] bool is_sampled(const MethodChoice& choice, const Light& light);

}  // namespace umbra
