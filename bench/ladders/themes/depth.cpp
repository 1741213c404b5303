// Ladders over what is thin, and over how much lies behind one another.
#include <algorithm>
#include <cmath>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/chance.h"
#include "umbra/bench/ladders/themes/close_view.h"

namespace umbra {
namespace {

/// A closed room, 4 wide, with walls of this fraction of it, the sun outside, a point light and the eye inside.
Scene thin_walls_scene(double thickness) {
    Scene scene = empty_stage();
    Mesh walls  = make_box({4, 3, 4});
    Mesh within = make_box(vec3(dvec3(4, 3, 4) - 8 * thickness));
    for (uvec3& t : within.triangles) t = uvec3(t.x, t.z, t.y);
    for (const uvec3& t : within.triangles) walls.triangles.push_back(t + 8u);
    walls.positions.insert(walls.positions.end(), within.positions.begin(), within.positions.end());
    add_body(scene, "walls", walls);
    add_body(scene, "table", make_box({1, 0.5f, 0.75f}), at({0.25f, -1, -0.5f}));
    add_sun(scene, {-0.5f, -1, -0.75f});
    add_point_light(scene, {0.5f, 1, 0.25f});
    look(scene, {1.5f, 1, 1.5f}, {-0.5f, -0.75f, -0.5f}, 80);
    return scene;
}

/// Five closed rods side by side, this thick and as far apart.
Scene needles_scene(double width) {
    Scene scene = empty_stage();
    add_close_floor(scene, 24 * width);
    for (int i = -2; i <= 2; ++i) {
        const dvec3 corner = kHalfway - kAlong + ((2 * i - 0.5) * width) * kAcross;
        add_body(scene, "rod " + std::to_string(i + 3),
                 parallelepiped(corner, 2.0 * kAlong, {0, width, 0}, width * kAcross));
    }
    add_close_light(scene);
    return scene;
}

/// Sheets one over the other, each a little aside, so that every edge of every shadow is apart.
Scene layers_scene(double count) {
    Scene scene = floor_stage(6);
    Chance chance;
    Mesh sheets;
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) {
        const dvec3 middle = dvec3(0, 0.5 + (i + 0.5) / count, 0) + chance.in_box({0.25, 0, 0.25});
        const double turn  = chance.between(0, 2 * kPi);
        const dvec3 x      = 0.6 * dvec3(std::cos(turn), 0, std::sin(turn)),
                    z      = 0.6 * dvec3(-std::sin(turn), 0, std::cos(turn));
        const Mesh sheet   = quad(middle - x - z, middle - x + z, middle + x + z, middle + x - z);
        for (const uvec3& t : sheet.triangles) sheets.triangles.push_back(t + 4 * i);
        sheets.positions.insert(sheets.positions.end(), sheet.positions.begin(), sheet.positions.end());
    }
    add_body(scene, "sheets", sheets);
    add_point_light(scene, {0.25f, 3, 0.5f});
    look(scene, {0, 3, 4.5f}, {0, 0.2f, 0});
    return scene;
}

/// Triangles of random orientation: every edge is a silhouette.
Scene leaves_scene(double count) {
    Scene scene = floor_stage(6);
    Chance chance;
    Mesh leaves;
    const double half = 0.3 * std::max(1.0, std::sqrt(100 / count));  // few cover as much as a hundred
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) {
        const dvec3 middle = dvec3(0, 1.1, 0) + chance.in_box({1.5, 0.6, 1.5});
        for (int k = 0; k < 3; ++k) leaves.positions.emplace_back(middle + chance.in_box(dvec3(half)));
        leaves.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    add_body(scene, "leaves", leaves);
    add_point_light(scene, {0.5f, 4, 1});
    look(scene, {0, 3, 5}, {0, 0.3f, 0});
    return scene;
}

}  // namespace

const Ladder thin_walls_ladder{
    .name  = "thin_walls",
    .title = "Thin walls",
    .about =
        "A closed room has walls of this thickness, the sun is outside, a point light and the eye are inside: no "
        "sunlight may enter. A bias that keeps surfaces from shadowing themselves can let light through walls.",
    .unit  = "of the room's width",
    .rungs = powers_of_ten(-1, -8),
    .scene = thin_walls_scene};

const Ladder needles_ladder{.name  = "needles",
                            .title = "Needles",
                            .about =
                                "Five parallel rods; this is their width and the distance between them. The picture "
                                "shows only the stripes of their shadow, however thin.",
                            .unit  = "of their half length",
                            .rungs = powers_of_ten(-1, -7),
                            .scene = needles_scene};

const Ladder depth_complexity_ladder{.name  = "depth_complexity",
                                     .title = "Layers above one another",
                                     .about =
                                         "N sheets lie above one another, and the floor below them is inside N shadow "
                                         "volumes: 8-bit counters overflow at 256.",
                                     .unit  = "layers",
                                     .rungs = {1e0, 1e1, 1e2, 2.55e2, 2.56e2, 2.57e2, 1e3, 1e4},
                                     .scene = layers_scene};

const Ladder silhouette_edges_ladder{
    .name  = "silhouette_edges",
    .title = "Silhouette edges",
    .about = "N triangles with random orientation hang over a floor, and all their edges are silhouettes.",
    .unit  = "triangles",
    .rungs = {1e1, 3e1, 1e2, 3e2, 1e3, 3e3, 1e4},
    .scene = leaves_scene};

}  // namespace umbra
