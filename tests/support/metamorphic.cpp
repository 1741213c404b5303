#include "umbra/tests/support/metamorphic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "umbra/core/base/geometry.h"
#include "umbra/core/render/gbuffer.h"

namespace umbra {
namespace {

// ---- numbers with few bits -----------------------------------------------------------------------------------------

/// The power of two above v.
double above(double v) { return v > 0 ? std::exp2(std::floor(std::log2(v)) + 1) : 1; }

/// v rounded to a multiple of `step`. Floats so large that their own step is coarser stay as they are.
vec3 coarse(vec3 v, double step) { return {glm::round(dvec3(v) / step) * step}; }

double largest_coordinate(const Scene& scene) {
    const Box box = bounds(scene);
    if (box.empty()) return 1;
    const vec3 far = glm::max(glm::abs(box.min), glm::abs(box.max));
    return std::max({far.x, far.y, far.z});
}

/// Barycentrics as odd multiples of 2^-13, the third weight neither 0 nor one half. (It is an even multiple.)
void set_dyadic_point(Question& asked, std::size_t i) {
    constexpr int kOne   = 1 << 13;
    constexpr auto kHalf = static_cast<float>(kOne) / 2;
    const auto odd       = [](float x) { return 2 * static_cast<int>(std::floor(x * kHalf)) + 1; };
    PointBatch& points   = asked.points;
    const TriangleId id  = points.triangle[i];
    int u = std::clamp(odd(points.u[i]), 1, kOne - 3), v = std::clamp(odd(points.v[i]), 1, kOne - 3);
    while (kOne - u - v <= 0 || kOne - u - v == kOne / 2) (v > 1 ? v : u) -= 2;
    points.triangle[i] = kNoTriangle;
    set_point(points, i, asked.scene, id, static_cast<float>(u) / kOne, static_cast<float>(v) / kOne);
}

// ---- points by their names -----------------------------------------------------------------------------------------

/// Names of points: triangle, u, v of each.
struct Names {
    std::vector<TriangleId> triangle;
    std::vector<float> u, v;
};

/// A batch of points with these names as the scene's camera sees them; `raster` as in `like`.
PointBatch named(const Scene& scene, const Names& names, const PointBatch& like) {
    PointBatch points;
    points.eye = scene.camera.eye;
    if (like.raster) points.raster = frame(scene.camera, like.raster->width, like.raster->height);
    points.resize(names.triangle.size());
    for (std::size_t i = 0; i < names.triangle.size(); ++i)
        if (names.triangle[i] != kNoTriangle) set_point(points, i, scene, names.triangle[i], names.u[i], names.v[i]);
    face_lights(points, scene);
    return points;
}

/// Nothing changed as yet.
struct Draft {
    Scene scene;
    Names names;
    std::vector<std::size_t> point;
    std::vector<std::vector<Changed::Part>> lights;
    bool exact = true;

    explicit Draft(const Question& from)
        : scene(from.scene),
          names{from.points.triangle, from.points.u, from.points.v},
          point(from.points.size()),
          lights(from.scene.lights.size()) {
        std::iota(point.begin(), point.end(), 0);
        for (LightId j = 0; j < lights.size(); ++j) lights[j] = {{j, 1}};
    }

