// Ladders over the eye, and over what exactly aligned or nearly touching things do to rays and volumes.
#include <cmath>
#include <vector>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/stage.h"

namespace umbra {
namespace {

const std::vector<double> kCells = {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 96.0, 192.0};

/// The eye under a stack of sheets, lit from above: it is in as many shadow volumes as there are sheets.
Scene eye_in_volumes(double rung) {
    Scene scene = floor_stage(12);
    const int n = int(rung);
    for (int i = 0; i < n; ++i) {
        // From 4 to 5 above the floor, each a little smaller and turned a little.
        const double share = n == 1 ? 0 : double(i) / (n - 1);
        mat4 place         = at({0.1f, float(4 + share), 0.2f});
        place              = glm::rotate(place, float(0.6 * share), vec3(0, 1, 0));
        add_body(scene, "sheet " + std::to_string(i + 1), make_plane(float(3 - share), float(3 - share)), place);
    }
    add_point_light(scene, {0.3f, 9, 0.4f});
    look(scene, {0.4f, 3.1f, 1.2f}, {0.1f, 0, 0.1f}, 110);
    return scene;
}

/// The eye at this distance from the side of a box's shadow volume, outside it; on the last rung in its plane.
Scene eye_near_volume_side(double rung) {
    Scene scene = floor_stage(8);
    add_body(scene, "box", make_box(vec3(2)), at({-1, 4, 0}));
    add_sun(scene, {0, -1, 0});
    look(scene, {float(8 * rung), 2, 3.5f}, {0.25f, 0, -0.25f}, 80);
    return scene;
}

/// The camera far away, its angle narrowed so that the picture stays.
Scene far_eye(double rung) {
    Scene scene        = harmless_stage();
    const dvec3 away   = glm::normalize(dvec3(scene.camera.eye) - dvec3(scene.camera.target));
    const double reach = glm::length(dvec3(scene.camera.eye) - dvec3(scene.camera.target));
    const double tan   = std::tan(glm::radians(double(scene.camera.fov_y)) / 2);
    scene.camera.eye   = vec3(dvec3(scene.camera.target) + 8 * rung * away);
    scene.camera.fov_y = float(2 * glm::degrees(std::atan(tan * reach / (8 * rung))));
    return scene;
}

/// Boxes at distances 1.5, 6, 24 ... from the eye, each as large as it is far, up to `rung`.
Scene near_to_far(double rung) {
    Scene scene = empty_stage();
    // The floor begins behind the eye. It is cut into strips as long as they are far, so that barycentrics near the eye
    // are as fine on the last rung as on the first: coarse ones are the subject of large_floor.
    Mesh floor{{{-4, 0, 1}, {4, 0, 1}}, {}, {}};
    for (double distance = 1; distance < 8 * rung; distance *= 4) {
        const auto d     = float(distance);
        const auto first = static_cast<unsigned>(floor.positions.size()) - 2;
        floor.positions.emplace_back(-4 * d, 0, -d);
        floor.positions.emplace_back(4 * d, 0, -d);
        floor.triangles.push_back({first, first + 1, first + 3});
        floor.triangles.push_back({first, first + 3, first + 2});
    }
    add_body(scene, "floor", floor);
    int i = 0;
    for (double distance = 1.5; distance <= rung; distance *= 4, ++i) {
        const auto d = float(distance);
        add_body(scene, "box " + std::to_string(i + 1), make_box({0.4f * d, 0.4f * d, 0.2f * d}),
                 at({(i % 2 ? 0.35f : -0.35f) * d, 0.2f * d, -d}));
    }
    add_sun(scene, {0.8f, -0.6f, 0.3f});
    look(scene, {0, 0.8f, 0.5f}, {0, 0, -1.5f}, 60);
    return scene;
}

/// A wall that floats at this height above the floor, with a view in which the gap is some pixels high at every rung;
/// sunlight passes through the gap, and past the end of the wall, which is in the picture.
Scene gap(double rung) {
    Scene scene       = empty_stage();
    const dvec3 foot  = {3.3, 1.7, 2.1};  // nothing is at 0, where floats are finer
    const double wide = 8 * (rung > 0 ? rung : 1e-3);
    const auto place  = [&](double x, double y, double z) { return vec3(foot + dvec3(x, y, z)); };
    add_object(scene, "floor", {place(-4, 0, 4), place(4, 0, 4), place(4, 0, -4), place(-4, 0, -4)}, {},
               {{0, 1, 2}, {0, 2, 3}}, 0);
    const double low = 8 * rung;
    Mesh wall        = make_box(vec3(1));
    // As thin as a part of the gap: light that falls by 0.55 of its way would not get through below a thick one.
    for (vec3& p : wall.positions)
        p = place(0.3 + 2 * wide + 6 * (double(p.x) - 0.5), low + 1 + 2 * double(p.y),
                  0.25 * wide * (double(p.z) - 0.5));
    add_body(scene, "wall", wall);
    add_sun(scene, {0.2f, -0.55f, 1});
    scene.camera = {.projection = Projection::orthographic,
                    .eye        = vec3(foot + dvec3(0.3, 1.5, 2.5)),
                    .target     = vec3(foot + dvec3(0.3, 0, 1.2 * wide)),
                    .height     = float(6 * wide)};
    return scene;
}

/// A floor seen from 1 above it, so that the picture's pixels are 0.1 wide there.
Scene aligned_stage() {
    Scene scene = floor_stage(12);
    scene.width = 96, scene.height = 96;
    scene.camera = {.projection = Projection::orthographic,
                    .eye        = {0, 1, 0},
                    .target     = {0, 0, 0},
                    .up         = {0, 0, -1},
                    .height     = 9.6f};
    return scene;
}

/// A closed sheet of cells over most of the picture, whose corners and edges lie over its points, except for
/// rounding: a method that lets a ray pass between two triangles that share an edge lets light through.
Scene aligned_lattice(double rung) {
    Scene scene = aligned_stage();
    // Above the eye, with cells of a multiple or a half of a pixel, and aside by 24 pixels: the left quarter of the
    // picture is lit.
    add_body(scene, "sheet", make_plane(9.6f, 9.6f, int(rung)), at({2.45f, 2, 0.05f}));
    add_sun(scene, {0, -1, 0});
    return scene;
}

/// The same for a point light at twice the sheet's height, under which the sheet's shadow is twice as large.
Scene aligned_light(double rung) {
    Scene scene = aligned_stage();
    add_body(scene, "sheet", make_plane(4.8f, 4.8f, int(rung)), at({1.225f, 2, 0.025f}));
    add_point_light(scene, {0, 4, 0});
    return scene;
}

}  // namespace

const Ladder eye_in_volumes_ladder{.name  = "eye_in_volumes",
                                   .title = "Eye inside shadow volumes",
                                   .about =
                                       "The eye is in the shadow of more and more sheets. A count that starts at the "
                                       "eye must start with their number, and hardware counters overflow at 255.",
                                   .unit  = "sheets",
                                   .rungs = {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0},
                                   .scene = eye_in_volumes};

const Ladder eye_near_volume_side_ladder{
    .name  = "eye_near_volume_side",
    .title = "Eye close to the side of a shadow volume",
    .about =
        "The eye approaches the side of a shadow volume; on the last rung it lies in the plane of that side. It sees "
        "the side edge-on, and a method may count it at one side of a pixel and not at the other.",
    .unit  = "scene sizes",
    .rungs = tenths_to_0(),
    .scene = eye_near_volume_side};

const Ladder far_eye_ladder{.name  = "far_eye",
                            .title = "Distant eye",
                            .about =
                                "The camera moves away while its field of view narrows, so that the picture stays the "
                                "same: the directions of neighbouring pixels differ by fewer and fewer float steps.",
                            .unit  = "scene sizes",
                            .rungs = powers_of_ten(1, 9),
                            .scene = far_eye};

const Ladder near_to_far_ladder{.name  = "near_to_far",
                                .title = "Near to far",
                                .about =
                                    "Boxes on one floor, from close to the eye to the horizon, with sizes proportional "
                                    "to their distances: one light casts shadows of very different sizes.",
                                .unit  = "farthest to nearest distance",
                                .rungs = powers_of_ten(1, 9),
                                .scene = near_to_far};

const Ladder gap_ladder{.name  = "gap",
                        .title = "Gap between occluder and receiver",
                        .about =
                            "A wall approaches the floor while the camera zooms in, so that the light through the gap "
                            "stays visible; on the last rung the wall touches the floor. Bias closes or opens gaps.",
                        .unit  = "scene sizes",
                        .rungs = tenths_to_0(),
                        .scene = gap};

const Ladder aligned_lattice_ladder{
    .name  = "aligned_lattice",
    .title = "Sun exactly above edges and vertices",
    .about =
        "The edges and vertices of a sheet of cells lie above the points of the picture, except for rounding. Rays "
        "pass exactly through them or miss them by the last digit; leaks of ray tracers are reported there.",
    .unit  = "cells per side",
    .rungs = kCells,
    .scene = aligned_lattice};

const Ladder aligned_light_ladder{
    .name  = "aligned_light",
    .title = "Point light exactly above edges and vertices",
    .about = "The same sheet under a point light: the rays are oblique and meet edges and vertices at every angle.",
    .unit  = "cells per side",
    .rungs = kCells,
    .scene = aligned_light};

}  // namespace umbra
