// What the sweep does once a row for all edges of it, in doubles: several edges at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "umbra/core/base/lanes.h"

namespace umbra::exact_visibility {

/// Edges by their lower and upper ends, in a list each, filled up to a multiple of kLanes.
struct EdgeLists {
    const double *low_x, *low_y, *width, *height, *high_x, *high_y;
};

/// x[k] becomes x of edge k at y, for k < n, rounded up to a multiple of kLanes; at the upper end exactly that. The
/// lower end lies below y; `height` is not 0.
void edges_at(const EdgeLists& edges, std::size_t n, double y, double* x);

/// The least of n values, n > 0 and rounded up to a multiple of kLanes.
[[nodiscard]] double least_of(const double* values, std::size_t n);

/// Appends those of n, likewise, that end at `y` or below.
void ends_at(const double* high_y, std::size_t n, double y, std::vector<std::uint32_t>& ended);

}  // namespace umbra::exact_visibility
