// Pictures without occluders: every light reaches every point that faces it.
#pragma once

#include <vector>

#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shading_models.h"

namespace umbra {

inline PointBatch points_of(const Scene& scene) {
    return primary_points(RayScene(scene), scene, scene.camera, scene.width, scene.height);
}

inline std::vector<VisibilityPlane> all_lit(const Scene& scene, const PointBatch& points) {
    std::vector<VisibilityPlane> planes;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        VisibilityPlane& plane = planes.emplace_back(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) plane.s[i] = points.asks(light, i) ? 1.0f : 0.0f;
    }
    return planes;
}

inline ShadedPicture shaded(ShadingModel model, const Scene& scene, const PointBatch& points) {
    return shade_by(model, scene, points, [&](const PointBatch& at) { return all_lit(scene, at); });
}

}  // namespace umbra
