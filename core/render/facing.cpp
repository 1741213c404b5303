#include "umbra/core/render/facing.h"

#include "umbra/core/base/predicates.h"

namespace umbra {

bool centre_is_behind(const Scene& scene, const PointBatch& points, LightId light, std::size_t i) {
    if (points.facing[light][i] != Facing::partly) return false;
    const TriangleId t = points.triangle[i];
    const int side =
        side_of_plane(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2), scene.lights[light].position);
    return points.flipped[i] ? side >= 0 : side <= 0;
}

}  // namespace umbra
