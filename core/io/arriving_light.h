// How much light arrives at the surfaces of a scene, unoccluded: an estimate for warnings and for exposures. Internal
// to core.
#pragma once

#include <functional>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// At most this many triangles, evenly spread over their list, represent the scene.
inline constexpr std::size_t kArrivingSamples = 4096;
[[nodiscard]] std::vector<TriangleId> sample_triangles(const Scene& scene);

/// Largest channel of f_att,j I_j at a triangle's centre, whatever its orientation.
[[nodiscard]] double arriving(const Scene& scene, const Light& light, TriangleId triangle);

/// The median over the triangles that any light reaches, of the largest channel of sum_j f_att,j I_j over the lights
/// for which `counts` is true; 0 where no light reaches any triangle.
[[nodiscard]] double median_arriving(const Scene& scene, const std::function<bool(const Light&)>& counts);

/// Adds a warning for every light, and for the ambient light, that adds less than 0.1 % of the brightest light's
/// contribution at the median triangle, wherever the surfaces are.
void warn_of_invisible_lights(Scene& scene);

}  // namespace umbra
