#include "umbra/shadows/maps/map_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"

namespace umbra {

MapMargins margins(std::string_view method, const MapOptions& options, int radius, double reach, double room) {
    // What the filter and the offset may ask for, and a rounding.
    const MapMargins m{.border   = reach + options.normal_offset + 2,
                       .headroom = std::max(room, kMostAutomatic * (4 * radius + 2)) + options.constant};
    if (4 * m.border > options.resolution)
        throw UsageError(fmt::format(
            "{}: radius={} and normal_offset={} reach over a quarter of resolution={}, expected a resolution of at "
            "least {}",
            method, radius, options.normal_offset, options.resolution, std::ceil(4 * m.border)));
    return m;
}

}  // namespace umbra
