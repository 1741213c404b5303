#include "umbra/core/render/off_pixel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "umbra/core/base/parallel.h"

namespace umbra {

OffPixel off_pixel(const Scene& scene, const PointBatch& points) {
    const CameraFrame& frame = points.raster.value();
    const auto width         = static_cast<std::size_t>(frame.width);
    std::mutex mutex;
    OffPixel all;
    parallel_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
        OffPixel here;
        for (std::size_t i = begin; i < end; ++i) {
            if (points.triangle[i] == kNoTriangle) continue;
            const std::size_t column = i % width, row = i / width;
            const dvec3 seen = frame.project(exact_position(scene, points, i));
            const double x   = std::abs(seen.x - (static_cast<double>(column) + 0.5)),
                         y   = std::abs(seen.y - (static_cast<double>(row) + 0.5));
            const double off = seen.z > 0 || frame.projection == Projection::orthographic
                                   ? std::max(x, y)
                                   : std::numeric_limits<double>::infinity();
            here.points += !(off <= 0.5);
            here.worst = std::max(here.worst, off);
        }
        const std::scoped_lock lock(mutex);
        all.points += here.points;
        all.worst = std::max(all.worst, here.worst);
    });
    return all;
}

}  // namespace umbra
