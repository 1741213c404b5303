// A surface point, its own triangle, and on which side of the other triangles it lies.
#pragma once

#include <utility>
#include <vector>

#include "umbra/shadows/geometry/exact_point.h"

namespace umbra::exact_visibility {

/// Which triangles lie in the plane of one triangle, as far as it was asked. One thread's.
struct CoplanarTriangles {
    TriangleId own = kNoTriangle;
    std::vector<std::pair<TriangleId, bool>> known;
};

class Viewpoint {
public:
    /// `scene` and `coplanar` must outlive this object. The point is (1-u-v) a + u b + v c of triangle `own`.
    Viewpoint(const Scene& scene, TriangleId own, float u, float v, CoplanarTriangles& coplanar)
        : scene_(scene), own_(own), point_(scene, own, u, v), coplanar_(coplanar) {}

    [[nodiscard]] const ExactPoint& point() const { return point_; }
    [[nodiscard]] TriangleId own() const { return own_; }
    [[nodiscard]] const Scene& scene() const { return scene_; }

    /// True only if t is known to lie in the plane of the point's own triangle.
    [[nodiscard]] bool surely_coplanar(TriangleId t) const;

    /// Sign of det(a - p, b - p, c - p) of triangle t = (a, b, c); 0 of the point's own. Exact.
    [[nodiscard]] int side_of(TriangleId t) const;

private:
    const Scene& scene_;
    TriangleId own_;
    ExactPoint point_;
    CoplanarTriangles& coplanar_;
};

}  // namespace umbra::exact_visibility
