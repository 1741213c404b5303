// What a method promises of the planes that it writes.
#pragma once

#include <string_view>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// Throws std::logic_error, naming the method, where a plane that it wrote holds values outside [0, 1], or an answer
/// for a point that is not asked for.
void check_contract(std::string_view name, const VisibilityPlane& plane, const PointBatch& points, LightId light);

}  // namespace umbra
