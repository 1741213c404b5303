// The scene's triangles as they block area lights: welded, and in a tree of boxes.
#pragma once

#include "umbra/shadows/geometry/box_tree.h"
#include "umbra/shadows/geometry/edges.h"

namespace umbra::exact_visibility {

struct Occluders : OccluderMesh {
    /// `tree`: of the boxes of the scene's triangles. Both must outlive this object.
    Occluders(const Scene& of, const BoxTree& tree) : OccluderMesh(of), triangles(tree) {}

    const BoxTree& triangles;
};

}  // namespace umbra::exact_visibility
