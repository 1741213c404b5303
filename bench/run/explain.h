// Errors with their causes: asks a method and its reference which triangles they hold responsible.
#pragma once

#include <optional>

#include "umbra/bench/run/run.h"
#include "umbra/core/errors/error_classes.h"
#include "umbra/core/errors/noise.h"
#include "umbra/core/errors/shadow_edges.h"
#include "umbra/core/errors/visibility_error.h"

namespace umbra {

/// One light of one method compared with the reference.
struct Explained {
    ClassPlane classes;
    VisibilityError error;
    std::optional<EdgeDisplacement> displacement;
    std::optional<PenumbraWidth> penumbra_width;  ///< area lights only
    std::optional<Noise> noise;                   ///< where a meter was given
};

/// Sorts every point into its class and counts them; measures edges and penumbrae. `meter`, fed with runs of the same
/// method with other seeds, tells noise from other errors; none: no point is of class `noise`. Both runs are of this
/// scene and batch, and serve it; their methods are asked again where interior errors need a name.
[[nodiscard]] Explained explain(const Scene& scene, const PointBatch& points, LightId light, const MethodRun& run,
                                const MethodRun& reference, const NoiseMeter* meter = nullptr);

}  // namespace umbra
