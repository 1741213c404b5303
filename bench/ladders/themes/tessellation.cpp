// Ladders over how finely, and how, surfaces are cut into triangles.
#include <cmath>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/close_view.h"

namespace umbra {
namespace {

/// A ball with smooth normals under the sun: most of what the picture shows is near the terminator.
Scene ball_scene(double longitudes) {
    Scene scene = floor_stage(6);
    const int n = static_cast<int>(longitudes);
    add_body(scene, "ball", make_sphere(1, n, n / 2), at({0, 1.25f, 0}));
    add_sun(scene, {-1, -0.5f, 0.125f});
    look(scene, {0.5f, 2, 4}, {0, 1.2f, 0});
    return scene;
}

/// `count` triangles that share one edge.
Scene pages_scene(double count) {
    Scene scene = floor_stage(6);
    const dvec3 low(-0.75, 0.75, -0.5), high(0.75, 1.25, 0.5), spine = glm::normalize(high - low);
    const dvec3 u = glm::normalize(glm::cross(spine, dvec3(0, 1, 0))), v = glm::cross(spine, u);
    Mesh book{{vec3(low), vec3(high)}, {}, {}};
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) {
        const double turn = 0.3 + 2 * kPi * i / count;
        book.positions.emplace_back(0.5 * (low + high) + 0.9 * (std::cos(turn) * u + std::sin(turn) * v));
        book.triangles.push_back(i % 2 == 0 ? uvec3(0, 1, i + 2) : uvec3(1, 0, i + 2));
    }
    add_body(scene, "book", book);
    add_point_light(scene, {1, 4, 0.5f});
    look(scene, {1, 3.5f, 5}, {0, 0.4f, 0});
    return scene;
}

/// A box on a floor of two triangles, which is scaled by `size`.
Scene large_floor_scene(double size) {
    Scene scene = floor_stage(static_cast<float>(8 * size));
    add_body(scene, "box", make_box({1, 2, 1}), glm::rotate(at({0.2f, 1, -0.3f}), 0.4f, {0, 1, 0}));
    add_point_light(scene, {2.5f, 4, 1.5f});
    look(scene, {0, 3, 7}, {0, 0, 0});
    return scene;
}

}  // namespace

const Ladder sphere_tessellation_ladder{
    .name  = "sphere_tessellation",
    .title = "Tessellation of a ball",
    .about =
        "A ball with smooth normals has N facets around it: with few facets the terminator is visibly stepped; with "
        "many, they are small and edge-on to the light there.",
    .unit  = "facets around",
    .rungs = {8e0, 1.6e1, 3.2e1, 6.4e1, 1.28e2, 2.56e2, 5.12e2, 1.024e3},
    .scene = ball_scene};

const Ladder shared_edge_ladder{.name  = "shared_edge",
                                .title = "Triangles that share one edge",
                                .about =
                                    "N triangles share one edge, like pages at a spine, with either orientation: this "
                                    "is not a 2-manifold and has no silhouette in the usual sense.",
                                .unit  = "triangles",
                                .rungs = {1e0, 2e0, 3e0, 1e1, 3e1, 1e2, 3e2, 1e3, 3e3},
                                .scene = pages_scene};

const Ladder large_floor_ladder{
    .name  = "large_floor",
    .title = "Large triangles under small ones",
    .about =
        "The floor, two triangles, is scaled by this factor; the box on it is not. Barycentrics are coarse there, and "
        "tolerances relative to the scene size miss the small objects.",
    .unit  = "times",
    .rungs = powers_of_ten(0, 7),
    .scene = large_floor_scene};

}  // namespace umbra