    [[nodiscard]] Changed finished(const Question& from) && {
        PointBatch points = named(scene, names, from.points);
        return {{std::move(scene), std::move(points)}, std::move(point), std::move(lights), exact};
    }
};

// ---- affine maps ---------------------------------------------------------------------------------------------------

/// x -> scale * turn * x + move, where `turn` is orthogonal and mirrors where its determinant is negative.
struct Map {
    dmat3 turn{1};
    double scale = 1;
    dvec3 move{0};
};

/// Rounds to float and notes whether that changed anything.
vec3 rounded(dvec3 v, bool& exact) {
    const vec3 r(v);
    exact = exact && dvec3(r) == v;
    return r;
}

void apply(const Map& map, Light& light, bool mirror, bool& exact) {
    const auto vector = [&](vec3 v) { return rounded(map.scale * (map.turn * dvec3(v)), exact); };
    if (light.kind != LightKind::directional)
        light.position = rounded(map.scale * (map.turn * dvec3(light.position)) + map.move, exact);
    light.direction = rounded(map.turn * dvec3(light.direction), exact);
    if (light.kind == LightKind::rectangle) {
        light.edge_u = vector(light.edge_u);
        light.edge_v = vector(light.edge_v);
        // direction = cross(edge_u, edge_v) must hold on; a mirror turns the cross product round.
        if (mirror) light.direction = -light.direction;
    }
    light.radius = rounded(dvec3(map.scale * static_cast<double>(light.radius)), exact).x;
    light.range  = static_cast<float>(map.scale * static_cast<double>(light.range));
}

Changed mapped(const Question& from, const Map& map) {
    Draft d(from);
    const bool mirror = glm::determinant(map.turn) < 0;
    const auto place  = [&](vec3 p) { return map.scale * (map.turn * dvec3(p)) + map.move; };
    for (vec3& p : d.scene.positions) p = rounded(place(p), d.exact);
    for (vec3& n : d.scene.normals) n = vec3(map.turn * dvec3(n));
    for (Light& light : d.scene.lights) apply(map, light, mirror, d.exact);
    Camera& camera = d.scene.camera;
    camera.eye     = vec3(place(camera.eye));
    camera.target  = vec3(place(camera.target));
    camera.up      = vec3(map.turn * dvec3(camera.up));
    camera.height  = static_cast<float>(map.scale * static_cast<double>(camera.height));
    if (!mirror) return std::move(d).finished(from);

    // Seen from outside a mirrored triangle runs the other way: its last two corners are swapped, and with them u and
    // v. The mirrored camera's picture runs from right to left.
    for (uvec3& t : d.scene.triangles) std::swap(t[1], t[2]);
    std::swap(d.names.u, d.names.v);
    if (from.points.raster) {
        const auto width = static_cast<std::size_t>(from.points.raster->width);
        for (std::size_t i = 0; i < d.point.size(); ++i) d.point[i] = i / width * width + (width - 1 - i % width);
        Names names = d.names;
        for (std::size_t i = 0; i < d.point.size(); ++i) {
            names.triangle[d.point[i]] = d.names.triangle[i];
            names.u[d.point[i]]        = d.names.u[i];
            names.v[d.point[i]]        = d.names.v[i];
        }
        d.names = std::move(names);
    }
    return std::move(d).finished(from);
}

// ---- cutting triangles ---------------------------------------------------------------------------------------------

/// A corner of a part of a triangle: its weights over the triangle's own corners.
using Weights = dvec3;
using Part    = std::array<Weights, 3>;

/// Cuts every triangle into the parts that `parts_of` gives for it (themselves wound as it is), and renames the points.
template <class PartsOf>
Changed cut(const Question& from, const PartsOf& parts_of) {
    Draft d(from);
    const Scene& old = from.scene;
    Scene& scene     = d.scene;
    std::vector<TriangleId> first(old.triangles.size());  // of each triangle's parts
    std::vector<std::vector<Part>> parts(old.triangles.size());
    scene.triangles.clear();
    scene.triangle_object.clear();
    for (std::size_t o = 0; o < old.objects.size(); ++o) {
        const Object& object            = old.objects[o];
        scene.objects[o].first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
            first[t] = static_cast<TriangleId>(scene.triangles.size());
            parts[t] = parts_of(t);
            for (const Part& part : parts[t]) {
                uvec3 corners;
                for (int k = 0; k < 3; ++k) {
                    const Weights& w = part[static_cast<std::size_t>(k)];
                    corners[k]       = old.triangles[t][w.y == 1 ? 1 : w.z == 1 ? 2 : 0];
                    if (std::max({w.x, w.y, w.z}) == 1) continue;
                    corners[k] = static_cast<unsigned>(scene.positions.size());
                    // The corners in one order for both triangles of an edge, so that they compute the same bits.
                    scene.positions.push_back(rounded(
                        w.x * dvec3(old.vertex(t, 0)) + w.y * dvec3(old.vertex(t, 1)) + w.z * dvec3(old.vertex(t, 2)),
                        d.exact));
                    scene.normals.emplace_back(0);
                }
                scene.triangles.push_back(corners);
                scene.triangle_object.push_back(static_cast<std::uint32_t>(o));
            }
        }
        scene.objects[o].triangle_count =
            static_cast<std::uint32_t>(scene.triangles.size()) - scene.objects[o].first_triangle;
    }
    for (std::size_t i = 0; i < d.names.triangle.size(); ++i) {
        const TriangleId t = d.names.triangle[i];
        if (t == kNoTriangle) continue;
        const double u = d.names.u[i], v = d.names.v[i];
        for (std::size_t k = 0; k < parts[t].size(); ++k) {
            const Part& p       = parts[t][k];
            const dvec3 weights = glm::inverse(dmat3(p[0], p[1], p[2])) * dvec3(1 - u - v, u, v);
            if (std::min({weights.x, weights.y, weights.z}) < 0) continue;
            d.names.triangle[i] = first[t] + static_cast<TriangleId>(k);
            d.names.u[i]        = static_cast<float>(weights.y);
            d.names.v[i]        = static_cast<float>(weights.z);
            d.exact             = d.exact && p[0] * (1 - double(d.names.u[i]) - double(d.names.v[i])) +
                                         p[1] * double(d.names.u[i]) + p[2] * double(d.names.v[i]) ==
                                     dvec3(1 - u - v, u, v);
            break;
        }
    }
    return std::move(d).finished(from);
}

const Weights kA{1, 0, 0}, kB{0, 1, 0}, kC{0, 0, 1};

// ---- lights --------------------------------------------------------------------------------------------------------

bool is_local(LightKind kind) { return kind == LightKind::point || kind == LightKind::spot; }

double light_step(const Scene& scene) { return 0x1p-18 * above(largest_coordinate(scene)); }

/// Two edges of about `size` that span a rectangle facing `towards`, of few bits.
void set_rectangle(Light& light, dvec3 towards, double size, double step) {
    const dvec3 n   = glm::dot(towards, towards) > 0 ? glm::normalize(towards) : dvec3(0, -1, 0);
    const Axes axes = axes_across(n);
    light.kind      = LightKind::rectangle;
    light.edge_u    = coarse(vec3(size * axes.u), step);
    light.edge_v    = coarse(vec3(size * axes.v), step);
    light.direction = vec3(glm::normalize(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v))));
}

