// What is asked of goldens, and one that is not as it was.
#pragma once

#include <cstdint>
#include <filesystem>
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
    std::vector<std::string> lines;  ///< what changed, a sentence each
    std::filesystem::path pictures;  ///< where reference, result and difference lie; empty: nowhere
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

}  // namespace umbra
