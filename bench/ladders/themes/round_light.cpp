// Ladders over lights that are disks and spheres: how large they are, how close they come to receivers and occluders,
// and what touches them.
#include <cmath>
#include <vector>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/stage.h"

namespace umbra {
namespace {

const std::vector<double> kShrinks = {1e0, 1e-1, 1e-2, 1e-4, 1e-8, 1e-12};
const std::vector<double> kGrows   = {1e0, 3.2, 1e1, 1e2, 1e4, 1e8};
const std::vector<double> kDown    = {1e-1, 1e-2, 1e-4, 1e-6};
const std::vector<double> kDownTo0 = {1e-1, 1e-2, 1e-4, 1e-6, 0.0};
constexpr dvec3 kLightAt           = {4, 6, 1.5};  // in harmless_stage

/// About half as many pixels as other ladders have: the visible part of an area light takes `exact` longer.
Scene small(Scene scene) {
    scene.width = 88, scene.height = 66;
    return scene;
}

/// Where most points are in a penumbra.
Scene smaller(Scene scene) {
    scene.width = 64, scene.height = 48;
    return scene;
}

void make_sphere_light(Light& light, double radius) {
    light.kind   = LightKind::sphere;
    light.radius = float(radius);
}

void make_disk_light(Light& light, double radius, vec3 direction) {
    light.kind      = LightKind::disk;
    light.radius    = float(radius);
    light.direction = glm::normalize(direction);
}

Scene sphere_of(double diameter) {
    Scene scene = small(harmless_stage());
    make_sphere_light(scene.lights[0], 0.5 * diameter);
    return scene;
}

Scene disk_of(double diameter) {
    Scene scene = small(harmless_stage());
    make_disk_light(scene.lights[0], 0.5 * diameter, {-0.4f, -1, -0.2f});
    return scene;
}

/// The near side stays where it is, so that the sphere never reaches the scene: it becomes a wall of light.
Scene growing_sphere_scene(double diameter) {
    Scene scene              = smaller(sphere_of(diameter));
    scene.lights[0].position = vec3(kLightAt + 0.5 * (diameter - 1) * glm::normalize(kLightAt));
    return scene;
}

Scene growing_disk_scene(double diameter) { return smaller(disk_of(diameter)); }

/// A floor of cells with a post, for light from close above the floor.
Scene low_stage() {
    Scene scene = small(floor_stage(8, 4));
    add_body(scene, "post", make_box({0.7f, 2.1f, 2.3f}), at({-2.4f, 1.05f, -1.6f}));
    look(scene, {0.3f, 9, 6.5f}, {0.2f, 0, 0.1f}, 48);
    return scene;
}

Scene sphere_near_receiver_scene(double rung) {
    Scene scene = low_stage();
    make_sphere_light(add_point_light(scene, {-3.41f, float(8 * rung), -0.93f}), 4 * rung);
    return scene;
}

Scene disk_near_receiver_scene(double rung) {
    Scene scene = low_stage();
    make_disk_light(add_point_light(scene, {-3.41f, float(8 * rung), -0.93f}), 4 * rung, {1, -0.3f, 0.1f});
    return scene;
}

/// A sphere above the floor, which it touches on the last rung.
Scene sphere_touches_receiver_scene(double rung) {
    Scene scene = low_stage();
    make_sphere_light(add_point_light(scene, {-3.35f, float(0.5 + 8 * rung), -0.93f}), 0.5);
    return scene;
}

/// A box with its lid at the height 2 and a wall behind it, for a light beside the box.
Scene lid_stage() {
    Scene scene = small(floor_stage(9));
    add_body(scene, "wall", make_box({0.5f, 5, 6}), at({-3.75f, 2.5f, 0}));
    add_body(scene, "box", make_box(vec3(2)), at({0, 1, 0}));
    look(scene, {6.5f, 6.2f, 7.1f}, {-1.1f, 1.3f, 0}, 45);
    return scene;
}

Scene sphere_in_face_plane_scene(double rung) {
    Scene scene = lid_stage();
    make_sphere_light(add_point_light(scene, {3.7f, float(2 + 8 * rung), 0.21f}), 0.25);
    return scene;
}

/// The disk is parallel to the lid, and on the last rung in its plane.
Scene disk_in_face_plane_scene(double rung) {
    Scene scene = lid_stage();
    make_disk_light(add_point_light(scene, {3.7f, float(2 + 8 * rung), 0.21f}), 0.5, {0, -1, 0});
    return scene;
}

/// A disk that shines down, and below it a lid whose rim runs across under its middle.
Scene disk_touches_occluder_scene(double rung) {
    Scene scene      = small(floor_stage(8));
    const double low = 6 - 6 * rung;
    add_lid(scene, {-3, low, -3}, {0.125, low, 3});
    add_body(scene, "box", make_box({1.5f, 3.5f, 2.5f}), at({1.7f, 1.75f, 0}));
    make_disk_light(add_point_light(scene, {0.25f, 6, 0.25f}), 0.5, {0, -1, 0});
    look(scene, {0.3f, 4.5f, 9}, {0.2f, 0, 0.1f}, 42);
    return scene;
}

/// A sphere beside a box that it touches on the last rung.
Scene sphere_touches_occluder_scene(double rung) {
    Scene scene = lid_stage();
    make_sphere_light(add_point_light(scene, {float(1.5 + 8 * rung), 1.25f, 0.25f}), 0.5);
    return scene;
}

}  // namespace

const Ladder shrinking_sphere_ladder{.name  = "shrinking_sphere",
                                     .title = "Sphere light that shrinks to a point",
                                     .about =
                                         "A sphere light shrinks until its penumbra is narrower than a pixel: the "
                                         "result must converge to that of the point light.",
                                     .unit  = "light diameter (floor side = 8)",
                                     .rungs = kShrinks,
                                     .scene = sphere_of};

const Ladder shrinking_disk_ladder{.name  = "shrinking_disk",
                                   .title = "Disk light that shrinks to a point",
                                   .about =
                                       "A disk light shrinks until its penumbra is narrower than a pixel: the result "
                                       "must converge to that of the point light.",
                                   .unit  = "light diameter (floor side = 8)",
                                   .rungs = kShrinks,
                                   .scene = disk_of};

const Ladder growing_sphere_ladder{
    .name  = "growing_sphere",
    .title = "Sphere light that becomes huge",
    .about =
        "A sphere light grows away from the scene until it is a wall of light: directions to its parts differ by up to "
        "180 degrees, and its rounding exceeds the scene.",
    .unit  = "light diameter (floor side = 8)",
    .rungs = kGrows,
    .scene = growing_sphere_scene};

const Ladder growing_disk_ladder{.name  = "growing_disk",
                                 .title = "Disk light that becomes huge",
                                 .about =
                                     "A disk light grows far beyond the scene: planes of receivers cut it, and most of "
                                     "it is seen at grazing angles.",
                                 .unit  = "light diameter (floor side = 8)",
                                 .rungs = kGrows,
                                 .scene = growing_disk_scene};

const Ladder sphere_near_receiver_ladder{.name  = "sphere_near_receiver",
                                         .title = "Sphere light close to the receiver",
                                         .about =
                                             "A sphere light sinks to a floor and shrinks with its height: it is close "
                                             "to the floor at one position of the picture, and grazing elsewhere.",
                                         .unit  = "scene sizes above the floor",
                                         .rungs = kDown,
                                         .scene = sphere_near_receiver_scene};

const Ladder disk_near_receiver_ladder{.name  = "disk_near_receiver",
                                       .title = "Disk light close to the receiver",
                                       .about =
                                           "A disk light that is almost upright sinks to a floor and shrinks with its "
                                           "height, so that the floor is close to its rim.",
                                       .unit  = "scene sizes above the floor",
                                       .rungs = kDown,
                                       .scene = disk_near_receiver_scene};

const Ladder sphere_touches_receiver_ladder{.name  = "sphere_touches_receiver",
                                            .title = "Sphere light that touches the receiver",
                                            .about =
                                                "A sphere light sinks to a floor, which it touches on the last rung: "
                                                "points near the contact are inside its rounding.",
                                            .unit  = "scene sizes above the floor",
                                            .rungs = kDownTo0,
                                            .scene = sphere_touches_receiver_scene};

const Ladder sphere_in_face_plane_ladder{
    .name  = "sphere_in_face_plane",
    .title = "Sphere light in the plane of a face",
    .about =
        "The centre of a sphere light sinks to the plane of a box's lid, and lies in it on the last rung: the lid is "
        "seen edge-on by the middle of the light.",
    .unit  = "scene sizes above the plane",
    .rungs = kDownTo0,
    .scene = sphere_in_face_plane_scene};

const Ladder disk_in_face_plane_ladder{.name  = "disk_in_face_plane",
                                       .title = "Disk light in the plane of a face",
                                       .about =
                                           "A disk light parallel to a box's lid sinks to its plane, and lies in it on "
                                           "the last rung: the whole light sees the lid edge-on.",
                                       .unit  = "scene sizes above the plane",
                                       .rungs = kDownTo0,
                                       .scene = disk_in_face_plane_scene};

const Ladder disk_touches_occluder_ladder{
    .name  = "disk_touches_occluder",
    .title = "Disk light that touches an occluder",
    .about =
        "A lid approaches the disk light above it and hides half of it from most of the floor. On the last rung both "
        "lie in one plane, and the lid hides nothing; a box beside them does.",
    .unit  = "of the light's height",
    .rungs = kDownTo0,
    .scene = disk_touches_occluder_scene};

const Ladder sphere_touches_occluder_ladder{
    .name  = "sphere_touches_occluder",
    .title = "Sphere light that touches an occluder",
    .about = "A sphere light approaches the side of a box, which it touches on the last rung.",
    .unit  = "scene sizes between them",
    .rungs = kDownTo0,
    .scene = sphere_touches_occluder_scene};

}  // namespace umbra
