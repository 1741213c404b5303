#include "umbra/tests/support/known_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <stdexcept>
#include <string>

#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

Mesh moved(const Mesh& mesh, vec3 by) { return transformed(mesh, glm::translate(mat4(1), by)); }
Mesh turned(const Mesh& mesh, float radians, vec3 axis) {
    return transformed(mesh, glm::rotate(mat4(1), radians, axis));
}

void add(Scene& scene, std::string_view name, const Mesh& mesh) {
    add_object(scene, std::string(name), mesh.positions, {}, mesh.triangles, 0);
}

Light& add_light(Scene& scene, LightKind kind) {
    Light& light = scene.lights.emplace_back();
    light.name   = std::string("light") + std::to_string(scene.lights.size());
    light.kind   = kind;
    return light;
}
void add_sun(Scene& scene, vec3 direction) { add_light(scene, LightKind::directional).direction = direction; }
void add_lamp(Scene& scene, vec3 position) { add_light(scene, LightKind::point).position = position; }

/// A floor in y = 0, seen from the front.
Scene floor_scene(float size = 8) {
    Scene scene;
    scene.materials.emplace_back();
    scene.camera.eye = {0, 4, 7};
    scene.width      = 96;
    scene.height     = 64;
    add(scene, "floor", make_plane(size, size));
    return scene;
}

/// 0 within |x| < rx, |z| < rz, 1 outside, nothing within rounding of its outline.
std::optional<double> outside_rectangle(double x, double z, double rx, double rz) {
    const double depth = std::max(std::abs(x) - rx, std::abs(z) - rz);
    if (std::abs(depth) < 1e-6) return std::nullopt;
    return depth > 0 ? 1 : 0;
}

KnownScene square_under_sun() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "square", moved(make_plane(1, 1), {0, 1, 0}));
    add_sun(known.scene, {1, -2, 0.5f});
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 0.5) return 1;
        return outside_rectangle(p.x - 0.5, p.z - 0.25, 0.5, 0.5);
    };
    return known;
}

/// The light at height 2 over a unit square at height 1: on the floor its shadow is a 2 by 2 square.
KnownScene square_under_lamp() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "square", moved(make_plane(1, 1), {0, 1, 0}));
    add_lamp(known.scene, {0, 2, 0});
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 0.5) return 1;
        return outside_rectangle(p.x, p.z, 1, 1);
    };
    return known;
}

KnownScene light_at_eye() {
    KnownScene known{floor_scene(), [](dvec3, LightId) { return 1; }, 0};
    add(known.scene, "box", moved(make_box({1, 1, 1}), {-1, 0.5f, 0}));
    add(known.scene, "ball", moved(make_sphere(0.7f, 24, 12), {1, 1, 1}));
    add_lamp(known.scene, known.scene.camera.eye);
    return known;
}

/// The shadow of a ball is an ellipse: floor points whose ray passes the centre closer than the radius. The mesh is
/// inscribed; between it and the ball the formula says nothing.
KnownScene ball_under_sun() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "ball", moved(make_sphere(0.8f, 48, 24), {-0.5f, 1.2f, 0}));
    add_sun(known.scene, {1, -1, 0.3f});
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 1e-4) return std::nullopt;
        const double r = 0.8, distance = glm::length(glm::cross(
                                  dvec3(-0.5, 1.2, 0) - p, glm::normalize(dvec3(1, -1, static_cast<double>(0.3f)))));
        const double inscribed = r * std::cos(kPi / 24) * std::cos(kPi / 48);
        if (distance > r + 1e-6) return 1;
        if (distance < inscribed - 1e-6) return 0;
        return std::nullopt;
    };
    return known;
}