double distance_to_scene(const Scene& scene, vec3 p) {
    return std::max(glm::length(dvec3(p) - dvec3(bounds(scene).centre())), 0.25 * bounds(scene).diagonal());
}

}  // namespace

// ---- what all start from -------------------------------------------------------------------------------------------

Question dyadic(Scene scene, int width, int height) {
    const double size = above(largest_coordinate(scene));
    for (vec3& p : scene.positions) p = coarse(p, 0x1p-22 * size);
    for (Light& light : scene.lights) {
        light.position = coarse(light.position, light_step(scene));
        if (light.kind != LightKind::rectangle) continue;
        const double length = std::max(glm::length(light.edge_u), glm::length(light.edge_v));
        const double step   = std::min(light_step(scene), 0x1p-18 * above(length));
        light.edge_u        = coarse(light.edge_u, step);
        light.edge_v        = coarse(light.edge_v, step);
        light.direction     = vec3(glm::normalize(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v))));
    }
    Question asked{std::move(scene), {}};
    // A batch without a raster is of a picture of the scene's own size, for methods that ask what the camera sees.
    asked.scene.width  = width;
    asked.scene.height = height;
    asked.points       = primary_points(RayScene(asked.scene), asked.scene, asked.scene.camera, width, height);
    for (std::size_t i = 0; i < asked.points.size(); ++i)
        if (asked.points.triangle[i] != kNoTriangle) set_dyadic_point(asked, i);
    face_lights(asked.points, asked.scene);
    return asked;
}

