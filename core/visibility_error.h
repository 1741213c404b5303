// Errors of S_j planes, split so that each number has one meaning (DESIGN section 1).
#pragma once

#include <span>

#include "core/points.h"

namespace umbra {

/// One light's S_j plane: a value and a flag a point. Values of undefined points mean nothing.
struct VisibilityPlane {
    std::vector<float> s;               ///< [0, 1]
    std::vector<std::uint8_t> defined;  ///< 1 where the method says something
};

/// Counts are points; `points` are those with a surface whose light is not `away` and that the method defines.
/// A point is wrong where |s - reference| > `tolerance`.
struct VisibilityError {
    std::uint64_t points = 0, undefined = 0, on_boundary = 0, away = 0;
    std::uint64_t lit = 0, umbra = 0, penumbra = 0;  ///< of the reference, over `points`
    struct Kind {
        std::uint64_t interior = 0, edge = 0;
    };
    Kind false_shadow, false_light;
    double mae = 0, rmse = 0, max = 0, bias = 0;  ///< bias: mean of s - reference
};

/// `reference` and `s` are planes of the same raster batch. Edge band: within 1.5 pixels (Euclidean) of a pixel pair,
/// 4-neighbours, both with a surface, whose reference values differ by more than `tolerance` and one of which is 0 or 1
/// in the umbra or lit sense; see .cpp.
[[nodiscard]] VisibilityError visibility_error(const PointBatch& points, LightId light, const VisibilityPlane& s,
                                               const VisibilityPlane& reference, float tolerance);

/// 1 in the edge band of the reference plane.
[[nodiscard]] std::vector<std::uint8_t> edge_band(const PointBatch& points, const VisibilityPlane& reference,
                                                  float tolerance);

}  // namespace umbra
