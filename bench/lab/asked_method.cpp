#include "umbra/bench/lab/asked_method.h"

#include <utility>

#include "umbra/core/render/ask_visibility.h"

namespace umbra {

AskedMethod::AskedMethod(const Scene& scene, const SceneFacts& facts, const std::optional<MethodChoice>& choice)
    : scene_(&scene) {
    if (!choice) return;
    work_.emplace(*choice, scene, facts);
    work_->build();
}

std::vector<VisibilityPlane> AskedMethod::operator()(const PointBatch& points) {
    const PointBatch* const batch = &points;
    return std::move(of({&batch, 1}).front());
}

std::vector<std::vector<VisibilityPlane>> AskedMethod::of(std::span<const PointBatch* const> batches) {
    asked_ = 0;
    std::vector<std::vector<VisibilityPlane>> planes;
    for (const PointBatch* points : batches) planes.push_back(lit_everywhere(*scene_, *points));
    for (LightId light = 0; light < scene_->lights.size() && work_; ++light) {
        work_->aim(light);
        for (std::size_t b = 0; b < batches.size(); ++b) {
            const PointBatch& points = *batches[b];
            for (std::size_t i = 0; i < points.size(); ++i) asked_ += points.asks(light, i) ? 1 : 0;
            planes[b][light] = work_->ask(points, light);
        }
    }
    return planes;
}

}  // namespace umbra