Question with_point_lights(const Question& from) {
    Question asked = from;
    for (Light& light : asked.scene.lights)
        if (is_area(light.kind)) light.kind = LightKind::point;
    face_lights(asked.points, asked.scene);
    return asked;
}

Question with_rectangles(const Question& from) {
    Question asked = from;
    for (Light& light : asked.scene.lights) {
        if (!is_local(light.kind)) continue;
        const dvec3 towards = dvec3(bounds(from.scene).centre()) - dvec3(light.position);
        set_rectangle(light, towards, distance_to_scene(from.scene, light.position) / 8, light_step(from.scene));
    }
    face_lights(asked.points, asked.scene);
    return asked;
}

// ---- rigid motion, scale -------------------------------------------------------------------------------------------

Changed axes_cycled(const Question& from) {
    Map map;
    map.turn = dmat3(dvec3(0, 1, 0), dvec3(0, 0, 1), dvec3(1, 0, 0));  // columns: where x, y and z go
    return mapped(from, map);
}

Changed quarter_turn(const Question& from) {
    Map map;
    map.turn = dmat3(dvec3(0, 0, -1), dvec3(0, 1, 0), dvec3(1, 0, 0));
    return mapped(from, map);
}

Changed moved(const Question& from) {
    Map map;
    const double size = above(largest_coordinate(from.scene));
    map.move          = size * dvec3(0.75, -0.5, 0.25);
    return mapped(from, map);
}

Changed turned_and_moved(const Question& from) {
    const dvec3 axis = glm::normalize(dvec3(0.36, 0.8, -0.48));
    const double c = std::cos(0.7), s = std::sin(0.7);
    Map map;  // Rodrigues' formula
    for (int k = 0; k < 3; ++k) {
        dvec3 e(0);
        e[k]        = 1;
        map.turn[k] = c * e + s * glm::cross(axis, e) + (1 - c) * glm::dot(axis, e) * axis;
    }
    map.move = largest_coordinate(from.scene) * dvec3(0.123456789, -0.0987654321, 0.3456789);
    return mapped(from, map);
}

Changed scaled(const Question& from, double factor) {
    Map map;
    map.scale = factor;
    return mapped(from, map);
}

Changed mirrored(const Question& from) {
    Map map;
    map.turn[0][0] = -1;
    return mapped(from, map);
}

// ---- order ---------------------------------------------------------------------------------------------------------

Changed triangles_shuffled(const Question& from) {
    Draft d(from);
    std::mt19937 random(7);
    std::vector<TriangleId> now(from.scene.triangles.size());
    std::iota(now.begin(), now.end(), 0);
    for (const Object& object : from.scene.objects)
        std::shuffle(now.begin() + object.first_triangle, now.begin() + object.first_triangle + object.triangle_count,
                     random);
    for (std::size_t t = 0; t < now.size(); ++t) d.scene.triangles[now[t]] = from.scene.triangles[t];
    std::vector<unsigned> position(from.scene.positions.size());
    std::iota(position.begin(), position.end(), 0);
    std::shuffle(position.begin(), position.end(), random);
    for (std::size_t p = 0; p < position.size(); ++p) {
        d.scene.positions[position[p]] = from.scene.positions[p];
        d.scene.normals[position[p]]   = from.scene.normals[p];
    }
    for (uvec3& t : d.scene.triangles) t = {position[t.x], position[t.y], position[t.z]};
    for (TriangleId& t : d.names.triangle)
        if (t != kNoTriangle) t = now[t];
    return std::move(d).finished(from);
}

Changed objects_reversed(const Question& from) {
    Draft d(from);
    const Scene& old = from.scene;
    std::vector<TriangleId> now(old.triangles.size());
    d.scene.objects.clear();
    d.scene.triangles.clear();
    d.scene.triangle_object.clear();
    for (std::size_t o = old.objects.size(); o-- > 0;) {
        Object object = old.objects[o];
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
            now[t] = static_cast<TriangleId>(d.scene.triangles.size());
            d.scene.triangles.push_back(old.triangles[t]);
            d.scene.triangle_object.push_back(static_cast<std::uint32_t>(d.scene.objects.size()));
        }
        object.first_triangle = static_cast<std::uint32_t>(d.scene.triangles.size()) - object.triangle_count;
        d.scene.objects.push_back(object);
    }
    for (TriangleId& t : d.names.triangle)
        if (t != kNoTriangle) t = now[t];
    return std::move(d).finished(from);
}

