// Ladders over positions of lights (close to receivers or occluders, far away, grazing) and over their number.
#include <cmath>
#include <vector>

#include "umbra/bench/ladders/ladder.h"
#include "umbra/bench/ladders/themes/stage.h"

namespace umbra {
namespace {

const std::vector<double> kFineDown = {1e-1, 3.2e-2, 1e-2, 3.2e-3, 1e-3, 3.2e-4, 1e-4, 3.2e-5,
                                       1e-5, 3.2e-6, 1e-6, 3.2e-7, 1e-7, 3.2e-8, 1e-8};

/// A floor of cells with a post on its left half, for light that comes along x: the right half stays lit.
Scene streak_stage() {
    Scene scene = floor_stage(8, 8);
    add_body(scene, "post", make_box({0.7f, 2.1f, 2.3f}), at({-2.9f, 1.05f, -1.6f}));
    look(scene, {0.3f, 9, 6.5f}, {0.2f, 0, 0.1f}, 48);
    return scene;
}

Scene grazing_sun(double rung) {
    Scene scene = streak_stage();
    add_sun(scene, {1, -float(rung), 0.03f});
    return scene;
}

/// Turned about an axis that is none of the coordinates', so that every vertex is rounded: neighbouring cells of the
/// floor are then not quite in one plane.
Scene grazing_tilted(double rung) {
    Scene scene      = streak_stage();
    const dmat4 turn = glm::rotate(dmat4(1), 0.7, glm::normalize(dvec3(0.4, 1, -0.3)));
    const auto move  = [&](vec3& p) { p = vec3(turn * dvec4(dvec3(p), 1)); };
    for (vec3& p : scene.positions) move(p);
    for (vec3& n : scene.normals) move(n);
    move(scene.camera.eye), move(scene.camera.target), move(scene.camera.up);
    add_point_light(scene, vec3(turn * dvec4(-40, 40 * rung, 0.3, 1)));
    return scene;
}

Scene light_near_receiver(double rung) {
    Scene scene = streak_stage();
    add_point_light(scene, {-3.71f, float(8 * rung), -0.93f});
    return scene;
}

/// A lid at a distance below the light with its rim 0.1 times that beside the light: half of the floor is always dark.
Scene light_near_occluder(double rung) {
    Scene scene      = floor_stage(8);
    const vec3 light = {0.31f, 6.13f, 0.17f};
    const double gap = 6 * rung, low = double(light.y) - gap;
    add_lid(scene, {-3.1, low, -3.3}, {double(light.x) + 0.1 * gap, low, 3.2});
    add_point_light(scene, light);
    look(scene, {0.3f, 4.5f, 9}, {0.2f, 0, 0.1f}, 42);
    return scene;
}

/// One light inside a closed box, which occludes it on all sides, and one outside it that lights the floor.
Scene light_in_box(double rung) {
    Scene scene       = floor_stage(8);
    const dvec3 place = {0.37, 3.11, 0.23};
    const dvec3 half  = 10 * rung * dvec3(1, 0.8, 0.9);
    Mesh box          = make_box(vec3(2));
    for (vec3& p : box.positions) p = vec3(place + half * dvec3(p));
    add_body(scene, "box", box);
    add_point_light(scene, vec3(place + half * dvec3(0.3, -0.2, 0.1)));
    add_point_light(scene, {2.6f, 7.3f, -1.9f});
    look(scene, {-1, 8, 7}, {0, 0.5f, 0}, 38);
    return scene;
}

/// The light is at this height above the plane of the box's lid; on the last rung it lies in the plane.
Scene light_near_face_plane(double rung) {
    Scene scene = floor_stage(9);
    add_body(scene, "wall", make_box({0.3f, 5.3f, 6.1f}), at({-3.9f, 2.65f, 0}));
    const float top = 2.3f;
    Mesh box{{}, {}, {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}}};  // the bottom and the lid
    for (const float y : {0.3f, top})
        for (const vec2 p : {vec2(-1.1f, -1.3f), vec2(0.9f, -1.3f), vec2(0.9f, 0.7f), vec2(-1.1f, 0.7f)})
            box.positions.emplace_back(p.x, y, p.y);
    for (unsigned side = 0; side < 4; ++side) {
        const unsigned next = (side + 1) % 4;
        box.triangles.push_back({side, 4 + side, 4 + next});
        box.triangles.push_back({side, 4 + next, next});
    }
    add_body(scene, "box", box);
    add_point_light(scene, {3.7f, float(double(top) + 8 * rung), 0.21f});
    look(scene, {6.5f, 6.2f, 7.1f}, {-1.1f, 1.3f, 0}, 45);
    return scene;
}

Scene far_light(double rung) {
    Scene scene              = harmless_stage();
    scene.lights[0].position = vec3(8 * rung * glm::normalize(dvec3(4, 6, 1.5)));
    return scene;
}

Scene rectangle_light(double rung) {
    Scene scene     = harmless_stage();
    Light& light    = scene.lights[0];
    light.kind      = LightKind::rectangle;
    light.edge_u    = {float(rung), 0, 0};
    light.edge_v    = {0, 0, float(rung)};
    light.direction = {0, -1, 0};
    return scene;
}

Scene many_lights(double rung) {
    Scene scene  = harmless_stage();
    scene.width  = 64;
    scene.height = 48;
    scene.lights.clear();
    for (int i = 0; i < int(rung); ++i) {
        // A spiral without two lights at one position. [Helmut Vogel, A Better Way to Construct the Sunflower Head,
        // 1979]
        const double angle = 2.399963229728653 * i, radius = 5 * std::sqrt((i + 0.5) / rung);
        add_point_light(scene, vec3(dvec3(radius * std::cos(angle), 6 + i % 3, radius * std::sin(angle))));
    }
    return scene;
}

}  // namespace

