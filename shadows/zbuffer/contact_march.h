// Contact shadows: a march of a few steps through the picture, from a surface point towards the light. It finds what is
// too small for a map's texels, or too close to the receiver for its bias, if the camera sees it.
//
// As real-time engines have it; Umbra's differs in that a step is compared with the plane of the facet that its pixel
// shows, not with the depth of the pixel's centre, so that no plane shades itself however flat it is seen.
#pragma once

#include <optional>

#include "umbra/core/render/points.h"

namespace umbra {

struct ContactMarch {
    int steps        = 0;    ///< 0: no march
    double length    = 0.3;  ///< world units, or as far as the light is, if that is closer
    double thickness = 0.1;  ///< world units: of the surfaces in the picture
};

/// The pixel of the first step that lies behind the plane of the facet seen there, but by no more than the thickness;
/// none where there is none. It ends at the border of the picture, and passes what lets light through. `picture` has a
/// raster, and its points are seen from there; p in world space, seen or not. Pure: any number of threads.
[[nodiscard]] std::optional<std::size_t> march(const Scene& scene, const PointBatch& picture, dvec3 p,
                                               const Light& light, const ContactMarch& contact);

}  // namespace umbra
