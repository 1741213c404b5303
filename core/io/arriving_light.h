// How much light arrives at the surfaces of a scene, unoccluded: an estimate for warnings and for exposures. Internal
// to core.
#pragma once

#include <functional>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// At most this many triangles, evenly spread over their list, stand for the scene.
inline constexpr std::size_t kArrivingSamples = 4096;
[[nodiscard]] std::vector<TriangleId> sample_triangles(const Scene& scene);

/// The median over the triangles that any light reaches, of the largest channel of sum_j f_att,j I_j over the lights
/// for which `counts` is true; 0 where no light reaches any triangle.
[[nodiscard]] double median_arriving(const Scene& scene, const std::function<bool(const Light&)>& counts);

}  // namespace umbra
