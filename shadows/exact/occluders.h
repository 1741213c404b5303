// The scene's triangles as they block area lights: welded, and in a tree of boxes.
#pragma once

#include "umbra/core/scene/topology.h"
#include "umbra/shadows/shared/box_tree.h"

namespace umbra::exact_detail {

struct Occluders {
    const Scene* scene       = nullptr;       ///< must outlive this
    const BoxTree* triangles = nullptr;       ///< of the boxes of its triangles; must outlive this
    Topology topology;                        ///< of all of them
    std::vector<std::uint8_t> casts_nothing;  ///< one a triangle: 1 without an area, or where it does not block

    /// Of a welded vertex.
    [[nodiscard]] vec3 position(std::uint32_t vertex) const { return scene->positions[topology.position[vertex]]; }
};

}  // namespace umbra::exact_detail
