#include <algorithm>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"
#include "umbra/shadows/geometry/triangle_tree.h"

namespace umbra {
namespace {

constexpr int kIndexBits = 28, kCellBits = 12;  // of a key; scenes have 50 million triangles at most
constexpr std::uint64_t kIndexMask = (std::uint64_t{1} << kIndexBits) - 1;

double size(const Box& box) {
    const dvec3 d = dvec3(box.max) - dvec3(box.min);
    return d.x + d.y + d.z;
}

/// Whether boxes around eight triangles that follow one another are, in the sum, no larger than those triangles' own.
bool follow_one_another(const Scene& scene, std::span<const TriangleId> order) {
    const std::size_t groups = (order.size() + kLanes - 1) / kLanes;
    std::vector<double> excess(groups);
    parallel_ranges(groups, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g) {
            const auto own = order.subspan(g * kLanes, std::min<std::size_t>(kLanes, order.size() - g * kLanes));
            Box all        = box_of(scene, own[0]);
            double sum     = 0;
            for (const TriangleId t : own) {
                const Box box = box_of(scene, t);
                sum += size(box);
                all.min = glm::min(all.min, box.min), all.max = glm::max(all.max, box.max);
            }
            excess[g] = size(all) - sum;
        }
    });
    double total = 0;
    for (const double e : excess) total += e;
    return total <= 0;
}

}  // namespace

std::vector<TriangleId> coherent_order(const Scene& scene, std::span<const std::uint8_t> casts) {
    std::vector<TriangleId> order;
    order.reserve(casts.size());
    for (TriangleId t = 0; t < casts.size(); ++t)
        if (casts[t] != 0) order.push_back(t);
    if (follow_one_another(scene, order)) return order;
    const Box all = bounds(scene);
    const dvec3 low(all.min), span = dvec3(all.max) - low;
    const double cells = (1 << kCellBits) - 1;
    const dvec3 scale(span.x > 0 ? cells / span.x : 0, span.y > 0 ? cells / span.y : 0,
                      span.z > 0 ? cells / span.z : 0);
    std::vector<std::uint64_t> keys(order.size());
    parallel_ranges(order.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Box box    = box_of(scene, order[k]);
            const dvec3 cell = scale * (0.5 * (dvec3(box.min) + dvec3(box.max)) - low);
            const auto at    = [&](int axis) { return static_cast<std::uint32_t>(cell[axis]); };
            keys[k]          = morton_code(at(0), at(1), at(2)) << kIndexBits | order[k];
        }
    });
    parallel_sort(keys.begin(), keys.end());
    for (std::size_t k = 0; k < keys.size(); ++k) order[k] = static_cast<TriangleId>(keys[k] & kIndexMask);
    return order;
}

}  // namespace umbra