KnownScene box_seen_from(vec3 eye) {
    KnownScene known{floor_scene(), {}, 0};
    known.scene.camera.eye = eye;
    add(known.scene, "box", turned(moved(make_box({1, 2, 1}), {0.2f, 1, -0.3f}), 0.4f, {0, 1, 0}));
    add_lamp(known.scene, {2.5f, 4, 1.5f});
    return known;
}
KnownScene box_from_front() { return box_seen_from({0, 3, 7}); }
KnownScene box_from_left() { return box_seen_from({-7, 3, 0.5f}); }
KnownScene box_from_behind() { return box_seen_from({-3, 2, -6}); }
KnownScene box_from_above() { return box_seen_from({0.1f, 9, 0.2f}); }

KnownScene box_orthographic() {
    KnownScene known              = box_seen_from({4, 4, 7});
    known.scene.camera.projection = Projection::orthographic;
    known.scene.camera.height     = 6;
    return known;
}

/// The eye is in the shadow of the slab over it.
KnownScene eye_in_umbra() {
    KnownScene known{floor_scene(20), {}, 0};
    add(known.scene, "slab", moved(make_box({4, 0.2f, 4}), {0, 4, 0}));
    add(known.scene, "post", moved(make_cylinder(0.3f, 2, 16), {1, 1, -3}));
    add_lamp(known.scene, {0.5f, 9, 0.3f});
    known.scene.camera.eye    = {0.2f, 1.5f, 1.5f};
    known.scene.camera.target = {0.2f, 0.5f, -3};
    known.scene.camera.fov_y  = 90;
    return known;
}

/// Three cubes under a sun that falls along x. The first casts no shadow, the second receives none, though a board over
/// it shades its top, and the eye does not see the third. Shadows of cubes are 2 by 1.
KnownScene switched_off() {
    KnownScene known{floor_scene(), {}, 0};
    for (const float z : {-1.5f, 0.0f, 1.5f}) add(known.scene, "cube", moved(make_box({1, 1, 1}), {-1.5f, 1.5f, z}));
    add(known.scene, "board", moved(make_plane(1.4f, 1.4f), {-2.5f, 3, 0}));
    known.scene.objects[1].switches.casts_shadows    = false;
    known.scene.objects[2].switches.receives_shadows = false;
    known.scene.objects[3].switches.seen_by_camera   = false;
    add_sun(known.scene, {1, -1, 0});
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 1e-9) return std::nullopt;
        const auto second = outside_rectangle(p.x, p.z, 1, 0.5), third = outside_rectangle(p.x, p.z - 1.5, 1, 0.5),
                   board = outside_rectangle(p.x - 0.5, p.z, 0.7, 0.7);
        if (!second || !third || !board) return std::nullopt;
        return std::min({*second, *third, *board});
    };
    return known;
}

/// A box without its lid, and a bowl.
KnownScene open_meshes() {
    KnownScene known{floor_scene(), {}, 0};
    Mesh box = make_box({1.5f, 1, 1.5f});
    std::erase_if(box.triangles, [&](uvec3 t) {
        return box.positions[t.x].y > 0 && box.positions[t.y].y > 0 && box.positions[t.z].y > 0;
    });
    add(known.scene, "box without a lid", moved(box, {-1.3f, 0.5f, 0}));
    Mesh bowl = make_sphere(0.8f, 24, 12);
    std::erase_if(bowl.triangles, [&](uvec3 t) {
        return std::max({bowl.positions[t.x].y, bowl.positions[t.y].y, bowl.positions[t.z].y}) > 0.3f;
    });
    add(known.scene, "bowl", moved(bowl, {1.3f, 1.2f, 0}));
    add_lamp(known.scene, {0.5f, 5, 2});
    return known;
}

