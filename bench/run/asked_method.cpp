#include "umbra/bench/run/asked_method.h"

namespace umbra {

std::vector<VisibilityPlane> lit_everywhere(const Scene& scene, const PointBatch& points) {
    std::vector<VisibilityPlane> planes;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        VisibilityPlane& plane = planes.emplace_back(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) plane.s[i] = points.asks(light, i) ? 1.0f : 0.0f;
    }
    return planes;
}

AskedMethod::AskedMethod(const Scene& scene, const SceneFacts& facts, const std::optional<MethodChoice>& choice)
    : scene_(&scene) {
    if (!choice) return;
    method_ = choice->make();
    method_->build(scene, facts);
}

std::vector<VisibilityPlane> AskedMethod::operator()(const PointBatch& points) {
    asked_ = 0;
    if (!method_) return lit_everywhere(*scene_, points);
    std::vector<VisibilityPlane> planes;
    for (LightId light = 0; light < scene_->lights.size(); ++light) {
        for (std::size_t i = 0; i < points.size(); ++i) asked_ += points.asks(light, i) ? 1 : 0;
        planes.emplace_back(points.size());
        method_->aim(light);
        method_->visibility(points, light, planes.back().out());
    }
    return planes;
}

}  // namespace umbra
