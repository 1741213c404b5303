// A box tree over the triangles of a scene.
#pragma once

#include "umbra/core/scene/scene.h"
#include "umbra/shadows/geometry/box_tree.h"

namespace umbra {

class TriangleTree : public BoxTree {
public:
    explicit TriangleTree(const Scene& scene) : BoxTree(boxes_of(scene)) {}

private:
    static std::vector<Box> boxes_of(const Scene& scene) {
        std::vector<Box> boxes(scene.triangles.size());
        for (TriangleId t = 0; t < boxes.size(); ++t)
            for (int k = 0; k < 3; ++k) boxes[t] = extend(boxes[t], scene.vertex(t, k));
        return boxes;
    }
};

}  // namespace umbra
