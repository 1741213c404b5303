// A floor that is looked at closely, in the middle of a scene that is not: so that what is a millionth of the scene
// wide still fills a picture, and its inside is more than an edge band.
#pragma once

#include <algorithm>

#include "umbra/bench/ladders/themes/stage.h"

namespace umbra {

/// The position of the light of a close view, and of its occluder, halfway between the light and the origin: what is w
/// wide there casts a shadow 2 w wide. Not along an axis, and exact in float.
inline constexpr dvec3 kCloseLight{1, 2, 0.5};
inline constexpr dvec3 kHalfway = 0.5 * kCloseLight;

/// The camera sees `window` world units around the origin, at most 0.375, from top to bottom of the picture, from close
/// by, below the occluder.
inline void look_closely(Scene& scene, double window) {
    const float w           = static_cast<float>(std::min(window, 0.375));
    scene.camera.projection = Projection::orthographic;
    scene.camera.height     = w;
    scene.camera.eye        = w * vec3(0.5f, 2, 1.5f);
    scene.camera.target     = vec3(0);
}

/// The same, and a floor of 8 x 8 in y = 0, except around the origin: there is a tile, four times the window wide, and
/// nothing else near it, so that barycentrics are fine there and eye rays, whose tolerance grows with a triangle, meet
/// no other.
inline void add_close_floor(Scene& scene, double window) {
    look_closely(scene, window);
    const float t = 2 * scene.camera.height, n = std::max(t, 0.5f), r = 4;
    Mesh floor{{}, {}, {{0, 2, 1}, {0, 3, 2}}};  // the tile, and around it, turning, a strip a side
    for (vec2 p : {vec2(-t, -t), vec2(-n, -n), vec2(-r, -n), vec2(-r, -r)})
        for (int turn = 0; turn < 4; ++turn, p = {-p.y, p.x}) floor.positions.emplace_back(p.x, 0, p.y);
    for (unsigned side = 0; side < 4; ++side) {
        const unsigned next = (side + 1) % 4;
        floor.triangles.push_back({12 + side, 4 + next, 8 + next});
        floor.triangles.push_back({12 + side, 8 + side, 4 + next});
    }
    add_body(scene, "floor", floor);
}

inline void add_close_light(Scene& scene) { add_point_light(scene, vec3(kCloseLight)); }

/// A light beyond `rim`, a point on the outer edge of an occluder: the shadow of that edge runs through the middle of
/// the close view, which is lit on one side of it. For rungs on which the other light is blocked everywhere.
inline void add_rim_light(Scene& scene, dvec3 rim) { add_point_light(scene, vec3(2.0 * rim)); }

/// Two directions in the plane of an occluder, perpendicular, each 1 long, along no axis.
inline const dvec3 kAlong  = dvec3(12, 0, 5) / 13.0;
inline const dvec3 kAcross = dvec3(-5, 0, 12) / 13.0;

/// The quad a, b, c, d, anticlockwise, as two triangles.
inline Mesh quad(dvec3 a, dvec3 b, dvec3 c, dvec3 d) {
    return {{vec3(a), vec3(b), vec3(c), vec3(d)}, {}, {{0, 1, 2}, {0, 2, 3}}};
}

/// A body of six quads, closed: from a corner along three edges, which are right-handed.
inline Mesh parallelepiped(dvec3 corner, dvec3 x, dvec3 y, dvec3 z) {
    Mesh mesh = make_box(vec3(1));
    for (std::size_t i = 0; i < 8; ++i) {
        const dvec3 share = dvec3(mesh.positions[i]) + 0.5;
        mesh.positions[i] = vec3(corner + share.x * x + share.y * y + share.z * z);
    }
    return mesh;
}

}  // namespace umbra
