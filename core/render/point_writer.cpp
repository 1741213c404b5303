#include "umbra/core/render/point_writer.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/lanes.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/seen_side.h"

namespace umbra {
namespace {

constexpr Facing kOpen{0xff};  // face_open_points looks for it

using Doubles = LaneArray<double>;

void spread(double x, Doubles& to) {
#pragma GCC unroll 1
    for (int k = 0; k < 8; ++k) to[k] = x;
}

}  // namespace

struct PointWriter::Points8 {
    float u[8], v[8], px[8], py[8], pz[8], nx[8], ny[8], nz[8];
    Doubles flipped, done;  ///< 1 or 0
    std::uint8_t flags[8];  ///< `flipped`
};

/// Triangles (a, a + b, a + c) of eight hits, and values that follow from them alone.
struct PointWriter::Triangles8 {
    Doubles a[3], b[3], c[3];
    Doubles n[3], length;  ///< cross(b, c) and its length
    Doubles sides, reach;  ///< for keeps_sign; `reach` of a
    Doubles two_sided;     ///< 1 or 0
};

namespace {

/// Heights of a light over the planes of eight triangles, times the lengths of their normals.
struct Heights8 {
    Doubles middle, rise;  ///< of the centre; of the lowest and highest part below and over it
    double reach;          ///< the sum of the magnitudes that they were computed from, except for the triangles
};

template <class Triangles8>
void heights_of(const Light& light, const Triangles8& t, Heights8& h) {
    const bool parallel = light.kind == LightKind::directional;
    const double pull   = parallel ? 0 : 1;
    const dvec3 at      = parallel ? -dvec3(light.direction) : dvec3(light.position);
    h.reach             = sum_of_magnitudes(at);
#pragma GCC unroll 1
    for (int k = 0; k < 8; ++k)
        h.middle[k] = t.n[0][k] * (at.x - pull * t.a[0][k]) + t.n[1][k] * (at.y - pull * t.a[1][k]) +
                      t.n[2][k] * (at.z - pull * t.a[2][k]);
    if (light.kind == LightKind::rectangle) {
        const dvec3 u = 0.5 * dvec3(light.edge_u), v = 0.5 * dvec3(light.edge_v);
        h.reach += sum_of_magnitudes(u) + sum_of_magnitudes(v);
#pragma GCC unroll 1
        for (int k = 0; k < 8; ++k)
            h.rise[k] = std::abs(t.n[0][k] * u.x + t.n[1][k] * u.y + t.n[2][k] * u.z) +
                        std::abs(t.n[0][k] * v.x + t.n[1][k] * v.y + t.n[2][k] * v.z);
    } else if (light.kind == LightKind::disk) {
        const dvec3 d = static_cast<double>(light.radius) * glm::normalize(dvec3(light.direction));
        h.reach += 3 * static_cast<double>(light.radius);
#pragma GCC unroll 1
        for (int k = 0; k < 8; ++k) {
            const double x = t.n[1][k] * d.z - t.n[2][k] * d.y, y = t.n[2][k] * d.x - t.n[0][k] * d.z,
                         z = t.n[0][k] * d.y - t.n[1][k] * d.x;
            h.rise[k]      = std::sqrt(x * x + y * y + z * z);
        }
    } else if (light.kind == LightKind::sphere) {
        const double radius = light.radius;
        h.reach += radius;
#pragma GCC unroll 1
        for (int k = 0; k < 8; ++k) h.rise[k] = radius * t.length[k];
    } else {
        spread(0, h.rise);
    }
}

/// Which part of the light eight points see, as face_lights has it, or kOpen. `known` is 0 where that is not asked.
template <class Triangles8>
void face_eight(const Light& light, const Triangles8& t, const Doubles& flipped, const Doubles& known, int (&to)[8]) {
    Heights8 h;
    heights_of(light, t, h);
#pragma GCC unroll 1
    for (int k = 0; k < 8; ++k) {
        const double turn = 1 - 2 * flipped[k], reach = h.reach + t.reach[k];
        const double low = turn * h.middle[k] - h.rise[k], high = turn * h.middle[k] + h.rise[k];
        const double lesser = std::min(std::abs(low), std::abs(high));
        const double facing = 1.0 + (high > 0 ? 1.0 : 0.0) + (low > 0 ? 1.0 : 0.0);
        const double sure   = keeps_sign(lesser, t.sides[k], reach) ? known[k] : 0.0;
        // A point in a plane that cuts a sphere may lie in the sphere.
        const double open = light.kind == LightKind::sphere && facing == 2.0 ? 1.0 : 0.0;
        to[k]             = static_cast<int>(sure > open ? facing : static_cast<double>(kOpen));
    }
}

}  // namespace

PointWriter::PointWriter(const Scene& scene, PointBatch& batch) : scene_(scene), batch_(batch) {
    window_ = batch.raster->projection == Projection::orthographic;
    for (const Material& m : scene.materials) all_two_sided_ &= m.two_sided;
    for (const Object& object : scene.objects) all_receive_ &= object.switches.receives_shadows;
    batch.facing.resize(scene.lights.size());
    for (std::vector<Facing>& plane : batch.facing) plane.resize(batch.size());
}

void PointWriter::claim(const PointTile& tile) const {
    tile.load_for_writing(batch_.triangle, batch_.u, batch_.v, batch_.px, batch_.py, batch_.pz, batch_.nx, batch_.ny,
                          batch_.nz, batch_.flipped);
    for (const std::vector<Facing>& plane : batch_.facing) tile.load_for_writing(plane);
}

void PointWriter::load_corners(const TriangleId* triangles, int count, Triangles8& to) const {
    for (int k = 0; k < count; ++k) {
        const TriangleId t = triangles[k];
        if (t == kNoTriangle) {
            for (int d = 0; d < 3; ++d) to.a[d][k] = to.b[d][k] = to.c[d][k] = 0;
            to.two_sided[k] = 1;
            continue;
        }
        const uvec3& corner = scene_.triangles[t];
        const vec3 &p = scene_.positions[corner.x], &q = scene_.positions[corner.y],
                   &r = scene_.positions[corner.z];  // references: copies would pass through the stack
        for (int d = 0; d < 3; ++d) {
            to.a[d][k] = static_cast<double>(p[d]);
            to.b[d][k] = static_cast<double>(q[d]), to.c[d][k] = static_cast<double>(r[d]);
        }
        const auto both = [&] { return scene_.material(t).two_sided; };
        to.two_sided[k] = all_two_sided_ || both() ? 1 : 0;
    }
}

void PointWriter::load(const TriangleId (&triangles)[8], Triangles8& to) const {
    // Neighbouring pixels mostly see the same triangle.
    const bool same = std::all_of(triangles, triangles + 8, [&](TriangleId t) { return t == triangles[0]; });
    load_corners(triangles, same ? 1 : 8, to);
    if (same) {
        for (auto* corner : {&to.a, &to.b, &to.c})
            for (Doubles& lanes : *corner) spread(lanes[0], lanes);
        spread(to.two_sided[0], to.two_sided);
    }
#pragma GCC unroll 1
    for (int k = 0; k < 8; ++k) {
        const double ax = to.a[0][k], ay = to.a[1][k], az = to.a[2][k];
        const double bx = to.b[0][k] - ax, by = to.b[1][k] - ay, bz = to.b[2][k] - az;
        const double cx = to.c[0][k] - ax, cy = to.c[1][k] - ay, cz = to.c[2][k] - az;
        const double nx = by * cz - cy * bz, ny = bz * cx - cz * bx, nz = bx * cy - cx * by;
        to.b[0][k] = bx, to.b[1][k] = by, to.b[2][k] = bz;
        to.c[0][k] = cx, to.c[1][k] = cy, to.c[2][k] = cz;
        to.n[0][k] = nx, to.n[1][k] = ny, to.n[2][k] = nz;
        to.length[k] = std::sqrt(nx * nx + ny * ny + nz * nz);
        to.sides[k]  = sum_of_magnitudes(bx, by, bz) * sum_of_magnitudes(cx, cy, cz);
        to.reach[k]  = sum_of_magnitudes(ax, ay, az);
    }
}

/// The eye, or against an orthographic view.
dvec3 PointWriter::to_eye() const { return window_ ? -batch_.raster->forward : dvec3(batch_.eye); }

/// False where no ray met anything; the triangles then mean nothing.
bool PointWriter::place(const Hits8& hits, Triangles8& t, Points8& out) const {
    if (std::all_of(hits.triangle, hits.triangle + 8, [](TriangleId id) { return id == kNoTriangle; })) {
        for (float* plane : {out.u, out.v, out.px, out.py, out.pz, out.nx, out.ny, out.nz}) std::fill_n(plane, 8, 0.0f);
        std::fill_n(out.flags, 8, std::uint8_t{0});
        return false;
    }
    load(hits.triangle, t);
    const double pull      = window_ ? 0 : 1;  // to the eye: eye - p, or against an orthographic view
    const dvec3 eye        = to_eye();
    const double eye_reach = sum_of_magnitudes(eye);
    double towards[8];
    for (int k = 0; k < 8; ++k) {
        const double ax = t.a[0][k], ay = t.a[1][k], az = t.a[2][k], bx = t.b[0][k], by = t.b[1][k], bz = t.b[2][k],
                     cx = t.c[0][k], cy = t.c[1][k], cz = t.c[2][k], nx = t.n[0][k], ny = t.n[1][k], nz = t.n[2][k];
        // The ray o + t d meets a + u b + v c. [Tomas Moeller, Ben Trumbore, 1997]
        const double dx = hits.along[0][k], dy = hits.along[1][k], dz = hits.along[2][k];
        const double sx = hits.origin[0][k] - ax, sy = hits.origin[1][k] - ay, sz = hits.origin[2][k] - az;
        const double mx = sy * dz - dy * sz, my = sz * dx - dz * sx, mz = sx * dy - dx * sy;
        const double over = -1 / (nx * dx + ny * dy + nz * dz);
        out.u[k]          = static_cast<float>((mx * cx + my * cy + mz * cz) * over);
        out.v[k]          = static_cast<float>((mx * bx + my * by + mz * bz) * -over);
        const double u = static_cast<double>(out.u[k]), v = static_cast<double>(out.v[k]);
        const double px = ax + u * bx + v * cx, py = ay + u * by + v * cy, pz = az + u * bz + v * cz;
        const double ex = eye.x - pull * px, ey = eye.y - pull * py, ez = eye.z - pull * pz;
        towards[k]          = (nx * ex + ny * ey + nz * ez) * t.two_sided[k];
        const double factor = (towards[k] < 0 ? -1.0 : 1.0) / t.length[k];
        out.px[k] = static_cast<float>(px), out.py[k] = static_cast<float>(py), out.pz[k] = static_cast<float>(pz);
        out.nx[k] = static_cast<float>(nx * factor);
        out.ny[k] = static_cast<float>(ny * factor);
        out.nz[k] = static_cast<float>(nz * factor);
    }
#pragma GCC unroll 1
    for (int k = 0; k < 8; ++k) {
        const double u = static_cast<double>(out.u[k]), v = static_cast<double>(out.v[k]), least = std::min(u, v);
        const double sure   = keeps_sign(towards[k], t.sides[k], eye_reach + t.reach[k]) ? 1.0 : 1.0 - t.two_sided[k];
        const double shaped = keeps_direction(t.length[k], t.sides[k]) ? sure : 0.0;
        const double inside = least >= 0 ? shaped : 0.0;
        out.done[k]         = u + v < 1 ? inside : 0.0;
        out.flipped[k]      = towards[k] < 0 ? 1.0 : 0.0;
    }
    for (int k = 0; k < 8; ++k) out.flags[k] = static_cast<std::uint8_t>(out.flipped[k]);
    if (std::none_of(hits.triangle, hits.triangle + 8, [](TriangleId id) { return id == kNoTriangle; })) return true;
    for (int k = 0; k < 8; ++k) {
        if (hits.triangle[k] != kNoTriangle) continue;
        out.u[k] = out.v[k] = out.px[k] = out.py[k] = out.pz[k] = out.nx[k] = out.ny[k] = out.nz[k] = 0;
        out.flags[k]                                                                                = 0;
    }
    return true;
}

template <class Count>
void PointWriter::store(const Hits8& hits, const Points8& points, int lane, std::size_t i, Count count) const {
    std::copy_n(hits.triangle + lane, count, batch_.triangle.data() + i);
    std::copy_n(points.u + lane, count, batch_.u.data() + i);
    std::copy_n(points.v + lane, count, batch_.v.data() + i);
    std::copy_n(points.px + lane, count, batch_.px.data() + i);
    std::copy_n(points.py + lane, count, batch_.py.data() + i);
    std::copy_n(points.pz + lane, count, batch_.pz.data() + i);
    std::copy_n(points.nx + lane, count, batch_.nx.data() + i);
    std::copy_n(points.ny + lane, count, batch_.ny.data() + i);
    std::copy_n(points.nz + lane, count, batch_.nz.data() + i);
    std::copy_n(points.flags + lane, count, batch_.flipped.data() + i);
}

/// Writes the values of a pixel without a surface point.
void PointWriter::clear(std::size_t i) const {
    for (std::vector<float>* plane :
         {&batch_.u, &batch_.v, &batch_.px, &batch_.py, &batch_.pz, &batch_.nx, &batch_.ny, &batch_.nz})
        (*plane)[i] = 0;
    batch_.flipped[i] = 0;
}

UMBRA_FOR_EACH_PROCESSOR bool PointWriter::write(const Hits8& hits, int x, int y) const {
    const CameraFrame& frame = *batch_.raster;
    const int count          = std::min(4, frame.width - x);
    const std::size_t first  = static_cast<std::size_t>(y) * frame.width + x;
    Triangles8 triangles;
    Points8 points;
    const bool nothing      = !place(hits, triangles, points);
    const auto for_each_row = [&](const auto& body) {
        for (int row = 0; row < std::min(2, frame.height - y); ++row)
            body(4 * row, first + static_cast<std::size_t>(row) * frame.width);
    };
    for_each_row([&](int lane, std::size_t i) {
        if (count == 4)
            store(hits, points, lane, i, std::integral_constant<int, 4>{});  // no calls for 16 bytes
        else
            store(hits, points, lane, i, count);
        for (int k = lane; k < lane + count; ++k)
            if (hits.triangle[k] != kNoTriangle && points.done[k] == 0) {
                const bool known       = std::isfinite(points.u[k]) && std::isfinite(points.v[k]);
                const std::size_t here = i + (k & 3);
                clear(here);
                set_point(batch_, here, scene_, hits.triangle[k], known ? points.u[k] : hits.u[k],
                          known ? points.v[k] : hits.v[k]);
            }
    });
    bool all_known = true;
    for (LightId j = 0; j < scene_.lights.size(); ++j) {
        int facing[8]{};
        if (!nothing) face_eight(scene_.lights[j], triangles, points.flipped, points.done, facing);
        for (int k = 0; k < 8 && !all_receive_; ++k)
            if (hits.triangle[k] != kNoTriangle && !scene_.switches(hits.triangle[k]).receives_shadows)
                facing[k] = static_cast<int>(kOpen);
        for_each_row([&](int lane, std::size_t i) {
            Facing* to = batch_.facing[j].data() + i;
            for (int k = 0; k < count; ++k) {
                to[k] = hits.triangle[lane + k] == kNoTriangle ? Facing::none : static_cast<Facing>(facing[lane + k]);
                all_known &= to[k] != kOpen;
            }
        });
    }
    return all_known;
}

UMBRA_FOR_EACH_PROCESSOR void PointWriter::face_open_points(const PointTile& tile) const {
    for (LightId j = 0; j < scene_.lights.size(); ++j) {
        std::vector<Facing>& facing = batch_.facing[j];
        std::size_t last            = batch_.size();  // neighbours often lie on one triangle
        Facing of_last              = Facing::none;
        tile.for_each_run([&](std::size_t first, std::size_t count) {
            for (std::size_t i = first; i < first + count; ++i) {
                if (facing[i] != kOpen) continue;
                const TriangleId t = batch_.triangle[i];
                if (t == kNoTriangle) {  // set_point found no area
                    facing[i] = Facing::none;
                    continue;
                }
                const bool same = last < i && batch_.triangle[last] == t && batch_.flipped[last] == batch_.flipped[i];
                if (!same) of_last = facing_of(scene_, j, t, batch_.flipped[i] != 0);
                facing[i] = facing_at(scene_, batch_, j, i, of_last);
                last      = i;
            }
        });
    }
}

}  // namespace umbra
