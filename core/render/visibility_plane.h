// One light's S_j plane: what methods write and errors are found in.
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/scene/lights.h"

namespace umbra {

/// A value and a flag a point. Values of undefined points mean nothing.
struct VisibilityPlane {
    std::vector<float> s;               ///< [0, 1]
    std::vector<std::uint8_t> defined;  ///< kUndefined, kDefined, kOnBoundary or kGuess
};

/// What `defined` says of a point.
inline constexpr std::uint8_t kUndefined  = 0;  ///< the method cannot tell
inline constexpr std::uint8_t kDefined    = 1;
inline constexpr std::uint8_t kOnBoundary = 2;  ///< the way to the light touches an edge or a vertex and nothing more:
                                                ///< no method is wrong there. Only exact methods say so

inline constexpr std::uint8_t kGuess = 3;  ///< a reference too dear for all points was not asked for this one: s is
                                           ///< near enough to say where boundaries are, and judges nothing

/// What counts as a wrong S_j: for lights whose S_j is 0 or 1, the other one; for area lights, a difference that shows
/// in a penumbra and that the noise of a sampled reference does not reach.
inline constexpr float kHardTolerance = 0.5f;
inline constexpr float kAreaTolerance = 0.1f;
[[nodiscard]] constexpr float visibility_tolerance(LightKind kind) {
    return is_area(kind) ? kAreaTolerance : kHardTolerance;
}

}  // namespace umbra
