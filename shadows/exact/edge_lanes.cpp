// The steps of the sweep in lanes (active_edges.h).
#include "umbra/core/base/lanes.h"
#include "umbra/shadows/exact/active_edges.h"

namespace umbra::exact_visibility {
namespace {

/// Where an edge has just been set, a load of several of its neighbours with it waits longer than they take one by one.
constexpr std::size_t kFew = 4;

}  // namespace

UMBRA_FOR_EACH_PROCESSOR void edges_at(const EdgeLists& edges, std::size_t n, double y, double* __restrict x) {
    const double *low_x = edges.low_x, *low_y = edges.low_y, *width = edges.width, *height = edges.height,
                 *high_x = edges.high_x, *high_y = edges.high_y;
    if (n <= kFew) {
        for (std::size_t k = 0; k < n; ++k)
            x[k] = y == high_y[k] ? high_x[k] : low_x[k] + width[k] * ((y - low_y[k]) / height[k]);
        return;
    }
    for (std::size_t from = 0; from < n; from += kLanes) {
#pragma GCC unroll 1
        for (std::size_t k = from; k < from + kLanes; ++k) {
            const double at = low_x[k] + width[k] * ((y - low_y[k]) / height[k]), end = high_x[k];
            x[k] = y == high_y[k] ? end : at;
        }
    }
}

UMBRA_FOR_EACH_PROCESSOR double least_of(const double* values, std::size_t n) {
    if (n <= kFew) {
        double least = values[0];
        for (std::size_t k = 1; k < n; ++k) least = std::min(least, values[k]);
        return least;
    }
    double least[kLanes];
    std::copy_n(values, kLanes, least);
    for (std::size_t from = kLanes; from < n; from += kLanes) {
#pragma GCC unroll 1
        for (std::size_t k = 0; k < kLanes; ++k) least[k] = values[from + k] < least[k] ? values[from + k] : least[k];
    }
    for (std::size_t half = kLanes / 2; half > 0; half /= 2)
        for (std::size_t k = 0; k < half; ++k) least[k] = std::min(least[k], least[k + half]);
    return least[0];
}

UMBRA_FOR_EACH_PROCESSOR void ends_at(const double* high_y, std::size_t n, double y,
                                      std::vector<std::uint32_t>& ended) {
    if (n <= kFew) {
        for (std::size_t k = 0; k < n; ++k)
            if (high_y[k] <= y) ended.push_back(static_cast<std::uint32_t>(k));
        return;
    }
    for (std::size_t from = 0; from < n; from += kLanes) {
        std::int64_t any = 0;
#pragma GCC unroll 1
        for (std::size_t k = from; k < from + kLanes; ++k) any |= high_y[k] <= y ? -1 : 0;
        if (any == 0) continue;
        for (std::size_t k = from; k < from + kLanes; ++k)
            if (high_y[k] <= y) ended.push_back(static_cast<std::uint32_t>(k));
    }
}

}  // namespace umbra::exact_visibility
