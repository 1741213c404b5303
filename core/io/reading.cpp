#include "umbra/core/io/reading.h"

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

constexpr double kFar = 64;  ///< times the diagonal

/// The smallest power of ten, below 1 of two, that is at least `length` > 0.
double unit_above(double length) {
    if (!(length > 1)) return std::exp2(std::ceil(std::log2(length)));
    double unit = 1;
    while (unit < length) unit *= 10;
    return unit;
}

}  // namespace

dvec3 local_origin(dvec3 low, dvec3 high) {
    const dvec3 middle    = low + (high - low) / 2.0;
    const double diagonal = glm::length(high - low);
    dvec3 origin(0);
    for (int axis = 0; axis < 3; ++axis) {
        const double away = std::abs(middle[axis]);
        if (!std::isfinite(away) || !(away > kFar * diagonal)) continue;
        // A scene that floats squeeze to a point is at least about as large as a step between them.
        const double unit = unit_above(std::max(diagonal, away * 0x1p-22));
        origin[axis]      = std::round(middle[axis] / unit) * unit;
    }
    return origin;
}

dvec3 local_origin(const Box& box) { return box.empty() ? dvec3(0) : local_origin(dvec3(box.min), dvec3(box.max)); }

}  // namespace umbra
