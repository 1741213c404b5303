// How far a method's picture is from the reference's.
#pragma once

#include <span>

#include "umbra/bench/lab/results.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// One method's S_j planes made into pictures, once.
struct Rendered {
    Image linear;  ///< R G B
    Image shown;   ///< R G B, sRGB
};
[[nodiscard]] Rendered render_planes(const Scene& scene, const PointBatch& points,
                                     std::span<const VisibilityPlane> planes);

/// The differences over covered pixels: where a method leaves any light undefined, the reference's pixel is used.
struct ImageFigures {
    ImageRecord figures;
    Flip flip;  ///< of the displayed pictures, with its map
};
[[nodiscard]] ImageFigures image_figures(std::span<const VisibilityPlane> planes, Rendered rendered,
                                         const Rendered& reference);

}  // namespace umbra
