#include "umbra/core/render/points.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/heights.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/seen_side.h"

namespace umbra {

void PointBatch::resize(std::size_t n) {
    triangle.resize(n, kNoTriangle);
    for (std::vector<float>* f : {&u, &v, &px, &py, &pz, &nx, &ny, &nz}) f->resize(n, 0.0f);
    flipped.resize(n, 0);
    for (std::vector<Facing>& plane : facing) plane.resize(n, Facing::none);
    if (!numbers.empty()) numbers.resize(n);
}

namespace {

/// Exact; of an eye in the triangle's plane, false.
bool sees_the_back(const PointBatch& batch, const Scene& scene, TriangleId t, bool window) {
    const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
    return (window ? side_of_direction(a, b, c, -batch.raster->forward) : side_of_plane(a, b, c, batch.eye)) < 0;
}

}  // namespace

void set_point(PointBatch& batch, std::size_t i, const Scene& scene, TriangleId t, float u, float v) {
    // u + v <= 1 must hold exactly. 1 - u is exact in double for any float u >= 2^-29, and rounds to at most 1 below
    // it; the largest float not above it is then the largest v allowed.
    u                 = std::clamp(u, 0.0f, 1.0f);
    const double room = 1.0 - static_cast<double>(u);
    v                 = std::clamp(v, 0.0f, 1.0f);
    if (static_cast<double>(v) > room) {
        v = static_cast<float>(room);
        if (static_cast<double>(v) > room) v = std::nextafter(v, 0.0f);
    }
    const double u2 = u, v2 = v;
    if (u2 + v2 > 1 || (u2 > 0 && u2 < 0x1p-29 && v == 1)) v = std::nextafter(v, 0.0f);  // tiny u beside v = 1

    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    dvec3 normal       = glm::cross(b - a, c - a);
    double length      = glm::length(normal);
    const double sides = sum_of_magnitudes(b - a) * sum_of_magnitudes(c - a);
    const bool thin    = !keeps_direction(length, sides);
    if (thin) {
        normal = unit_normal(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
        length = 1;
    }
    if (normal == dvec3(0)) {
        batch.triangle[i] = kNoTriangle;
        return;
    }
    const dvec3 p       = a + u2 * (b - a) + static_cast<double>(v) * (c - a);
    const auto material = scene.objects[scene.triangle_object[t]].material;
    bool flip           = false;
    if (scene.materials[material].two_sided) {
        const bool window    = batch.raster && batch.raster->projection == Projection::orthographic;
        const dvec3 to_eye   = window ? -batch.raster->forward : dvec3(batch.eye) - p;
        const double towards = glm::dot(normal, to_eye);
        const double reach   = sum_of_magnitudes(window ? to_eye : dvec3(batch.eye)) + sum_of_magnitudes(a);
        flip = !thin && keeps_sign(towards, sides, reach) ? towards < 0 : sees_the_back(batch, scene, t, window);
    }
    const vec3 n(normal * ((flip ? -1 : 1) / length));

    batch.triangle[i] = t;
    batch.u[i]        = u;
    batch.v[i]        = v;
    batch.px[i]       = static_cast<float>(p.x);
    batch.py[i]       = static_cast<float>(p.y);
    batch.pz[i]       = static_cast<float>(p.z);
    batch.nx[i]       = n.x;
    batch.ny[i]       = n.y;
    batch.nz[i]       = n.z;
    batch.flipped[i]  = flip;
}

dvec3 exact_position(const Scene& scene, const PointBatch& points, std::size_t i) {
    const TriangleId t = points.triangle[i];
    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    return a + static_cast<double>(points.u[i]) * (b - a) + static_cast<double>(points.v[i]) * (c - a);
}

PointBatch pick(const PointBatch& from, std::span<const std::uint32_t> which) {
    PointBatch to;
    to.eye = from.eye;
    to.facing.resize(from.facing.size());
    to.resize(which.size());
    const auto copy = [&](const auto& source, auto& target) {
        for (std::size_t k = 0; k < which.size(); ++k) target[k] = source[which[k]];
    };
    copy(from.triangle, to.triangle), copy(from.flipped, to.flipped);
    copy(from.u, to.u), copy(from.v, to.v);
    copy(from.px, to.px), copy(from.py, to.py), copy(from.pz, to.pz);
    copy(from.nx, to.nx), copy(from.ny, to.ny), copy(from.nz, to.nz);
    for (std::size_t j = 0; j < from.facing.size(); ++j) copy(from.facing[j], to.facing[j]);
    to.numbers.reserve(which.size());
    for (const std::uint32_t i : which) to.numbers.push_back(from.number(i));
    return to;
}

void face_light(PointBatch& batch, const Scene& scene, LightId id) {
    batch.facing.resize(scene.lights.size());
    std::vector<Facing>& facing = batch.facing[id];
    facing.resize(batch.size());
    parallel_ranges(batch.size(), 4096, [&](std::size_t begin, std::size_t end) {
        TriangleId last        = kNoTriangle;  // neighbouring points often lie on the same triangle
        std::uint8_t last_flip = 0;
        Facing last_facing     = Facing::none;
        for (std::size_t i = begin; i < end; ++i) {
            const TriangleId t = batch.triangle[i];
            if (t == kNoTriangle) {
                facing[i] = Facing::none;
                continue;
            }
            if (t != last || batch.flipped[i] != last_flip) {
                last        = t;
                last_flip   = batch.flipped[i];
                last_facing = facing_of(scene, id, t, last_flip != 0);
            }
            facing[i] = facing_at(scene, batch, id, i, last_facing);
        }
    });
}

void face_lights(PointBatch& batch, const Scene& scene) {
    batch.facing.resize(scene.lights.size());
    for (LightId j = 0; j < scene.lights.size(); ++j) face_light(batch, scene, j);
}

}  // namespace umbra
