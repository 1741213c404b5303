// Rays to an area light that need not be traced: triangles that all rays from a tile of points to the light meet, or
// none can meet.
//
// A shaft is the convex hull of a box around some points and a box around the light. If no triangle that the rays can
// meet reaches into it, all of its points see all of the light; if one triangle covers it from side to side, none of
// them sees any. Else rays decide. Shafts are widened by far more than the rounding of rays, so that the rays would
// have said the same.
//
// This work is based on:
// Eric Haines, John Wallace. Shaft Culling for Efficient Ray-Cast Radiosity. 1994
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "umbra/core/render/ray.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/light_rays/light_rays.h"
#include "umbra/shadows/light_rays/shaft_tree.h"
#include "umbra/shadows/light_rays/starts.h"
#include "umbra/shadows/light_rays/target.h"

namespace umbra::rays {

/// The answer of all rays of a run of points (PointTile::for_each_run) without tracing them.
enum class Known : std::uint8_t {
    nothing,  ///< rays have to tell
    lit,      ///< none is blocked
    umbra     ///< all are blocked
};

inline constexpr std::size_t kRunsPerTile = PointTile::kPoints / 8;
using TileStarts                          = std::array<Starts, kRunsPerTile>;
using TileKnown                           = std::array<Known, kRunsPerTile>;

/// Shafts to one light. Const members may be called from many threads.
class LightShafts {
public:
    /// `scene` and `tree`, made of it, must outlive this object. For lights without an area, and those a million times
    /// as far away as the scene is wide, nothing is known: a ray that meets nothing takes less time than a shaft.
    LightShafts(const Scene& scene, const RaySpace& space, const ShaftTree& tree, const Target& target);

    /// The answers of the runs of a tile, in their order. Rays start at `starts`, each on its own triangle, which it
    /// does not meet (OffsetPolicy::skip_triangle). Only runs whose points that ask lie in one plane and have all of
    /// the light well above it are decided.
    [[nodiscard]] TileKnown known(const PointBatch& points, LightId light, const PointTile& tile,
                                  const TileStarts& starts) const;

private:
    struct Run;
    struct Few;
    class Shaft;

    [[nodiscard]] std::array<dvec3, 3> corners(TriangleId t) const;
    [[nodiscard]] bool in_one_plane(TriangleId t, TriangleId with) const;
    [[nodiscard]] Run look_at(const PointBatch& points, LightId light, std::size_t first, std::size_t count,
                              const Starts& starts) const;
    [[nodiscard]] Run joined(const Run& a, const Run& b) const;
    [[nodiscard]] std::optional<Shaft> shaft(const Run& run) const;
    [[nodiscard]] Known resolve(const Run& run, const Few* among, Few& few) const;

    const Scene* scene_;
    RaySpace space_;
    const ShaftTree* tree_;
    bool usable_ = false;     ///< false: nothing is known
    dmat3 axes_{1};           ///< of boxes, columns in ray space: those of the light, so that it fills its own
    dvec3 low_{0}, high_{0};  ///< box around the light, along these axes
};

/// Writes S_j of the points of a tile whose runs `shafts` know (nullptr: none), and calls rest(first, count, starts) for
/// all other runs in which a point asks.
template <class Rest>
void see_known(const LightShafts* shafts, const StartPlaces& places, const PointBatch& points, LightId light,
               const PointTile& tile, std::span<float> s, const Rest& rest) {
    TileStarts starts;
    std::array<bool, kRunsPerTile> asks{};
    std::size_t run = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        asks[run] = any_asks(points.facing[light].data() + first, count);
        if (asks[run]) places.load(points, first, count, starts[run]);
        ++run;
    });
    if (std::ranges::none_of(asks, std::identity{})) return;
    TileKnown known{};
    if (shafts != nullptr) {
        const FlushDenormals flush;
        known = shafts->known(points, light, tile, starts);
    }
    run = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        const std::size_t k = run++;
        if (known[k] == Known::nothing) {
            if (asks[k]) rest(first, count, starts[k]);
            return;
        }
        for (std::size_t i = first; i < first + count; ++i)
            if (points.asks(light, i)) s[i] = known[k] == Known::lit ? 1.0f : 0.0f;
    });
}

}  // namespace umbra::rays
