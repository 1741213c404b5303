// Ladders over surfaces that coincide, touch and pass through each other.
#include <cmath>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/chance.h"
#include "umbra/bench/ladders/themes/close_view.h"

namespace umbra {
namespace {

/// `count` copies of every triangle of a mesh, each with its own corners and every second one flipped.
Mesh repeated(const Mesh& mesh, double count) {
    Mesh all;
    for (int copy = 0; copy < count; ++copy) {
        const auto first = static_cast<unsigned>(all.positions.size());
        for (const uvec3& t : mesh.triangles)
            all.triangles.push_back(first + (copy % 2 == 0 ? t : uvec3(t.x, t.z, t.y)));
        all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    }
    return all;
}

/// A tilted floor with a tilted box over it, with `count` copies of every face.
Scene duplicate_scene(double count) {
    Scene scene       = empty_stage();
    const mat4 tilted = glm::rotate(mat4(1), 0.3f, {0.8f, 0, 0.6f});
    add_body(scene, "floor", repeated(transformed(make_plane(4, 4), tilted), count));
    add_body(scene, "box", repeated(transformed(make_box(vec3(1)), tilted * at({0.2f, 1, 0})), count));
    add_point_light(scene, {0.5f, 4, 1});
    look(scene, {2, 3, 4}, {0, 0.3f, 0});
    return scene;
}

/// Two solids whose facing sides the rays of light run along: light that falls between them meets the floor in a
/// stripe.
Scene touching_scene(double gap) {
    Scene scene = empty_stage();
    add_close_floor(scene, gap > 0 ? 8 * gap : 1e-3);
    const dvec3 away = 0.25 * kCloseLight, near = kHalfway - 0.5 * gap * kAcross, far = kHalfway + 0.5 * gap * kAcross;
    add_body(scene, "this side", parallelepiped(near - kAlong - kAcross, 2.0 * kAlong, away, kAcross));
    add_body(scene, "that side", parallelepiped(far - kAlong, 2.0 * kAlong, away, kAcross));
    add_close_light(scene);
    if (gap == 0) add_rim_light(scene, kHalfway + kAcross);
    return scene;
}

/// A slab is sunk into a tilted floor, except for this height.
Scene sunken_scene(double height) {
    Scene scene   = empty_stage();
    const dvec3 x = glm::normalize(dvec3(1, 0.3, -0.2)), n = glm::normalize(glm::cross(dvec3(-0.1, -0.2, 1), x)),
                z = glm::cross(x, n);
    add_body(scene, "floor", quad(-2.0 * x - 2.0 * z, -2.0 * x + 2.0 * z, 2.0 * x + 2.0 * z, 2.0 * x - 2.0 * z));
    const dvec3 u = 0.8 * x + 0.6 * z, v = -0.6 * x + 0.8 * z;
    add_body(scene, "slab", parallelepiped((height - 0.2) * n - 0.5 * (u + v), u, 0.2 * n, v));
    add_body(scene, "post", make_cylinder(0.25f, 1.1f, 12), at({0.9f, 0.85f, 0.3f}));
    add_point_light(scene, {1.5f, 3, 1});
    look(scene, {1.5f, 2.5f, 3}, {0.2f, 0, 0});
    return scene;
}

/// Boxes of random orientation at one position, which interpenetrate each other and the floor.
Scene interpenetrating_scene(double count) {
    Scene scene = floor_stage(4);
    Chance chance;
    for (int i = 0; i < count; ++i) {
        const vec3 axis   = glm::normalize(vec3(chance.in_box(dvec3(1))));
        const vec3 place  = vec3(0, 0.4f, 0) + vec3(chance.in_box({0.8, 0.5, 0.8}));
        const vec3 size   = vec3(0.6f) + vec3(chance.in_box(dvec3(0.4)));
        const mat4 turned = glm::rotate(at(place), static_cast<float>(chance.between(0, 3)), axis);
        add_body(scene, "box " + std::to_string(i + 1), make_box(size), turned);
    }
    add_point_light(scene, {-2.5f, 3, 2});
    look(scene, {0.5f, 3.5f, 4}, {0, 0.3f, 0});
    return scene;
}

}  // namespace

const Ladder duplicate_faces_ladder{
    .name  = "duplicate_faces",
    .title = "Coplanar duplicates",
    .about =
        "Every triangle of a tilted floor and of a box exists N times, bit-equal, with either orientation. The result "
        "must not change: a surface does not shadow its own copy.",
    .unit  = "copies",
    .rungs = {1e0, 2e0, 5e0, 1e1, 2e1, 5e1, 1e2},
    .scene = duplicate_scene};

const Ladder touching_solids_ladder{
    .name  = "touching_solids",
    .title = "Gap between solids",
    .about =
        "Two solids are at this distance; on the last rung they share a face. The light runs along their facing sides "
        "and through the gap, and the picture shows only the stripe that it makes on the floor; on the last rung a "
        "second "
        "light falls past the outer rim.",
    .unit  = "of their width",
    .rungs = tenths_to_0(),
    .scene = touching_scene};

const Ladder sunken_slab_ladder{.name  = "sunken_slab",
                                .title = "A slab slightly above the floor",
                                .about =
                                    "A slab is sunk into a tilted floor except for this height. The floor passes at "
                                    "this distance below the top of the slab and must not shadow it.",
                                .unit  = "of its length",
                                .rungs = powers_of_ten(-1, -7),
                                .scene = sunken_scene};

const Ladder interpenetrating_solids_ladder{.name  = "interpenetrating_solids",
                                            .title = "Interpenetrating solids",
                                            .about =
                                                "N boxes interpenetrate at one position: at each crease, surfaces come "
                                                "closer than a pixel, and no mesh has an edge there.",
                                            .unit  = "boxes",
                                            .rungs = {5e0, 1e1, 2e1, 5e1, 1e2, 2e2, 5e2, 1e3},
                                            .scene = interpenetrating_scene};

}  // namespace umbra
