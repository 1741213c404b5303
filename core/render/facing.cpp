#include "umbra/core/render/facing.h"

#include "umbra/core/base/heights.h"
#include "umbra/core/base/predicates.h"

namespace umbra {

int side_of_light(const Light& light, vec3 a, vec3 b, vec3 c) {
    return light.kind == LightKind::directional ? side_of_direction(a, b, c, -light.direction)
                                                : side_of_plane(a, b, c, light.position);
}

namespace {

/// The side of an area light relative to the plane of triangle (a, b, c), seen from the side `turn` (+1 the winding's,
/// -1 the other).
Facing area_facing(const Light& light, vec3 a, vec3 b, vec3 c, int turn) {
    const HeightSigns heights =
        light.kind == LightKind::rectangle ? heights_of_rectangle(a, b, c, light.position, light.edge_u, light.edge_v)
        : light.kind == LightKind::disk    ? heights_of_disk(a, b, c, light.position, light.direction, light.radius)
                                           : heights_of_sphere(a, b, c, light.position, light.radius);
    const int low  = turn > 0 ? heights.low : -heights.high;
    const int high = turn > 0 ? heights.high : -heights.low;
    return high <= 0 ? Facing::away : low >= 0 ? Facing::front : Facing::partly;
}

}  // namespace

bool rises_over(const Scene& scene, TriangleId t, TriangleId own, int side) {
    const vec3 a = scene.vertex(own, 0), b = scene.vertex(own, 1), c = scene.vertex(own, 2);
    for (int k = 0; k < 3; ++k)
        if (side_of_plane(a, b, c, scene.vertex(t, k)) == side) return true;
    return false;
}

Facing as_received(const Scene& scene, TriangleId t, Facing facing) {
    return is_asked(facing) && !scene.switches(t).receives_shadows ? Facing::unshadowed : facing;
}

Facing facing_of(const Scene& scene, LightId id, TriangleId t, bool flipped) {
    const Light& light = scene.lights[id];
    const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
    const int turn = flipped ? -1 : 1;
    if (is_area(light.kind)) return as_received(scene, t, area_facing(light, a, b, c, turn));
    const bool is_front = turn * side_of_light(light, a, b, c) > 0;
    return as_received(scene, t, is_front ? Facing::front : Facing::away);
}

bool lies_in_light(const Scene& scene, const PointBatch& points, LightId light, std::size_t i) {
    const TriangleId t = points.triangle[i];
    const Light& l     = scene.lights[light];
    return lies_in_sphere(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2), points.u[i], points.v[i],
                          l.position, l.radius);
}

bool centre_of_cut_light_is_behind(const Scene& scene, const PointBatch& points, LightId light, std::size_t i) {
    const TriangleId t = points.triangle[i];
    const int side     = side_of_light(scene.lights[light], scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
    return points.flipped[i] ? side >= 0 : side <= 0;
}

}  // namespace umbra
