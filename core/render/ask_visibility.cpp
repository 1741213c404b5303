#include "umbra/core/render/ask_visibility.h"

#include <algorithm>

namespace umbra {

void write_decided(const Scene& scene, const PointBatch& points, LightId light, const Visibility& out) {
    const bool all_receive =
        std::ranges::all_of(scene.objects, [](const Object& object) { return object.switches.receives_shadows; });
    if (all_receive && scene.lights[light].kind != LightKind::sphere) return;  // nothing is unshadowed
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.decided(light, i) == 0) continue;
        out.s[i] = points.decided(light, i);
        if (!out.colour.empty()) out.colour[i] = vec3(out.s[i]);
    }
}

std::vector<VisibilityPlane> lit_everywhere(const Scene& scene, const PointBatch& points) {
    std::vector<VisibilityPlane> planes;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        VisibilityPlane& plane = planes.emplace_back(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) plane.s[i] = points.faces(light, i) ? 1.0f : 0.0f;
    }
    return planes;
}

}  // namespace umbra
