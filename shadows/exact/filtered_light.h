// How much of a rectangle light reaches a point where occluders let a part of the light through: the light is cut into
// convex cells, each behind the same triangles, in rationals.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "umbra/shadows/exact/light_space.h"
#include "umbra/shadows/exact/sight.h"

namespace umbra::exact_visibility {

/// Into more cells than that no light is cut: it would take seconds a point.
inline constexpr std::size_t kMostCells = 4096;

/// The mean over the light of the product, per channel, of lets_through of the triangles `between`, and 0 where the
/// plane of the point's triangle hides it if `sight.partly`. The error is below 1e-9. Nothing where more than
/// kMostCells cells are needed. The orientation of `space` is not 0; degenerate triangles and the point's own are not
/// in `between`. Adds its work to `steps`, in those of ExactArea::Workspace.
[[nodiscard]] std::optional<dvec3> light_through_filters(const Sight& sight, const RationalSpace& space,
                                                         std::span<const TriangleId> between, std::uint64_t& steps);

}  // namespace umbra::exact_visibility
