// Hard shadows without a tree: not the scene is sampled as the light sees it, but the surface points that are asked are
// binned there, and every triangle is tested against the points in the bins that it covers. No bias, no resolution.
// Each test is a sign; where floats cannot tell it, the exact predicates do.
//
// This work is based on:
// Timo Aila, Samuli Laine. Alias-Free Shadow Maps. 2004
// Gregory Johnson, Juhyun Lee, Christopher Burns, William Mark. The Irregular Z-Buffer. 2005
// Chris Wyman, Rama Hoetzlein, Aaron Lefohn. Frustum-Traced Raster Shadows: Revisiting Irregular Z-Buffers. 2015
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/scene.h"

namespace umbra {
namespace bins {
class ShadowPlanes;
}

/// Its time grows with the triangles and with the points, and not with their product, but for points next to the light.
/// Nothing is kept between calls.
class BinnedShadows {
public:
    /// The scene must outlive this object. Triangles block as Scene::blocks says.
    explicit BinnedShadows(const Scene& scene);

    /// S_j of a directional, point or spot light, 0 or 1, and the answer `on_boundary` where a segment crosses no
    /// triangle and those that it touches hide some of the lights nearby (exact_visibility::Contacts). Writes where the
    /// points ask the light. Exact. From any number of threads.
    void visibility(const PointBatch& points, LightId light, Visibility out) const;

    /// The triangle of the lowest number that a point's segment crosses; where there is none, that of those that it
    /// touches and that block together; kNoTriangle where the point is lit.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const;

    [[nodiscard]] std::size_t memory_bytes() const {
        return casts_.size() + order_.size() * sizeof(TriangleId) + eights_.size() * sizeof(Eight);
    }

private:
    using Touch = std::pair<std::uint32_t, TriangleId>;  ///< a point's number, and a triangle that its segment touches
    struct Picture;
    struct Group;
    struct Search;
    struct Eight {
        float corner[3][3][8]{};  ///< [corner][axis][lane], so that they are read in one go
    };
    enum class Which : std::uint8_t { all, facing_light, later };

    [[nodiscard]] Picture bin(const PointBatch& points, LightId light) const;
    template <class Crossed>
    void each_next_to_light(Picture& picture, const PointBatch& points, const Crossed& crossed) const;
    template <class Asks, class Met>
    void each_touched(Picture& picture, const PointBatch& points, const Asks& asks, const Met& met) const;
    template <class Crossed>
    void cast_all(Picture& picture, const PointBatch& points, const Crossed& crossed, bool once = true) const;
    [[nodiscard]] Group group(std::size_t g, const Picture& picture) const;
    template <class Crossed>
    void cast_groups(std::span<const Group> groups, Picture& picture, const PointBatch& points, const Crossed& crossed,
                     bool once, Search& search) const;
    void find(const Group& group, const Picture& picture, Search& search) const;
    [[nodiscard]] bins::ShadowPlanes planes(const Group& group, const Picture& picture) const;
    template <class Crossed>
    void test(const Group& group, Picture& picture, const PointBatch& points, const Crossed& crossed, bool once,
              const Search& search) const;

    const Scene& scene_;
    dvec3 centre_{0};
    double reach_ = 0;                 ///< the largest magnitude of the coordinates of all corners
    std::vector<std::uint8_t> casts_;  ///< one a triangle: it blocks light
    std::vector<TriangleId> order_;    ///< those that do, each next to those before and after it
    std::vector<Eight> eights_;        ///< their corners
};

}  // namespace umbra