Changed lights_reversed(const Question& from) {
    Draft d(from);
    std::reverse(d.scene.lights.begin(), d.scene.lights.end());
    std::reverse(d.lights.begin(), d.lights.end());
    return std::move(d).finished(from);
}

// ---- parts ---------------------------------------------------------------------------------------------------------

Changed triangles_split(const Question& from) {
    return cut(from, [](TriangleId t) -> std::vector<Part> {
        const std::array<Weights, 3> corner{kA, kB, kC};
        const Weights &a = corner[t / 3 % 3], &b = corner[(t / 3 + 1) % 3], &c = corner[(t / 3 + 2) % 3];
        const Weights edge = 0.5 * (a + b), within = 0.5 * a + 0.25 * (b + c);
        if (t % 3 == 0) return {{a, edge, c}, {edge, b, c}};
        if (t % 3 == 1) return {{a, b, within}, {b, c, within}, {c, a, within}};
        return {{kA, kB, kC}};
    });
}

Changed subdivided(const Question& from) {
    return cut(from, [](TriangleId) -> std::vector<Part> {
        const Weights ab = 0.5 * (kA + kB), bc = 0.5 * (kB + kC), ca = 0.5 * (kC + kA);
        return {{kA, ab, ca}, {ab, kB, bc}, {ca, bc, kC}, {bc, ca, ab}};
    });
}

Changed rectangles_split(const Question& from) {
    Draft d(from);
    d.scene.lights.clear();
    for (std::size_t j = 0; j < from.scene.lights.size(); ++j) {
        const Light& light = from.scene.lights[j];
        d.lights[j].clear();
        const bool whole = light.kind != LightKind::rectangle;
        for (int part = 0; part < (whole ? 1 : 4); ++part) {
            Light& piece = d.scene.lights.emplace_back(light);
            d.lights[j].push_back({static_cast<LightId>(d.scene.lights.size() - 1), 1});
            if (whole) continue;
            const double length = part & 1 ? 0.75 : 0.25, middle = part & 1 ? 0.125 : -0.375;
            const dvec3 u(light.edge_u), v(light.edge_v);
            piece.name += static_cast<char>('a' + part);
            piece.position = rounded(dvec3(light.position) + middle * u + (part & 2 ? 0.25 : -0.25) * v, d.exact);
            piece.edge_u   = rounded(length * u, d.exact);
            piece.edge_v   = rounded(0.5 * v, d.exact);
            d.lights[j].back().weight = static_cast<float>(0.5 * length);
        }
    }
    return std::move(d).finished(from);
}

// ---- size of lights ------------------------------------------------------------------------------------------------

Changed lights_grown(const Question& from, double share) {
    Draft d(from);
    constexpr std::array kKinds{LightKind::rectangle, LightKind::disk, LightKind::sphere};
    for (std::size_t j = 0; j < d.scene.lights.size(); ++j) {
        Light& light = d.scene.lights[j];
        if (!is_local(light.kind)) continue;
        const double size = share * distance_to_scene(from.scene, light.position);
        set_rectangle(light, dvec3(bounds(from.scene).centre()) - dvec3(light.position), size, 0x1p-18 * above(size));
        light.kind   = kKinds[j % kKinds.size()];
        light.radius = static_cast<float>(size / 2);
    }
    return std::move(d).finished(from);
}

Question asked_for_some(const Question& from, const std::vector<std::uint8_t>& keep, bool with_raster) {
    Question some = from;
    if (!with_raster) some.points.raster.reset();
    for (std::size_t i = 0; i < keep.size(); ++i)
        if (!keep[i]) some.points.triangle[i] = kNoTriangle;
    face_lights(some.points, some.scene);
    return some;
}

}  // namespace umbra