/// A third of the triangles is wound the wrong way.
KnownScene badly_oriented() {
    KnownScene known{floor_scene(), {}, 0};
    Mesh ball = make_sphere(1, 24, 12);
    for (std::size_t t = 0; t < ball.triangles.size(); t += 3) std::swap(ball.triangles[t].x, ball.triangles[t].y);
    add(known.scene, "ball", moved(ball, {-1, 1.1f, 0}));
    Mesh box = make_box({1, 1, 1});
    for (std::size_t t = 0; t < box.triangles.size(); t += 3) std::swap(box.triangles[t].x, box.triangles[t].y);
    add(known.scene, "box", moved(box, {1.5f, 0.5f, 0.5f}));
    add_lamp(known.scene, {0.5f, 5, 2});
    return known;
}

KnownScene interpenetrating() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "box", moved(make_box({1.5f, 1, 1}), {0, 0.6f, 0}));
    add(known.scene, "tilted", moved(turned(make_box({1, 2, 0.7f}), 0.8f, {0.6f, 0.8f, 0}), {0.3f, 0.9f, 0.2f}));
    add(known.scene, "ball", moved(make_sphere(0.5f, 16, 8), {0.6f, 0.2f, 0.5f}));
    add_lamp(known.scene, {-2, 4, 2.5f});
    return known;
}

/// The light is in the plane of a wall: edge-on, the shadow of the wall is only a line.
KnownScene light_over_wall() {
    KnownScene known{floor_scene(), [](dvec3, LightId) { return 1; }, 0};
    add(known.scene, "wall", Mesh{{{-1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 1, 0}}, {}, {{0, 1, 2}, {0, 2, 3}}});
    add_lamp(known.scene, {0.3f, 3, 0});
    return known;
}

/// The light is exactly above an edge of a box, in the plane of one of its sides.
KnownScene light_over_edge() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "box", moved(make_box({2, 1, 2}), {0, 0.5f, 0}));
    add_lamp(known.scene, {1, 3, 0.25f});
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 1e-9) return std::nullopt;
        // The top, from the light at height 3: x from 1 - 2 * 1.5 to 1, z from 0.25 -+ ... in the same way.
        const double z = 0.25 * (1 - 1.5);
        return outside_rectangle(p.x + 0.5, p.z - z, 1.5, 1.5);
    };
    return known;
}

KnownScene two_lights() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "box", moved(make_box({1, 1.4f, 1}), {-1, 0.7f, 0}));
    add(known.scene, "ball", moved(make_sphere(0.7f, 24, 12), {1, 1, 0.5f}));
    add_sun(known.scene, {-0.7f, -1, -0.4f});
    add_lamp(known.scene, {-3, 3, 2});
    return known;
}

/// Three sheets that meet in one edge, and two boxes that meet in one.
KnownScene non_manifold() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "fan",
        moved(Mesh{{{0, 0, -1}, {0, 0, 1}, {1, 0.6f, 0}, {-1, 0.3f, 0}, {0.1f, 1, 0}},
                   {},
                   {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}},
              {-1.5f, 0.5f, 0}));
    Mesh boxes       = moved(make_box({0.8f, 0.8f, 0.8f}), {0, 0.4f, 0});
    const Mesh other = moved(make_box({0.8f, 0.8f, 0.8f}), {0.8f, 1.2f, 0});
    for (const uvec3& t : other.triangles) boxes.triangles.push_back(t + static_cast<unsigned>(boxes.positions.size()));
    boxes.positions.insert(boxes.positions.end(), other.positions.begin(), other.positions.end());
    add(known.scene, "boxes", moved(boxes, {0.8f, 0, 0}));
    add_lamp(known.scene, {-1, 5, 2});
    return known;
}

/// Triangles without area, and triangles twice.
KnownScene degenerate() {
    KnownScene known{floor_scene(), {}, 0};
    Mesh box = moved(make_box({1, 1, 1}), {0, 1, 0});
    for (unsigned t = 0; t < 4; ++t) {
        box.triangles.push_back(box.triangles[t]);                             // twice
        box.triangles.push_back({box.triangles[t].y, t, box.triangles[t].y});  // a corner twice
    }
    box.positions.push_back(0.5f * (box.positions[0] + box.positions[7]));
    box.triangles.push_back({0, 7, 8});  // on a line
    box.triangles.push_back({8, 8, 8});  // a point
    add(known.scene, "box", box);
    add_lamp(known.scene, {1, 4, 1.5f});
    return known;
}

