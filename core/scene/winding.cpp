#include "umbra/core/scene/winding.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra {

double winding_number(const Scene& scene, const Object& object, dvec3 point) {
    constexpr std::size_t kBlock = 4096;
    std::vector<double> sums((object.triangle_count + kBlock - 1) / kBlock);  // added up in one order
    parallel_ranges(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
            const std::size_t last = std::min<std::size_t>(object.triangle_count, (block + 1) * kBlock);
            for (std::size_t k = block * kBlock; k < last; ++k) {
                const auto t   = static_cast<TriangleId>(object.first_triangle + k);
                const dvec3 a  = dvec3(scene.vertex(t, 0)) - point;
                const dvec3 b  = dvec3(scene.vertex(t, 1)) - point;
                const dvec3 c  = dvec3(scene.vertex(t, 2)) - point;
                const double A = glm::length(a), B = glm::length(b), C = glm::length(c);
                sums[block] += std::atan2(glm::dot(a, glm::cross(b, c)),
                                          A * B * C + glm::dot(a, b) * C + glm::dot(b, c) * A + glm::dot(c, a) * B);
            }
        }
    });
    double sum = 0;
    for (const double s : sums) sum += s;
    return sum / (2 * kPi);
}

}  // namespace umbra
