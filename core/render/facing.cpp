#include "umbra/core/render/facing.h"

#include "umbra/core/base/predicates.h"

namespace umbra {

int side_of_light(const Light& light, vec3 a, vec3 b, vec3 c) {
    return light.kind == LightKind::directional ? side_of_direction(a, b, c, -light.direction)
                                                : side_of_plane(a, b, c, light.position);
}

bool centre_is_behind(const Scene& scene, const PointBatch& points, LightId light, std::size_t i) {
    if (points.facing[light][i] != Facing::partly) return false;
    const TriangleId t = points.triangle[i];
    const int side     = side_of_light(scene.lights[light], scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
    return points.flipped[i] ? side >= 0 : side <= 0;
}

}  // namespace umbra
