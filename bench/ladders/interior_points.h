// How many points of a rung can show that a method is wrong: without them "holds" says nothing.
#pragma once

#include <cstdint>
#include <string>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/run.h"

namespace umbra {

/// A method that serves a scene approximately breaks where more than this fraction of the compared points is wrong in
/// the interior; one that serves it exactly or to rounding where any is.
inline constexpr double kBreakingShare = 0.005;

/// A rung is judged where it has enough interior points of both kinds. Both limits have a reason.
/// - kLeastOfAKind: no wrong point among n bounds the fraction of wrong ones by 3 / n at 95 % confidence; 100 points
///   say "below 3 %". [James Hanley, Abby Lippman-Hand, If Nothing Goes Wrong, Is Everything All Right?, 1983]
/// - kLeastShareOfAKind, of the compared points: a method that is wrong at half of the points of one kind breaks, also
///   where kBreakingShare is allowed to be wrong. So one that always says lit, or always dark, breaks on every rung.
inline constexpr std::uint64_t kLeastOfAKind = 100;
inline constexpr double kLeastShareOfAKind   = 2 * kBreakingShare;

/// Counts of compared points, over lights. In a penumbra a point can be of both kinds.
struct InteriorPoints {
    std::uint64_t compared = 0;  ///< in the edge band, too
    std::uint64_t lit      = 0;  ///< interior, S_j = 0 would be wrong
    std::uint64_t shadow   = 0;  ///< interior, S_j = 1 would be wrong

    InteriorPoints& operator+=(const InteriorPoints& other);
    [[nodiscard]] bool enough() const;
    /// "12 interior shadow points of 9000 compared, at least 100 are needed": what is missing; empty where enough.
    [[nodiscard]] std::string lacking() const;
};
DESCRIBE(InteriorPoints) {
    of("interior_lit", &R::lit, "interior points, over lights, at which S_j = 0 would be wrong");
    of("interior_shadow", &R::shadow, "interior points, over lights, at which S_j = 1 would be wrong");
}

/// Of the points that both planes define; `answers` may be `truth` itself.
[[nodiscard]] InteriorPoints interior_points(const Scene& scene, const PointBatch& points, LightId light,
                                             const VisibilityPlane& truth, const VisibilityPlane& answers);

}  // namespace umbra
