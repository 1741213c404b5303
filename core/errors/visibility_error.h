// Errors of S_j planes, split so that each number has one meaning (docs/terms.md).
#pragma once

#include <span>

#include "umbra/core/errors/error_classes.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// Counts are points, taken from the plane of classes; `points` are those with a surface whose light is not `away` and
/// that both planes define, and all counts and means below `away` are over them. Of the others with a surface and a
/// light not `away`, `unshadowed` are those with Facing::unshadowed, `on_boundary` those that the reference
/// says are, `undefined` those that either plane leaves open. lit, umbra and penumbra are by `kFullOrNone`.
struct VisibilityError {
    std::uint64_t points = 0, undefined = 0, away = 0, unshadowed = 0;
    std::uint64_t on_boundary = 0;
    std::uint64_t not_judged  = 0;  ///< the reference was not evaluated there
    struct Level {
        std::uint64_t lit = 0, umbra = 0, penumbra = 0;
    };
    std::uint64_t lit = 0, umbra = 0, penumbra = 0;  ///< of the reference
    struct Kind {
        std::uint64_t interior = 0, edge = 0;
    };
    Kind false_shadow, false_light;  ///< without those at the terminator
    Level interior;                  ///< both kinds' interior points, by the reference there
    struct Direction {
        std::uint64_t false_shadow = 0, false_light = 0;
    };
    Direction penumbra_error;  ///< of both kinds' interior points, those of class `penumbra`; acne, detachment, leak
                               ///< and unnamed have none of them
    Direction noise_error;     ///< likewise those of class `noise`
    std::uint64_t acne       = 0;  ///< of false_shadow.interior; 0 unless causes were looked for
    std::uint64_t detachment = 0;  ///< of false_light.interior, likewise
    std::uint64_t leak       = 0;  ///< of false_light.interior, likewise
    std::uint64_t unnamed    = 0;  ///< the rest of false_light.interior: the reference named no occluder
    /// The rest of false_shadow.interior: the method blames another surface, or no cause was looked for.
    [[nodiscard]] std::uint64_t other_shadow() const {
        return false_shadow.interior - acne - penumbra_error.false_shadow - noise_error.false_shadow;
    }
    struct Terminator {
        std::uint64_t facet_away  = 0;  ///< the shading normal faces the light, the facet does not. None can be wrong
        std::uint64_t normal_away = 0;  ///< the facet faces the light, the shading normal does not
        std::uint64_t wrong       = 0;  ///< of normal_away, edge and interior alike
    };
    Terminator terminator;                        ///< all 0 unless it was looked for
    double max_half_width = 0;                    ///< of the reference's own doubt
    double mae = 0, rmse = 0, max = 0, bias = 0;  ///< bias: mean of s - reference
};

/// `reference` and `s` are planes of the same raster batch, and `classes` the classes of their differences. Throws
/// std::logic_error where one is of another size.
[[nodiscard]] VisibilityError count_errors(const PointBatch& points, const ClassPlane& classes,
                                           const VisibilityPlane& s, const VisibilityPlane& reference);

/// The same of two planes alone: edge and interior, but no causes and no terminator. Throws as `error_classes` does.
[[nodiscard]] VisibilityError visibility_error(const PointBatch& points, LightId light, const VisibilityPlane& s,
                                               const VisibilityPlane& reference, float tolerance,
                                               std::span<const std::uint8_t> judged = {});

}  // namespace umbra
