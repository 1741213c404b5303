// Ladders over bad triangles: slivers, in the occluder, in the receiver and seen edge-on by the light, and triangles
// without area.
#include <cmath>
#include <vector>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/chance.h"
#include "umbra/bench/ladders/themes/close_view.h"

namespace umbra {
namespace {

constexpr int kStrips = 4;

/// Lines along z of this length in y = height, one at each coordinate x; from each to the next a strip of two
/// triangles.
Mesh strips(const std::vector<double>& x, double length, double height) {
    Mesh mesh;
    for (const double from : x) {
        mesh.positions.emplace_back(from, height, 0.5 * length);
        mesh.positions.emplace_back(from, height, -0.5 * length);
    }
    for (unsigned k = 0; k + 1 < x.size(); ++k) {
        mesh.triangles.push_back({2 * k, 2 * k + 2, 2 * k + 3});
        mesh.triangles.push_back({2 * k, 2 * k + 3, 2 * k + 1});
    }
    return mesh;
}

/// The last strips of a sheet that ends at x = 0 are slivers. The light is straight above x = 0, where floats
/// are fine enough to separate them.
Scene sliver_occluder_scene(double aspect) {
    Scene scene = empty_stage();
    add_close_floor(scene, 4 * kStrips / aspect);
    std::vector<double> x = {-1};
    for (int k = -kStrips; k <= 0; ++k) x.push_back(k / aspect);
    add_body(scene, "sheet", strips(x, 1, 1));
    add_point_light(scene, {0, 2, 0});
    return scene;
}

/// The floor is cut into slivers where the edge of a shadow runs across it.
Scene sliver_receiver_scene(double aspect) {
    Scene scene = empty_stage();
    look_closely(scene, 4 * kStrips / aspect);
    std::vector<double> x = {-2};
    for (int k = -2 * kStrips; k <= 2 * kStrips; ++k) x.push_back(k / aspect);
    x.push_back(2);
    add_body(scene, "floor", strips(x, 4, 0));
    const dvec3 middle{0, 1, 0};
    add_body(scene, "sheet",
             quad(middle - kAlong, middle + kAlong, middle + kAlong + kAcross, middle - kAlong + kAcross));
    add_point_light(scene, {0, 2, 0});
    return scene;
}

/// Triangles with sides as 8 : 7 : 1 that the sun sees almost edge-on, all turned about its direction.
Scene edge_on_scene(double angle) {
    Scene scene     = floor_stage(8);
    const dvec3 sun = glm::normalize(dvec3(-0.5, -1, -0.25));
    const dvec3 u = glm::normalize(glm::cross(sun, dvec3(0, 0, 1))), v = glm::cross(u, sun);
    Chance chance;
    Mesh leaves;
    for (unsigned i = 0; i < 2000; ++i) {
        const double turn     = chance.between(0, 2 * kPi);
        const dvec3 side      = std::cos(turn) * u + std::sin(turn) * v;
        const dvec3 long_side = std::cos(angle) * sun + std::sin(angle) * (std::cos(turn) * v - std::sin(turn) * u);
        const dvec3 corner    = dvec3(10, 20, 5) + chance.in_box({14, 18, 9});
        leaves.positions.emplace_back(corner);
        leaves.positions.emplace_back(corner + 0.8 * long_side);
        leaves.positions.emplace_back(corner + 0.7 * long_side + 0.1 * side);
        leaves.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    add_body(scene, "leaves", leaves);
    // Under the triangles, so that part of the floor is in shadow: theirs are thinner than a pixel.
    add_body(scene, "board", make_box({2.7f, 0.25f, 2.9f}), at({0.35f, 1.1f, 0.55f}));
    add_sun(scene, vec3(sun));
    look(scene, {1, 6, 8}, {0, 0, 0});
    return scene;
}

/// On, beside and above a ball: points, repeated corners and corners on one line (multiples of 1/8, so exactly).
Scene zero_area_scene(double count) {
    Scene scene = floor_stage(4);
    Mesh ball   = transformed(make_sphere(0.5f, 32, 16), at({0, 1, 0}));
    ball.normals.clear();
    Chance chance;
    const auto on_grid = [&] {  // multiples of 1/8
        const vec3 eighths(chance.in_box(dvec3(16)));
        return glm::round(eighths) / 8.0f;
    };
    for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) {
        const uvec3 good = ball.triangles[chance.below(900)];
        const auto next  = static_cast<unsigned>(ball.positions.size());
        if (i % 3 == 0) ball.triangles.push_back({good.x, good.y, good.x});
        if (i % 3 == 1) ball.triangles.push_back({good.z, good.z, good.z});
        if (i % 3 == 2) {
            const vec3 from = vec3(0, 2, 0) + 0.5f * on_grid(), step = 0.5f * on_grid();
            for (const float k : {0.0f, 0.5f, 1.0f}) ball.positions.push_back(from + k * step);
            ball.triangles.push_back({next, next + 1, next + 2});
        }
    }
    add_body(scene, "ball", ball);
    add_point_light(scene, {0.5f, 3, 0.25f});
    look(scene, {1, 3, 3.5f}, {0, 0.4f, 0});
    return scene;
}

}  // namespace

const Ladder sliver_occluder_ladder{
    .name  = "sliver_occluder",
    .title = "Slivers in the occluder",
    .about =
        "The edge of a sheet consists of triangles with this ratio of length to width. The picture shows only the end "
        "of their shadow, which must equal the shadow of an undivided sheet.",
    .unit  = "length to width",
    .rungs = powers_of_ten(1, 9),
    .scene = sliver_occluder_scene};

const Ladder sliver_receiver_ladder{
    .name  = "sliver_receiver",
    .title = "Slivers in the receiver",
    .about =
        "Where the edge of a shadow crosses the floor, the floor consists of triangles with this ratio of length to "
        "width: barycentrics, and normals computed from short sides, lose significant digits.",
    .unit  = "length to width",
    .rungs = powers_of_ten(1, 9),
    .scene = sliver_receiver_scene};

const Ladder edge_on_slivers_ladder{
    .name  = "edge_on_slivers",
    .title = "Thin triangles, almost edge-on to the light",
    .about =
        "Two thousand triangles with sides 8 : 7 : 1 make this angle with the sun's direction, on the last rung 0 "
        "except for rounding. Users of ray tracers report hits far from such triangles, which are false shadows. A "
        "board below them throws "
        "the shadow that they are too thin for.",
    .unit  = "radians",
    .rungs = tenths_to_0(),
    .scene = edge_on_scene};

const Ladder zero_area_ladder{
    .name  = "zero_area",
    .title = "Triangles without area",
    .about =
        "Triangles that are points, repeat a corner or have their corners on one line lie among the triangles of a "
        "ball and around it. They are not a surface and must not change anything.",
    .unit  = "triangles",
    .rungs = {0.0, 1e0, 1e1, 1e2, 1e3, 1e4},
    .scene = zero_area_scene};

}  // namespace umbra
