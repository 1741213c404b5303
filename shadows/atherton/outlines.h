// The edges at which the number of triangles over a light can change: the silhouettes of all objects, as one light sees
// them, and the borders of open ones.
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/scene/topology.h"

namespace umbra::atherton {

/// From one position to another; `change`, not 0: by how many more triangles lie to its left than to its right, as the
/// light sees it.
struct OutlineEdge {
    vec3 from{0}, to{0};
    int change = 0;
};

/// Of all triangles of `topology`, each counted as the light sees it: lights[t] is +1 where the light is on the side
/// that triangle t faces, -1 on the other, 0 in its plane (or where it has no area or does not block).
[[nodiscard]] std::vector<OutlineEdge> find_outlines(const Scene& scene, const Topology& topology,
                                                     const std::vector<std::int8_t>& lights);

}  // namespace umbra::atherton
