// The limits that readers accept, each once: ranges of numbers and sizes of scenes. Internal to core.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// A range of numbers, its ends included, and how a message describes it.
struct Range {
    double min = 0, max = 0;
    std::string_view words;  ///< "a number from 0 to 1"

    [[nodiscard]] constexpr bool holds(double x) const { return x >= min && x <= max; }  ///< false for NaN
    /// The same for a number that was rounded to float after it was read.
    [[nodiscard]] constexpr bool holds(float x) const {
        return x >= static_cast<float>(min) && x <= static_cast<float>(max);
    }
};

inline constexpr Range kAnyNumber{-kMaxCoordinate, kMaxCoordinate, "a number from -1e18 to 1e18"};
inline constexpr Range kPositive{1e-18, kMaxCoordinate, "a positive number, from 1e-18 to 1e18"};
inline constexpr Range kNotNegative{0, kMaxCoordinate, "a number from 0 to 1e18"};
inline constexpr Range kShare{0, 1, "a number from 0 to 1"};
inline constexpr Range kRotation{-1e6, 1e6, "an angle in degrees, from -1e6 to 1e6"};
inline constexpr Range kCrease{0, 180, "an angle in degrees, from 0 to 180"};
inline constexpr Range kFieldOfView{0.001, 179.9, "an angle in degrees, from 0.001 to 179.9"};
inline constexpr Range kConeAngle{0.001, 90, "an angle in degrees, from 0.001 to 90"};
inline constexpr Range kInnerConeAngle{0, 90, "an angle in degrees, from 0 to 90"};
// The same in radians. Exporters write the float next to pi/2, which is a little above it.
inline constexpr Range kFieldOfViewRadians{0.001 * kPi / 180, 179.9 * kPi / 180,
                                           "an angle in radians, from 1.75e-5 to 3.1398"};
inline constexpr Range kConeAngleRadians{0.001 * kPi / 180, static_cast<double>(static_cast<float>(kPi / 2)),
                                         "an angle in radians, from 1.75e-5 to pi/2"};

// Refused before memory is taken, in one scene.
inline constexpr std::uint64_t kMaxTriangles = 50'000'000;
inline constexpr std::size_t kMaxLights      = 1024;
inline constexpr std::uint64_t kMaxVertices  = 0xfffffffeu;  ///< as many as 32-bit indices can name, less one for
                                                             ///< "none"
/// A few bytes of these files make thousands of triangles, so the limit is lower than for triangles written out.
inline constexpr std::uint64_t kMaxTessellated = 20'000'000;

inline constexpr std::size_t kMaxCutTriangles = 2'000'000;  ///< that masks leave of surfaces; beyond it they are whole

inline constexpr std::size_t kMaxNativeFile = std::size_t{128} << 20;  ///< bytes: a million objects
inline constexpr int kMaxSegments           = 4096;                    ///< of a native object along one circle
inline constexpr int kMaxSteps              = 1024;  ///< along each of two directions: two million triangles at most

}  // namespace umbra
