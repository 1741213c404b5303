#include "umbra/shadows/light_rays/starts.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "umbra/core/base/lanes.h"

namespace umbra::rays {

namespace {

/// Moves p along n by float steps, which grow with the distance from the origin as the rounding of p does, or by a
/// constant close to the origin, where they would vanish.
vec3 integer_offset(vec3 p, vec3 n) {
    constexpr float near = 1 / 32.0f, constant = 1 / 65536.0f, steps = 256;
    for (int k = 0; k < 3; ++k) {
        const auto step = static_cast<std::int32_t>(steps * n[k]);
        const auto bits = std::bit_cast<std::int32_t>(p[k]);
        p[k] = std::abs(p[k]) < near ? p[k] + constant * n[k] : std::bit_cast<float>(bits + (p[k] < 0 ? -step : step));
    }
    return p;
}

/// Float steps far from the origin can move a start farther from a small scene than Embree's numbers reach.
float within_reach(float x) {
    constexpr float farthest = 1e18f;
    return std::clamp(x, -farthest, farthest);
}

}  // namespace

Starts lane_alone(const Starts& starts, int lane) {
    Starts alone;
    for (const auto member :
         {&Starts::x, &Starts::y, &Starts::z, &Starts::nx, &Starts::ny, &Starts::nz, &Starts::height})
        (alone.*member)[0] = (starts.*member)[lane];
    alone.id[0] = starts.id[lane];
    return alone;
}

/// The point from its name, rounded in ray space only: where that is moved, its floats are finer than the world's.
vec3 StartPlaces::exact_start(const PointBatch& points, std::size_t i) const {
    const TriangleId t    = points.triangle[i];
    const RaySpace& space = space_;
    const dvec3 a(space.point(scene_->vertex(t, 0))), b(space.point(scene_->vertex(t, 1))),
        c(space.point(scene_->vertex(t, 2)));
    return vec3(a + double(points.u[i]) * (b - a) + double(points.v[i]) * (c - a));
}

UMBRA_FOR_EACH_PROCESSOR void StartPlaces::load(const PointBatch& points, std::size_t first, std::size_t count,
                                                Starts& starts) const {
    const RaySpace& space = space_;
    const auto load       = [&](const auto& from, auto& to) {
        const auto* source = from.data() + first;
        if (count == 8)  // not std::copy_n, which becomes a call
            for (std::size_t k = 0; k < 8; ++k) to[k] = source[k];
        else
            for (std::size_t k = 0; k < count; ++k) to[k] = source[k];
    };
    load(points.px, starts.x), load(points.py, starts.y), load(points.pz, starts.z);
    load(points.nx, starts.nx), load(points.ny, starts.ny), load(points.nz, starts.nz);
    load(points.triangle, starts.id);
    if (offset_ != OffsetPolicy::skip_triangle) {
        for (int k = 0; k < 8; ++k) {
            const vec3 p(starts.x[k], starts.y[k], starts.z[k]), n(starts.nx[k], starts.ny[k], starts.nz[k]);
            const vec3 q = offset_ == OffsetPolicy::epsilon ? p + lift_ * n : integer_offset(p, n);
            starts.x[k] = q.x, starts.y[k] = q.y, starts.z[k] = q.z;
            starts.id[k] = kNoTriangle;
        }
    }
    for (int k = 0; k < 8; ++k) {
        starts.x[k] = within_reach((starts.x[k] - space.centre.x) * space.scale);
        starts.y[k] = within_reach((starts.y[k] - space.centre.y) * space.scale);
        starts.z[k] = within_reach((starts.z[k] - space.centre.z) * space.scale);
    }
    if (offset_ != OffsetPolicy::skip_triangle) return;
    if (space.centre != vec3(0)) {
        for (std::size_t k = 0; k < count; ++k) {
            if (starts.id[k] == kNoTriangle) continue;
            const vec3 p = exact_start(points, first + k);
            starts.x[k] = p.x, starts.y[k] = p.y, starts.z[k] = p.z;
        }
    }
    // How far the start may lie below its plane, with u = 2^-24 and unit normal n:
    //   p's coordinates are rounded once, each by at most u |p_k|: together by sum |n_k| u |p_k| along n;
    //   a triangle in that plane (a neighbour, a duplicate) is met where Embree's (v - p).N vanishes, v a vertex, N its
    //   normal. v - p lies in the plane, so |v_k - p_k| <= E sqrt(1 - n_k^2), E <= 2 the scene's extent; the
    //   difference, N's coordinates, the products and their sums are rounded, each by a few u of that.
    // Both vanish for planes that the axes span: a floor at y = 0 needs no tolerance. It gets a billionth of the scene,
    // since a ray that starts after 0 need not visit the floor's flat box.
    constexpr float u = 0x1p-24f, least = 0x1p-30f;
    for (int k = 0; k < 8; ++k) {
        const float nx = starts.nx[k], ny = starts.ny[k], nz = starts.nz[k];
        const auto term  = [](float n) { return std::abs(n) * std::sqrt(std::max(0.0f, 1 - n * n)); };
        starts.height[k] = u * (std::abs(nx * starts.x[k]) + std::abs(ny * starts.y[k]) + std::abs(nz * starts.z[k])) +
                           (4 * u) * (term(nx) + term(ny) + term(nz)) + least;
    }
}

}  // namespace umbra::rays
