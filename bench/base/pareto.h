// Which settings no other setting beats in both cost and error.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace umbra {

/// Less is better in both. An error of 0 is legal.
struct CostError {
    double cost, error;
};

/// Indices of the points that no other point dominates (at most its cost and its error, and less in one of them), by
/// ascending cost, then by index. Points that are equal in both stay together. Points that are not finite are left out.
///
/// Own code: in two dimensions it is a sort and a pass. moocore, which has nondominated sets in any number of
/// dimensions, is not packaged by Debian.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const CostError> points);

}  // namespace umbra
