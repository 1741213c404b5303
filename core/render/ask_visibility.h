// How the core asks for S_j without knowing the methods.
#pragma once

#include <functional>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// S_j of all lights at the points of a batch, as a method answers it: one plane a light, as long as the batch. The
/// batch is faced to all lights.
using AskVisibility = std::function<std::vector<VisibilityPlane>(const PointBatch&)>;

/// Writes S_j where it is not asked and not 0, into a plane that is as a method wants it before the call.
void write_decided(const Scene& scene, const PointBatch& points, LightId light, const Visibility& out);

/// S_j where nothing hides anything: 1 where some of the light is in front, else 0. The batch is faced to all lights.
[[nodiscard]] std::vector<VisibilityPlane> lit_everywhere(const Scene& scene, const PointBatch& points);

}  // namespace umbra
