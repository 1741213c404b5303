// This work is based on:
// Gary Meisters. Polygons Have Ears. 1975
// Ivan Sutherland, Robert Sproull, Robert Schumacker. A Characterization of Ten Hidden-Surface Algorithms. 1974
// (Newell's way to the normal of a polygon)
#include "umbra/core/io/polygon.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace umbra {
namespace {

dvec3 newell_normal(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon) {
    const dvec3 origin(positions[polygon[0]]);  // sums near the polygon, not near the world's origin
    dvec3 n(0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec3 a = dvec3(positions[polygon[i]]) - origin;
        const dvec3 b = dvec3(positions[polygon[(i + 1) % polygon.size()]]) - origin;
        n += glm::cross(a, b);
    }
    return n;
}

// Whether all corners lie in one plane, up to the errors of modelling programs and printed digits: a hundredth of its
// size. A polygon that bends more has no inside of its own, so no way to cut it is more right than another.
bool is_flat(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon) {
    const dvec3 origin(positions[polygon[0]]);
    dvec3 n             = newell_normal(positions, polygon);
    const double length = glm::length(n);
    if (!(length > 0)) return true;
    n /= length;
    double size = 0, low = 0, high = 0;
    for (const std::uint32_t i : polygon) {
        const dvec3 d  = dvec3(positions[i]) - origin;
        size           = std::max(size, glm::length(d));
        const double h = glm::dot(n, d);
        low            = std::min(low, h);
        high           = std::max(high, h);
    }
    return high - low <= 1e-3 * size;
}

// The polygon seen along the axis nearest to its normal, anticlockwise.
std::vector<dvec2> flattened(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon) {
    const dvec3 n    = newell_normal(positions, polygon);
    const dvec3 size = glm::abs(n);
    const int drop   = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if (n[drop] < 0) std::swap(u, v);
    std::vector<dvec2> flat;
    flat.reserve(polygon.size());
    for (const std::uint32_t i : polygon) flat.emplace_back(positions[i][u], positions[i][v]);
    return flat;
}

double turn(dvec2 a, dvec2 b, dvec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// Whether the polygon is seen whole from its first corner: then a fan from there is right, whether or not it is convex.
bool is_fan(const std::vector<dvec2>& flat) {
    for (std::size_t i = 2; i < flat.size(); ++i)
        if (turn(flat[0], flat[i - 1], flat[i]) < 0) return false;
    return true;
}

// Cuts ears off the ring of corners that are left. A crafted polygon of many thousand corners could make the search for
// ears take for ever: past `budget` point-in-triangle tests it gives up.
bool clip_ears(const std::vector<dvec2>& flat, std::vector<std::array<std::size_t, 3>>& ears) {
    const std::size_t n = flat.size();
    std::vector<std::size_t> before(n), after(n);
    for (std::size_t i = 0; i < n; ++i) before[i] = (i + n - 1) % n, after[i] = (i + 1) % n;

    std::size_t budget = std::min<std::size_t>(64 * n * n, 50'000'000);
    const auto is_ear  = [&](std::size_t i) {
        const dvec2 a = flat[before[i]], b = flat[i], c = flat[after[i]];
        if (turn(a, b, c) <= 0) return false;
        for (std::size_t k = after[after[i]]; k != before[i]; k = after[k]) {
            if (budget > 0) --budget;
            const dvec2 p = flat[k];
            if (p == a || p == b || p == c) continue;  // a slit to a hole passes its corners twice
            if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
        }
        return true;
    };

    std::size_t left = n, i = 0, misses = 0;
    while (left > 3) {
        if (misses > 2 * left || budget == 0) return false;
        // A corner without a turn is cut off too, as a triangle without area: otherwise it would stay in the way.
        const bool straight = misses >= left && turn(flat[before[i]], flat[i], flat[after[i]]) == 0;
        if (straight || is_ear(i)) {
            ears.push_back({before[i], i, after[i]});
            after[before[i]] = after[i];
            before[after[i]] = before[i];
            --left;
            misses = 0;
            i      = before[i];
        } else {
            ++misses;
            i = after[i];
        }
    }
    ears.push_back({before[i], i, after[i]});
    return true;
}

}  // namespace

bool triangulate(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon,
                 std::vector<uvec3>& triangles) {
    bool found = true;
    if (polygon.size() > 3 && is_flat(positions, polygon)) {
        const std::vector<dvec2> flat = flattened(positions, polygon);
        if (!is_fan(flat)) {
            std::vector<std::array<std::size_t, 3>> ears;
            found = clip_ears(flat, ears);
            if (found) {
                for (const auto& [a, b, c] : ears) triangles.emplace_back(polygon[a], polygon[b], polygon[c]);
                return true;
            }
        }
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) triangles.emplace_back(polygon[0], polygon[i - 1], polygon[i]);
    return found;
}

}  // namespace umbra
