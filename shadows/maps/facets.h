// The triangles that surface points lie on, in double.
#pragma once

#include <algorithm>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/maps/depth_lookup.h"
#include "umbra/shadows/maps/receive_eight.h"

namespace umbra {

/// Triangle `t`, its normal on the side of its corners' order, or on the other where `flipped`.
[[nodiscard]] inline Facet facet_of(const Scene& scene, TriangleId t, bool flipped) {
    const dvec3 a(scene.vertex(t, 0));
    Facet facet{a, dvec3(scene.vertex(t, 1)) - a, dvec3(scene.vertex(t, 2)) - a, {}};
    facet.normal = glm::normalize(glm::cross(facet.ab, facet.ac)) * (flipped ? -1.0 : 1.0);
    return facet;
}

/// Calls body(i, facet, p) for the points that ask for S_j, in parallel: the point's index, its triangle, and the point
/// in double.
template <class Body>
void for_each_facet(const Scene& scene, const PointBatch& points, LightId light, const Body& body) {
    constexpr std::size_t kGrain = 4096;
    parallel_ranges(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Facet facet{};
        TriangleId triangle = kNoTriangle;
        bool flipped        = false;
        for (std::size_t i = begin; i < end; ++i) {
            if (!points.asks(light, i)) continue;
            if (points.triangle[i] != triangle || (points.flipped[i] != 0) != flipped) {
                triangle = points.triangle[i];
                flipped  = points.flipped[i] != 0;
                facet    = facet_of(scene, triangle, flipped);
            }
            body(i, facet,
                 facet.a + static_cast<double>(points.u[i]) * facet.ab + static_cast<double>(points.v[i]) * facet.ac);
        }
    });
}

/// Calls body(first, which, points) for runs of eight points, from point `begin` on, a multiple of 8, to `end`.
template <class Body>
UMBRA_FOR_EACH_PROCESSOR void for_each_eight_facets(const Scene& scene, const PointBatch& points, LightId light,
                                                    std::size_t begin, std::size_t end, const Body& body) {
    Facet facet{};
    TriangleId triangle = kNoTriangle;
    bool flipped        = false;
    for (std::size_t first = begin; first < end; first += 8) {
        FacetPoints8 at;
        unsigned which = 0;
        for (std::size_t k = 0; k < std::min<std::size_t>(8, end - first); ++k) {
            const std::size_t i = first + k;
            if (!points.asks(light, i)) continue;
            if (points.triangle[i] != triangle || (points.flipped[i] != 0) != flipped) {
                triangle = points.triangle[i];
                flipped  = points.flipped[i] != 0;
                facet    = facet_of(scene, triangle, flipped);
            }
            which |= 1u << k;
            at.set(static_cast<int>(k),
                   facet.a + static_cast<double>(points.u[i]) * facet.ab + static_cast<double>(points.v[i]) * facet.ac,
                   facet.normal);
        }
        if (which != 0) body(first, which, at);
    }
}

/// Calls body(first, which, points) for runs of eight points, in parallel: the index of lane 0, and bit k for each lane
/// that asks for S_j, whose point and normal are set.
template <class Body>
void for_each_eight_facets(const Scene& scene, const PointBatch& points, LightId light, const Body& body) {
    constexpr std::size_t kGrain = 512;
    parallel_ranges((points.size() + 7) / 8, kGrain, [&](std::size_t begin, std::size_t end) {
        for_each_eight_facets(scene, points, light, 8 * begin, std::min(8 * end, points.size()), body);
    });
}

}  // namespace umbra
