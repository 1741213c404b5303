#include "umbra/bench/studies/motion/mix_triangle.h"

#include <cmath>

namespace umbra {
namespace {

/// What is left of the polygon where plane . shares >= 0.
/// [Ivan Sutherland, Gary Hodgman, Reentrant Polygon Clipping, 1974]
std::vector<Shares> clipped(const std::vector<Shares>& polygon, const Shares& plane) {
    std::vector<Shares> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Shares &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double at_a = glm::dot(plane, a), at_b = glm::dot(plane, b);
        if (at_a >= 0) kept.push_back(a);
        if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    return kept;
}

/// Of the whole triangle's area: twice the area in two of the shares as coordinates.
double area(const std::vector<Shares>& polygon) {
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Shares &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        sum += a.y * b.z - a.z * b.y;
    }
    return std::abs(sum);
}

}  // namespace

std::vector<MixRegion> mix_regions(const std::vector<CornerTimes>& methods) {
    std::vector<MixRegion> regions;
    for (std::size_t m = 0; m < methods.size(); ++m) {
        std::vector<Shares> polygon{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        bool doubled = false;  // an earlier method has the same times
        for (std::size_t n = 0; n < methods.size(); ++n) {
            doubled = doubled || (n < m && methods[n] == methods[m]);
            if (n != m) polygon = clipped(polygon, methods[n] - methods[m]);
        }
        const double size = area(polygon);
        if (!doubled && size > 0) regions.push_back({m, std::move(polygon), size});
    }
    return regions;
}

}  // namespace umbra