KnownScene tilted_floor() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "box", moved(make_box({1, 1, 1}), {-1, 0.5f, 0}));
    add(known.scene, "ball", moved(make_sphere(0.6f, 24, 12), {1, 0.9f, 0.5f}));
    const mat4 m = glm::rotate(glm::rotate(mat4(1), 0.35f, {0, 0, 1}), 0.25f, {1, 0, 0});
    for (vec3& p : known.scene.positions) p = vec3(m * vec4(p, 1));
    add_lamp(known.scene, {0.5f, 4, 2});
    add_sun(known.scene, {0.8f, -1, -0.2f});
    return known;
}

KnownScene far_from_origin() {
    KnownScene known = two_lights();
    const vec3 far(5000, 0, -3000);
    for (vec3& p : known.scene.positions) p += far;
    for (Light& light : known.scene.lights) light.position += far;
    known.scene.camera.eye += far;
    known.scene.camera.target += far;
    return known;
}

/// What lies behind the light, and what lies under the floor, casts no shadow on it.
KnownScene no_anti_shadows() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "lamp shade", moved(make_cone(0.5f, 0.4f, 16), {0.5f, 2.4f, 0}));
    add(known.scene, "under the floor", moved(make_box({2, 0.5f, 2}), {0, -1, 0}));
    add_lamp(known.scene, {0.5f, 2, 0});
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        return p.y > 1e-9 ? std::nullopt : std::optional<double>(1);
    };
    return known;
}

/// A long triangle that passes through the floor and reaches above the light.
KnownScene beyond_light_and_floor() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "sail", Mesh{{{-2, -1, -0.5f}, {1, -0.5f, 0.5f}, {2, 5, -1}}, {}, {{0, 1, 2}}});
    add(known.scene, "mast", turned(moved(make_cylinder(0.1f, 6, 12), {0, 1.5f, 0}), 0.5f, {1, 0, 0}));
    add_lamp(known.scene, {-0.5f, 3, 1});
    return known;
}

KnownScene spot_light() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "torus", turned(moved(make_torus(0.8f, 0.3f, 24, 12), {0, 1, 0}), 0.3f, {1, 0, 0}));
    Light& light      = add_light(known.scene, LightKind::spot);
    light.position    = {1, 4, 1};
    light.direction   = glm::normalize(vec3(-0.2f, -1, -0.2f));
    light.spot.cutoff = 0.4f;
    return known;
}

/// A room seen from within, its light under the ceiling: six receivers, all around.
KnownScene room() {
    KnownScene known{floor_scene(), {}, 0};
    add(known.scene, "walls", moved(make_box({6, 3, 6}), {0, 1.6f, 0}));
    add(known.scene, "table", moved(make_box({1.5f, 0.1f, 1}), {0.5f, 1, -0.5f}));
    add(known.scene, "ball", moved(make_sphere(0.4f, 16, 8), {-1, 1.5f, -1}));
    add_lamp(known.scene, {0.3f, 2.8f, 0.2f});
    known.scene.camera.eye    = {1.5f, 1.8f, 2.5f};
    known.scene.camera.target = {-0.5f, 1, -1};
    known.scene.camera.fov_y  = 80;
    return known;
}

