// The scene's triangles as they block area lights: welded, and in a tree of boxes.
#pragma once

#include "umbra/core/scene/topology.h"
#include "umbra/shadows/geometry/box_tree.h"

namespace umbra::exact_visibility {

struct Occluders {
    /// `tree`: of the boxes of the scene's triangles. Both must outlive this object.
    Occluders(const Scene& of, const BoxTree& tree);

    const Scene& scene;
    const BoxTree& triangles;
    Topology topology;                        ///< of all triangles
    std::vector<std::uint8_t> casts_nothing;  ///< one a triangle: 1 without an area, or where it does not block

    /// Of a welded vertex.
    [[nodiscard]] vec3 position(std::uint32_t vertex) const { return scene.positions[topology.position[vertex]]; }
    [[nodiscard]] std::size_t memory_bytes() const;
};

}  // namespace umbra::exact_visibility
