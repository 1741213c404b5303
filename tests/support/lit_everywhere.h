// Pictures without occluders: every light reaches every point that faces it.
#pragma once

#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/gbuffer.h"

namespace umbra {

inline PointBatch points_of(const Scene& scene) {
    return primary_points(RayScene(scene), scene, scene.camera, scene.width, scene.height);
}

inline ShadedPicture shaded(ShadingModel model, const Scene& scene, const PointBatch& points) {
    return shade_by(model, scene, points, [&](const PointBatch& at) { return lit_everywhere(scene, at); });
}

}  // namespace umbra
