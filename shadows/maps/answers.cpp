#include "umbra/shadows/maps/answers.h"

#include <algorithm>

namespace umbra {

CameraFrame picture_of(const Scene& scene, const PointBatch& points) {
    if (points.raster) return *points.raster;
    return frame(scene.camera, std::max(1, scene.width), std::max(1, scene.height));
}

bool BlockingSamples::find(std::size_t i, std::size_t k, const MapView& view, const Receiver& receiver, BiasMode mode,
                           const Filter& filter) {
    const auto at = blocked_sample(view, receiver, mode, filter);
    if (at) samples_[i] = {k, static_cast<std::size_t>(at->y) * view.map.width() + at->x};
    return at.has_value();
}

void BlockingSamples::name(std::span<TriangleId> blockers,
                           const std::function<std::vector<TriangleId>(std::size_t k)>& owners) const {
    std::ranges::fill(blockers, kNoTriangle);
    std::size_t maps = 0;
    for (const Sample& sample : samples_)
        if (sample.map != kNone) maps = std::max(maps, sample.map + 1);
    for (std::size_t k = 0; k < maps; ++k) {
        if (std::ranges::find(samples_, k, &Sample::map) == samples_.end()) continue;
        const std::vector<TriangleId> shown = owners(k);
        for (std::size_t i = 0; i < samples_.size(); ++i)
            if (samples_[i].map == k) blockers[i] = shown[samples_[i].at];
    }
}

}  // namespace umbra
