#include "umbra/shadows/geometry/point_tree.h"

#include <utility>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel_sort.h"

namespace umbra {
namespace {

float nearest_float(double x) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(x, -kLargest, kLargest));
}

float step_beside(float f) {
    return std::abs(f) * std::numeric_limits<float>::epsilon() + std::numeric_limits<float>::denorm_min();
}

}  // namespace

float float_below(double x) {
    const float f = nearest_float(x);
    return f - step_beside(f);
}

float float_above(double x) {
    const float f = nearest_float(x);
    return f + step_beside(f);
}

void sort_by_places(std::span<std::uint32_t> points, std::span<const dvec2> places) {
    dvec2 low(+kInfinity), high(-kInfinity);
    for (const dvec2 p : places) low = glm::min(low, p), high = glm::max(high, p);
    const double extent = std::max({high.x - low.x, high.y - low.y, 1e-300});
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(points.size());  // key, point
    parallel_ranges(points.size(), 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const dvec2 p = (places[i] - low) / extent * 0x1p31;
            order[i]      = {morton_code(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y)), points[i]};
        }
    });
    parallel_sort(order.begin(), order.end());
    std::ranges::transform(order, points.begin(), [](const auto& keyed) { return keyed.second; });
}

}  // namespace umbra
