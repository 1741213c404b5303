// The answers of a light's views for all points of a batch, each on its triangle in double: S_j, and the blockers.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/maps/depth_lookup.h"
#include "umbra/shadows/maps/light_views.h"
#include "umbra/shadows/maps/receive_eight.h"
#include "umbra/shadows/reason.h"

namespace umbra {

/// The triangles of one point after the other: neighbours are mostly on one.
struct FacetOfPoint {
    const Scene& scene;
    const PointBatch& points;
    Facet facet{};
    TriangleId triangle = kNoTriangle;
    bool flipped        = false;

    /// The point in double; `facet` is its triangle.
    dvec3 go_to(std::size_t i) {
        if (points.triangle[i] != triangle || (points.flipped[i] != 0) != flipped) {
            triangle = points.triangle[i];
            flipped  = points.flipped[i] != 0;
            const dvec3 a(scene.vertex(triangle, 0));
            facet        = {a, dvec3(scene.vertex(triangle, 1)) - a, dvec3(scene.vertex(triangle, 2)) - a, {}};
            facet.normal = glm::normalize(glm::cross(facet.ab, facet.ac)) * (flipped ? -1.0 : 1.0);
        }
        return facet.a + static_cast<double>(points.u[i]) * facet.ab + static_cast<double>(points.v[i]) * facet.ac;
    }
};

/// Calls body(i, facet, p) for the points that ask for S_j, in parallel: the point's index, its triangle, and the point
/// in double.
template <class Body>
void for_each_facet(const Scene& scene, const PointBatch& points, LightId light, const Body& body) {
    constexpr std::size_t kGrain = 4096;
    parallel_ranges(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        FacetOfPoint of{scene, points};
        for (std::size_t i = begin; i < end; ++i) {
            if (!points.asks(light, i)) continue;
            const dvec3 p = of.go_to(i);
            body(i, of.facet, p);
        }
    });
}

/// Calls body(first, which, points) for runs of eight points, from point `begin` on, a multiple of 8, to `end`.
template <class Body>
UMBRA_FOR_EACH_PROCESSOR void for_each_eight_facets(const Scene& scene, const PointBatch& points, LightId light,
                                                    std::size_t begin, std::size_t end, const Body& body) {
    FacetOfPoint of{scene, points};
    for (std::size_t first = begin; first < end; first += 8) {
        FacetPoints8 at;
        unsigned which = 0;
        for (std::size_t k = 0; k < std::min<std::size_t>(8, end - first); ++k) {
            if (!points.asks(light, first + k)) continue;
            const dvec3 p = of.go_to(first + k);
            which |= 1u << k;
            at.set(static_cast<int>(k), p, of.facet.normal);
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

/// Writes S_j of every point that asks for it, in parallel: 0 where the light's centre is behind the point's plane;
/// s[k] set by share(v, receivers, at, s) for the covered lanes k where view v is the first that covers the point; and
/// where none does 1, or `undefined` where no view looks. Lane k is the point at.point(k), in world space.
template <class Share>
void look_up(const LightViews& views, const PointBatch& points, const Bias& bias, const Filter& filter, Visibility out,
             const Share& share) {
    const std::span<const MapView> all = views.views();
    const Scene& scene                 = views.scene();
    const LightId light                = views.light;
    for_each_eight_facets(scene, points, light, [&](std::size_t first, unsigned which, const FacetPoints8& at) {
        for (int k = 0; k < 8; ++k) {
            const std::size_t i = first + static_cast<std::size_t>(k);
            if ((which >> k & 1) == 0 || !centre_is_behind(scene, points, light, i)) continue;
            out.s[i] = 0;
            which &= ~(1u << k);
        }
        for (std::size_t v = 0; v < all.size() && which != 0; ++v) {
            const Receivers8 receivers = receive_eight(all[v], at, which, bias, filter);
            if (receivers.covered == 0) continue;
            float s[8];
            share(v, receivers, at, s);
            for (int k = 0; k < 8; ++k)
                if ((receivers.covered >> k & 1) != 0) out.s[first + static_cast<std::size_t>(k)] = s[k];
            which &= ~receivers.covered;
        }
        for (std::size_t i = first; which != 0; ++i, which >>= 1) {
            if ((which & 1) == 0) continue;
            out.s[i] = 1;
            if (!views.cover_all()) out.answer[i] = Answer::undefined;
        }
    });
}

/// A share for look_up that asks one(v, receiver, p) point by point.
template <class One>
auto point_by_point(const One& one) {
    return [one](std::size_t v, const Receivers8& receivers, const FacetPoints8& at, float(&s)[8]) {
        for (int k = 0; k < 8; ++k)
            if ((receivers.covered >> k & 1) != 0) s[k] = one(v, receivers.lane(k), at.point(k));
    };
}

/// The result of `look` for methods that use the camera's picture.
class SeenPicture final : public Looked {
public:
    /// `traced`: the points of a picture are asked for, which are traced where the batch has no raster.
    SeenPicture(const Scene& scene, const PointBatch& at, bool traced);

    /// The picture that the points are seen in: their raster's, or without one that of the scene's camera, in the
    /// scene's size, so that answers do not depend on which points are asked together.
    const CameraFrame camera;

    /// The picture's points; none where they were not traced, or the eye is too far away for rays. Traced points have
    /// no `facing`: a light may move before it is asked for.
    [[nodiscard]] const PointBatch* shown() const;

    [[nodiscard]] std::size_t memory_bytes() const override;

private:
    std::optional<PointBatch> traced_;
};

/// The texel that the point lies in, or the nearest one of the map.
[[nodiscard]] ivec2 texel_of(const Receiver& receiver, const MapView& view);

/// Adds to a reason the outline of the texel that the point lies in, its stored depth and the depth that it is compared
/// with, both along the view's axis, from the light or its window; of a point beside the map, that it lies there. The
/// margin becomes the difference of the depths, where it has the answer's sign: with a filter other texels may have
/// decided.
void add_texel(Reason& reason, const FoundReceiver& found, const MapView& view, Given given);

/// For each point of a batch the sample of one of several maps that blocks it, and then the triangle that it shows.
class BlockingSamples {
public:
    explicit BlockingSamples(std::size_t points) : samples_(points) {}

    /// Looks for the sample of map k that blocks point i, the nearest of several, and says whether there is one.
    /// Different points may be looked for in several threads at once.
    bool find(std::size_t i, std::size_t k, const MapView& view, const Receiver& receiver, BiasMode mode,
              const Filter& filter);

    /// Of samples of map k, which ascend: the triangle that each shows (LightViews::owners).
    using Owners = std::function<std::vector<TriangleId>(std::size_t k, std::span<const std::size_t> samples)>;
    /// Writes one triangle a point, kNoTriangle where no sample was found. Maps in which none was are not asked.
    void name(std::span<TriangleId> blockers, const Owners& owners) const;

private:
    static constexpr std::size_t kNone = ~std::size_t{0};
    struct Sample {
        std::size_t map = kNone;
        std::size_t at  = 0;  ///< row by row
    };
    std::vector<Sample> samples_;
};

}  // namespace umbra
