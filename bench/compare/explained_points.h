// The points that show a method's errors best, one a class, with the reasons of the method and of the truth.
#pragma once

#include <vector>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/results.h"

namespace umbra {

/// For each class of interior errors that points of the light have, in the order of the palette: the point with the
/// largest error, of equals one that has the most of its class around it. Asks both methods, which have run at
/// `points`, a picture; what one throws is its answer's `failed`.
[[nodiscard]] std::vector<ExplainedPointRecord> explained_points(const Scene& scene, const PointBatch& points,
                                                                 LightId light, const MethodRun& method,
                                                                 const MethodRun& truth, const ClassPlane& classes);

}  // namespace umbra
