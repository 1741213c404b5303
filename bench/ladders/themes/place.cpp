// Ladders over where a scene lies and how large it is.

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/stage.h"

namespace umbra {
namespace {

/// Moves every position, lights and camera included, by exact arithmetic rounded once.
template <class Map>
Scene mapped(Scene scene, const Map& map) {
    const auto move = [&](vec3& p) { p = vec3(map(dvec3(p))); };
    for (vec3& p : scene.positions) move(p);
    for (Light& light : scene.lights) move(light.position);
    move(scene.camera.eye);
    move(scene.camera.target);
    return scene;
}

Scene far_scene(double rung) {
    // A direction that is along no axis and in no plane of two.
    const dvec3 offset = 8 * rung * dvec3(0.75, 0.25, -0.6);
    return mapped(harmless_stage(), [&](dvec3 p) { return p + offset; });
}

Scene scaled_scene(double rung) {
    return mapped(harmless_stage(), [&](dvec3 p) { return rung * p; });
}

}  // namespace

const Ladder far_from_origin_ladder{
    .name  = "far_from_origin",
    .title = "Distance from the origin",
    .about =
        "The whole scene moves away from the origin, with its lights and the camera. Float coordinates are coarse "
        "there: the shape itself is rounded, and differences of coordinates lose significant digits.",
    .unit  = "scene sizes",
    .rungs = {1e0, 3.2e0, 1e1, 3.2e1, 1e2, 3.2e2, 1e3, 3.2e3, 1e4, 3.2e4, 1e5, 3.2e5, 1e6, 3.2e6, 1e7, 3.2e7, 1e8},
    .scene = far_scene};

const Ladder tiny_scene_ladder{
    .name  = "tiny_scene",
    .title = "Tiny scene",
    .about =
        "The whole scene shrinks, with its lights and the camera. Constants in world units become large compared with "
        "it, and squares and products of its lengths underflow in floats.",
    .rungs = powers_of_ten(0, -12),
    .scene = scaled_scene};

const Ladder huge_scene_ladder{.name  = "huge_scene",
                               .title = "Huge scene",
                               .about =
                                   "The whole scene grows, with its lights and the camera. Constants in world units "
                                   "become small compared with it, and products of its lengths overflow in floats.",
                               .rungs = powers_of_ten(0, 12),
                               .scene = scaled_scene};

}  // namespace umbra
