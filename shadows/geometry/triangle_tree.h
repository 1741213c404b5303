// The triangles of a scene: in double, in a box tree, and in an order in which neighbours follow one another, so that
// eight of them are looked up together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/base/rounding.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/scene/scene.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/geometry/box_tree.h"

namespace umbra {

[[nodiscard]] inline std::array<dvec3, 3> corners_of(const Scene& scene, TriangleId t) {
    return {dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))};
}
[[nodiscard]] inline Box box_of(const Scene& scene, TriangleId t) {
    const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
    return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
}
/// Sum of the magnitudes of its coordinates, of which rounding is a fraction.
[[nodiscard]] inline double size_of(const Scene& scene, TriangleId t) {
    const auto [a, b, c] = corners_of(scene, t);
    return sum_of_magnitudes(a) + sum_of_magnitudes(b) + sum_of_magnitudes(c);
}
[[nodiscard]] inline int side_of_light(const Scene& scene, const Light& light, TriangleId t) {
    return side_of_light(light, scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
}
/// Whether it blocks light and has an area; one without has no inside to cross and bounds no shadow.
[[nodiscard]] inline bool occludes(const Scene& scene, TriangleId t) {
    return scene.blocks(t) && !is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
}

class TriangleTree : public BoxTree {
public:
    explicit TriangleTree(const Scene& scene) : BoxTree(boxes_of(scene)) {}

private:
    static std::vector<Box> boxes_of(const Scene& scene) {
        std::vector<Box> boxes(scene.triangles.size());
        for (TriangleId t = 0; t < boxes.size(); ++t) boxes[t] = box_of(scene, t);
        return boxes;
    }
};

/// The triangles t of the scene with `casts[t]` not 0, each once: as they are numbered where triangles of near numbers
/// are near in space as they are in most meshes that a program made, otherwise along Morton's curve through the box of
/// all.
[[nodiscard]] std::vector<TriangleId> coherent_order(const Scene& scene, std::span<const std::uint8_t> casts);

}  // namespace umbra
