#include "umbra/shadows/exact/exact_area.h"

namespace umbra::exact_detail {
namespace {

using Answer = ExactArea::Answer;

/// Of rectangles the area alone is stated, which is off by less than kTrusted.
Answer answer(const VisibleArea& area, bool round) {
    const double low  = std::max(0.0, (area.visible - area.error) / area.whole);
    const double high = std::min(1.0, (area.visible + area.open + area.error) / area.whole);
    // What differs from 0 or 1 by no more than rounding may be 0 or 1.
    const double unsure = 2 * area.error / area.whole;
    if (high <= unsure) return {0, round ? static_cast<float>(high) : 0};
    if (low >= 1 - unsure) return {1, round ? static_cast<float>(1 - low) : 0};
    // Half an ulp of the answer belongs to what it may be off.
    const auto half = static_cast<float>((high - low) / 2 * (1 + 0x1p-22) + 0x1p-25);
    return {static_cast<float>((low + high) / 2), round ? half : 0};
}

}  // namespace

ExactArea::Answer ExactArea::seen(TriangleId own, float u, float v, bool partly, int turn, Workspace& work) const {
    const Viewpoint viewpoint(*occluders_.scene, own, u, v, work.coplanar);
    const std::optional<LightPlane> plane = light_.plane_from(viewpoint.point());
    if (!plane) return {1, 0};
    const Sight sight{occluders_, edges_, light_, *plane, viewpoint, partly, turn};

    const FloatSpace space(viewpoint.point(), *plane);
    if (arithmetic_ == Arithmetic::filtered && space.orientation()) {
        const VisiblePart<FloatSpace> part(sight, space, work.in_double);
        // What hid the whole light of the point before often hides it from this one.
        if (work.blocker != kNoTriangle && work.blocker != own && part.is_hidden_by(work.blocker)) return {};
        edges_.gather(viewpoint, space, kGatherReach, work.silhouette);
        if (const auto area = part.find(work.silhouette, work.blocker)) return answer(*area, light_.round());
    } else {
        edges_.gather(viewpoint, space, kGatherReach, work.silhouette);
    }

    const RationalSpace exact_space(viewpoint.point(), *plane);
    if (exact_space.orientation() == 0) return {.edge_on = true};
    ++work.rational_points;
    const VisiblePart<RationalSpace> part(sight, exact_space, work.in_rationals);
    return answer(part.find(work.silhouette, work.blocker).value(), light_.round());
}

void ExactArea::build(const Scene& scene, const BoxTree& triangles) {
    occluders_ = {&scene, &triangles, find_topology(scene, 0, static_cast<std::uint32_t>(scene.triangles.size()))};
    edges_.build(occluders_);
}

void ExactArea::aim(const Light& light) { light_.aim(light, occluders_); }

std::size_t ExactArea::memory_bytes() const {
    const auto bytes         = [](const auto& list) { return list.size() * sizeof(list[0]); };
    const Topology& topology = occluders_.topology;
    return bytes(topology.triangles) + bytes(topology.position) + bytes(topology.edges) + bytes(topology.uses) +
           bytes(topology.degenerate) + edges_.memory_bytes() + light_.memory_bytes();
}

}  // namespace umbra::exact_detail
