#include "umbra/core/render/ask_visibility.h"

namespace umbra {

std::vector<VisibilityPlane> lit_everywhere(const Scene& scene, const PointBatch& points) {
    std::vector<VisibilityPlane> planes;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        VisibilityPlane& plane = planes.emplace_back(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) plane.s[i] = points.asks(light, i) ? 1.0f : 0.0f;
    }
    return planes;
}

}  // namespace umbra