const Ladder grazing_sun_ladder{
    .name  = "grazing_sun",
    .title = "Grazing light",
    .about =
        "The sun sinks to the horizon of a floor with a post. The shadow rays run along the floor on which they start, "
        "and the shadow of the post's top moves away without limit.",
    .unit  = "radians above the floor",
    .rungs = kFineDown,
    .scene = grazing_sun};

const Ladder grazing_tilted_ladder{
    .name  = "grazing_tilted",
    .title = "Grazing light over a tilted floor",
    .about =
        "A light sinks to the plane of a floor of cells, each rounded to floats. In the end the light grazes the "
        "unevenness that rounding leaves, and cells shadow their neighbours.",
    .unit  = "radians above the floor",
    .rungs = powers_of_ten(-1, -7),
    .scene = grazing_tilted};

const Ladder light_near_receiver_ladder{.name  = "light_near_receiver",
                                        .title = "Light close to the receiver",
                                        .about =
                                            "A point light sinks onto the floor that it lights: it is close to the "
                                            "floor at one end of the picture, and grazing at the other.",
                                        .unit  = "scene sizes above the floor",
                                        .rungs = powers_of_ten(-1, -7),
                                        .scene = light_near_receiver};

const Ladder light_near_occluder_ladder{
    .name  = "light_near_occluder",
    .title = "Light close to an occluder",
    .about =
        "A lid approaches the light above it, and its rim moves with it, so that half of the floor stays in shadow. "
        "Rays that end before the light, and depths that start behind the lid, miss it.",
    .unit  = "of the light's height",
    .rungs = kFineDown,
    .scene = light_near_occluder};

const Ladder light_in_box_ladder{
    .name  = "light_in_box",
    .title = "Light inside a closed occluder",
    .about =
        "A closed box shrinks around the light inside it. None of that light may reach the "
        "floor; a second light outside the box shows what is lit.",
    .unit  = "scene sizes",
    .rungs = powers_of_ten(-1, -7),
    .scene = light_in_box};

const Ladder light_near_face_plane_ladder{
    .name  = "light_near_face_plane",
    .title = "Light almost in the plane of a face",
    .about =
        "A light sinks to the plane of a box's lid; on the last rung it lies in that plane. Faces turn from lit to "
        "unlit, silhouettes jump, and shadow volumes become flat.",
    .unit  = "scene sizes above the plane",
    .rungs = tenths_to_0(),
    .scene = light_near_face_plane};

const Ladder far_light_ladder{
    .name  = "far_light",
    .title = "Distant light",
    .about =
        "A point light moves away until it acts as a sun: depths measured from the light lose "
        "the differences inside the scene.",
    .unit  = "scene sizes",
    .rungs = powers_of_ten(1, 12),
    .scene = far_light};

const Ladder shrinking_light_ladder{
    .name  = "shrinking_light",
    .title = "Area light that shrinks to a point",
    .about =
        "A square light shrinks until its penumbra is narrower than a pixel: the result "
        "must converge to that of the point light.",
    .unit  = "light side (floor side = 8)",
    .rungs = powers_of_ten(0, -12),
    .scene = rectangle_light};

const Ladder growing_light_ladder{.name  = "growing_light",
                                  .title = "Area light that becomes huge",
                                  .about =
                                      "A square light grows far beyond the scene: the umbra vanishes, and most of the "
                                      "light is seen at grazing angles.",
                                  .unit  = "light side (floor side = 8)",
                                  .rungs = {1e0, 3.2, 1e1, 3.2e1, 1e2, 1e4, 1e6, 1e9},
                                  .scene = rectangle_light};

const Ladder many_lights_ladder{
    .name  = "many_lights",
    .title = "Number of lights",
    .about = "More and more point lights in a spiral above the scene, each with its own shadows.",
    .unit  = "lights",
    .rungs = {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0},
    .scene = many_lights};

}  // namespace umbra
