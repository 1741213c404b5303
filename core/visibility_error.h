// Errors of S_j planes, split so that each number has one meaning (DESIGN section 1).
#pragma once

#include <span>

#include "core/points.h"

namespace umbra {

/// One light's S_j plane: a value and a flag a point. Values of undefined points mean nothing.
struct VisibilityPlane {
    std::vector<float> s;               ///< [0, 1]
    std::vector<std::uint8_t> defined;  ///< kUndefined, kDefined, or kOnBoundary
};

/// What `defined` says of a point.
inline constexpr std::uint8_t kUndefined  = 0;  ///< the method cannot tell
inline constexpr std::uint8_t kDefined    = 1;
inline constexpr std::uint8_t kOnBoundary = 2;  ///< the way to the light touches an edge or a vertex and nothing more:
                                                ///< no method is wrong there. Only exact methods say so

/// What counts as a wrong S_j: for lights whose S_j is 0 or 1, the other one; for area lights, a difference that shows
/// in a penumbra and that the noise of a sampled reference does not reach.
inline constexpr float kHardTolerance = 0.5f;
inline constexpr float kAreaTolerance = 0.1f;
[[nodiscard]] constexpr float visibility_tolerance(LightKind kind) {
    return is_area(kind) ? kAreaTolerance : kHardTolerance;
}

/// Counts are points; `points` are those with a surface whose light is not `away` and that both planes define, and all
/// counts and means below are over them. Of the others with a surface and a light not `away`, `on_boundary` are those
/// that the reference says are, `undefined` those that either plane leaves open. A point is wrong where |s - reference|
/// > `tolerance`: a false shadow where s is below the reference, a false light where it is above. lit, umbra and
/// penumbra: the reference is above 1 - 1/1024, below 1/1024, between.
struct VisibilityError {
    std::uint64_t points = 0, undefined = 0, away = 0;
    std::uint64_t on_boundary = 0;
    std::uint64_t lit = 0, umbra = 0, penumbra = 0;  ///< of the reference
    struct Kind {
        std::uint64_t interior = 0, edge = 0;
    };
    Kind false_shadow, false_light;
    double mae = 0, rmse = 0, max = 0, bias = 0;  ///< bias: mean of s - reference
};

/// `reference` and `s` are planes of the same raster batch; throws std::logic_error where it has no raster or a plane
/// is of another size. `tolerance` > 0.
[[nodiscard]] VisibilityError visibility_error(const PointBatch& points, LightId light, const VisibilityPlane& s,
                                               const VisibilityPlane& reference, float tolerance);

/// 1 in the edge band of the reference plane: where a shadow that lies up to 1.5 pixels off could be wrong by more than
/// `tolerance`, so that a wrong value says something about sampling in the image and nothing about the method.
///
/// A shadow boundary passes between two 4-neighbours that both have a surface point, a light not `away` and a defined
/// reference, where the reference changes by more than tolerance / 1.5 from one to the other: at any change for hard
/// lights; for area lights where the penumbra is steep, and not at its faint ends. The band holds the pixels whose
/// centre is within 1.5 pixels (Euclidean) of the point midway between such two centres. Where the light turns `away`
/// there is no boundary, since facing is decided once and exactly. The outline of an object in front of a shadow does
/// count: between two pixels, a shadow's boundary and an occlusion cannot be told apart.
[[nodiscard]] std::vector<std::uint8_t> edge_band(const PointBatch& points, LightId light,
                                                  const VisibilityPlane& reference, float tolerance);

}  // namespace umbra
