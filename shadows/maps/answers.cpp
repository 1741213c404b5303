#include "umbra/shadows/maps/answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "umbra/core/base/error.h"
#include "umbra/core/render/gbuffer.h"

namespace umbra {

SeenPicture::SeenPicture(const Scene& scene, const PointBatch& at, bool traced)
    : Looked(at),
      camera(at.raster ? *at.raster : frame(scene.camera, std::max(1, scene.width), std::max(1, scene.height))) {
    if (!traced || at.raster) return;
    try {
        traced_ = primary_points(RayScene(scene), scene, scene.camera, camera.width, camera.height);
        traced_->facing.clear();
    } catch (const InputError&) {  // an eye too far away for rays
    }
}

const PointBatch* SeenPicture::shown() const { return points.raster ? &points : traced_ ? &*traced_ : nullptr; }

std::size_t SeenPicture::memory_bytes() const {
    constexpr std::size_t kPoint = sizeof(TriangleId) + 8 * sizeof(float) + sizeof(std::uint8_t);
    return traced_ ? traced_->size() * kPoint : 0;
}

ivec2 texel_of(const Receiver& receiver, const MapView& view) {
    return {std::clamp(static_cast<int>(receiver.x), 0, view.map.width() - 1),
            std::clamp(static_cast<int>(receiver.y), 0, view.map.height() - 1)};
}

void add_texel(Reason& reason, const FoundReceiver& found, const MapView& view, Given given) {
    const Receiver& receiver = found.receiver;
    reason.evidence.push_back({"map", static_cast<double>(found.view)});
    if (receiver.x < 0 || receiver.y < 0 || receiver.x > view.map.width() || receiver.y > view.map.height()) {
        reason.evidence.push_back({"texel", "outside the map, where nothing casts"});
        return;
    }
    const ivec2 texel   = texel_of(receiver, view);
    const double stored = view.frame.depth(view.map.nearness(texel.x, texel.y));
    const double own    = view.frame.depth(receiver.r);
    const double compared =
        view.frame.depth(std::min(1.0, receiver.r + receiver.bias + std::min(receiver.slack, receiver.most)));
    for (const ivec2 corner : {ivec2(0, 0), ivec2(1, 0), ivec2(1, 1), ivec2(0, 1)}) {
        const dvec2 at(texel + corner);
        const double r     = receiver.r + receiver.r_x * (at.x - receiver.x) + receiver.r_y * (at.y - receiver.y);
        const double depth = view.frame.depth(r);
        // Where light grazes, the plane may go to infinity within the texel.
        const bool cut = view.frame.perspective && (depth <= 0 || depth > 4 * own);
        reason.texel.push_back(
            view.frame.position(2.0 * at / dvec2(view.map.width(), view.map.height()) - 1.0, cut ? 4 * own : depth));
    }
    const dvec2 width =
        2.0 * view.frame.half / dvec2(view.map.width(), view.map.height()) * (view.frame.perspective ? own : 1.0);
    reason.evidence.push_back({"texel", fmt::format("{}, {}", texel.x, texel.y)});
    reason.evidence.push_back({"width of the texel", std::max(width.x, width.y), "world"});
    reason.evidence.push_back({"stored depth", stored, "world"});
    reason.evidence.push_back({"depth of the point", own, "world"});
    reason.evidence.push_back({"bias towards the light", own - compared, "world"});
    const double margin = stored - compared;
    if (given.answer != Answer::given || margin * (static_cast<double>(given.s) - 0.5) <= 0) return;
    reason.margin = margin;
    reason.unit   = "world, along the view";
}

bool BlockingSamples::find(std::size_t i, std::size_t k, const MapView& view, const Receiver& receiver, BiasMode mode,
                           const Filter& filter) {
    const auto at = blocked_sample(view, receiver, mode, filter);
    if (at) samples_[i] = {k, static_cast<std::size_t>(at->y) * view.map.width() + at->x};
    return at.has_value();
}

void BlockingSamples::name(std::span<TriangleId> blockers, const Owners& owners) const {
    std::ranges::fill(blockers, kNoTriangle);
    std::map<std::size_t, std::vector<std::size_t>> asked;
    for (const Sample& sample : samples_)
        if (sample.map != kNone) asked[sample.map].push_back(sample.at);
    for (auto& [k, samples] : asked) {
        std::ranges::sort(samples);
        samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
        const std::vector<TriangleId> shown = owners(k, samples);
        for (std::size_t i = 0; i < samples_.size(); ++i)
            if (samples_[i].map == k)
                blockers[i] = shown[static_cast<std::size_t>(std::ranges::lower_bound(samples, samples_[i].at) -
                                                             samples.begin())];
    }
}

}  // namespace umbra