/// A rectangle light of half-width a at height 4 over a half-plane x > 0 at height 2: the floor point x sees the part
/// of the light below X* = -x (4 - 2) / 2.
KnownScene penumbra_of_half_plane() {
    KnownScene known{floor_scene(), {}, 0.12};
    add(known.scene, "half-plane", moved(make_plane(40, 80), {20, 2, 0}));
    Light& light              = add_light(known.scene, LightKind::rectangle);
    light.position            = {0, 4, 0};
    light.edge_u              = {1.5f, 0, 0};
    light.edge_v              = {0, 0, -1};
    light.direction           = {0, 1, 0};
    known.scene.camera.eye    = {-6, 1.8f, 3};
    known.scene.camera.target = {0, 0, 0};
    known.closed_form         = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 1e-9) return std::nullopt;
        return std::clamp((-p.x + 0.75) / 1.5, 0.0, 1.0);
    };
    return known;
}

/// The fraction of a disk's area on one side of a chord; `chord` is its distance from the centre, in radii.
double left_of_chord(double chord) {
    const double t = std::clamp(chord, -1.0, 1.0);
    return 1 - (std::acos(t) - t * std::sqrt(1 - t * t)) / kPi;
}

/// The half-plane under a disk of radius 0.75 in place of the rectangle.
KnownScene penumbra_of_a_disk() {
    KnownScene known  = penumbra_of_half_plane();
    Light& light      = known.scene.lights[0];
    light.kind        = LightKind::disk;
    light.radius      = 0.75f;
    light.direction   = {0, -1, 0};
    known.closed_form = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 1e-9) return std::nullopt;
        return left_of_chord(-p.x / 0.75);
    };
    return known;
}

/// Of a sphere p sees the circle in which the cone from p touches it. The plane through p and the half-plane's edge
/// cuts it at a distance that is to its radius as the tangent of the angle from the cone's axis is to that of the
/// cone's own.
KnownScene penumbra_of_a_sphere() {
    KnownScene known           = penumbra_of_a_disk();
    known.scene.lights[0].kind = LightKind::sphere;
    known.closed_form          = [](dvec3 p, LightId) -> std::optional<double> {
        if (p.y > 1e-9) return std::nullopt;
        const dvec3 way    = dvec3(0, 4, 0) - p;
        const double d     = glm::length(way);
        const dvec3 normal = glm::normalize(dvec3(2, p.x, 0));  // of that plane
        const double sine = -glm::dot(normal, way) / d, cone = 0.75 / d;
        return left_of_chord(sine / std::sqrt(1 - sine * sine) * std::sqrt(1 - cone * cone) / cone);
    };
    return known;
}

/// Whether the segment from p to the light meets triangle x: 1 it does, 0 it does not, -1 rounding decides.
int meets(dvec3 p, dvec3 to_light, bool infinite, const std::array<dvec3, 3>& x) {
    constexpr double kRounding = 1e-9;
    const dvec3 a = x[0] - p, b = x[1] - p, c = x[2] - p;
    const dvec3 n    = glm::cross(b - a, c - a);
    const double top = glm::dot(n, a), bottom = glm::dot(n, to_light);
    const double size = glm::length(n) * glm::length(to_light);
    if (!(std::abs(bottom) > kRounding * size)) return 0;  // edge-on, or no area
    const double t   = top / bottom;                       // where the ray passes the triangle's plane
    const double far = infinite ? std::numeric_limits<double>::infinity() : 1;
    // The slack is a distance, turned into the ray's parameter.
    const double slack = kRounding * (1 + glm::length(a)) * glm::length(n) / std::abs(bottom);
    if (t < -slack || t > far + slack) return 0;

    bool inside = true, near = false;
    const dvec3 v[3] = {a, b, c};
    for (int k = 0; k < 3; ++k) {
        const dvec3 from = v[k], to = v[(k + 1) % 3];
        const dvec3 edge_plane = glm::cross(to_light, to - from);
        const double length    = glm::length(edge_plane);
        // Distance of the ray from the edge's line, positive inside.
        const double distance = (bottom > 0 ? -1 : 1) * glm::dot(edge_plane, from) / (length > 0 ? length : 1);
        if (distance < -kRounding * (1 + glm::length(from))) inside = false;
        if (std::abs(distance) <= kRounding * (1 + glm::length(from))) near = true;
    }
    if (!inside) return 0;
    if (near || std::abs(t) <= slack || std::abs(t - far) <= slack) return -1;
    return 1;
}

}  // namespace

const std::vector<NamedScene>& known_scenes() {
    static const std::vector<NamedScene> list = {
        {"square_under_sun", square_under_sun},
        {"square_under_lamp", square_under_lamp},
        {"light_at_eye", light_at_eye},
        {"ball_under_sun", ball_under_sun},
        {"box_from_front", box_from_front},
        {"box_from_left", box_from_left},
        {"box_from_behind", box_from_behind},
        {"box_from_above", box_from_above},
        {"box_orthographic", box_orthographic},
        {"eye_in_umbra", eye_in_umbra},
        {"switched_off", switched_off},
        {"open_meshes", open_meshes},
        {"badly_oriented", badly_oriented},
        {"interpenetrating", interpenetrating},
        {"light_over_wall", light_over_wall},
        {"light_over_edge", light_over_edge},
        {"two_lights", two_lights},
        {"non_manifold", non_manifold},
        {"degenerate", degenerate},
        {"tilted_floor", tilted_floor},
        {"far_from_origin", far_from_origin},
        {"no_anti_shadows", no_anti_shadows},
        {"beyond_light_and_floor", beyond_light_and_floor},
        {"spot_light", spot_light},
        {"room", room},
        {"penumbra_of_half_plane", penumbra_of_half_plane},
        {"penumbra_of_a_disk", penumbra_of_a_disk},
        {"penumbra_of_a_sphere", penumbra_of_a_sphere},
    };
    return list;
}

KnownScene known_scene(std::string_view name) {
    for (const NamedScene& scene : known_scenes())
        if (scene.name == name) return scene.make();
    throw std::logic_error("no such known scene");
}

dvec3 place(const Scene& scene, const PointBatch& points, std::size_t i) {
    const TriangleId t = points.triangle[i];
    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    return a + static_cast<double>(points.u[i]) * (b - a) + static_cast<double>(points.v[i]) * (c - a);
}

VisibilityPlane brute_force(const Scene& scene, const PointBatch& points, LightId id) {
    const Light& light = scene.lights[id];
    if (is_area(light.kind)) throw std::logic_error("brute force is for hard lights");
    const bool infinite = light.kind == LightKind::directional;
    VisibilityPlane plane(points.size());
    parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (points.facing[id][i] != Facing::front) continue;
            const dvec3 p        = place(scene, points, i);
            const dvec3 to_light = infinite ? -dvec3(light.direction) : dvec3(light.position) - p;
            bool blocked = false, open = false;
            for (TriangleId t = 0; t < scene.triangles.size() && !blocked; ++t) {
                if (t == points.triangle[i] || !scene.switches(t).casts_shadows) continue;
                const int m = meets(p, to_light, infinite,
                                    {dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))});
                blocked |= m == 1;
                open |= m == -1;
            }
            plane.s[i] = blocked ? 0.0f : 1.0f;
            if (!blocked && open) plane.answer[i] = Answer::undefined;
        }
    });
    return plane;
}

VisibilityPlane by_formula(const KnownScene& known, const PointBatch& points, LightId light) {
    VisibilityPlane plane(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Facing facing = points.facing[light][i];
        if (facing == Facing::none || facing == Facing::away) continue;
        const std::optional<double> s = known.closed_form(place(known.scene, points, i), light);
        plane.s[i]                    = static_cast<float>(s.value_or(0));
        if (!s) plane.answer[i] = Answer::undefined;
    }
    return plane;
}

VisibilityPlane truth(const KnownScene& known, const PointBatch& points, LightId light) {
    return is_area(known.scene.lights[light].kind) ? by_formula(known, points, light)
                                                   : brute_force(known.scene, points, light);
}

}  // namespace umbra
