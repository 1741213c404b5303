// What of a scene the camera may see: at which depths, and where that lies in light space. Cascades are fitted to it.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/cascades/view.h"
#include "umbra/shadows/maps/light_frame.h"

namespace umbra {

/// Extents in the light space of one frame: x and y in each roll about the light's direction, and the depth last.
using LightExtents = std::array<Extent, 2 * kRolls + 1>;

/// Light space about one frame, in all rolls.
class LightSpace {
public:
    explicit LightSpace(const LightFrame& frame) : frame_(frame), rolls_(rolls_of(frame)) {}

    /// The values of a point that LightExtents has the extents of.
    [[nodiscard]] std::array<double, 2 * kRolls + 1> values(dvec3 p) const {
        const dvec3 v = frame_.light_space(p);
        std::array<double, 2 * kRolls + 1> all;
        for (int i = 0; i < kRolls; ++i) {
            all[2 * i]     = rolls_[i].x * v.x + rolls_[i].y * v.y;
            all[2 * i + 1] = rolls_[i].x * v.y - rolls_[i].y * v.x;
        }
        all[2 * kRolls] = v.z;
        return all;
    }
    void add(LightExtents& to, dvec3 p) const {
        const auto all = values(p);
        for (std::size_t k = 0; k < all.size(); ++k) to[k].add(all[k]);
    }
    [[nodiscard]] LightFrame frame(int roll) const { return rolled(frame_, rolls_[roll]); }

private:
    LightFrame frame_;
    Rolls rolls_;
};

/// A range of depths along the camera, closed.
struct DepthSlice {
    double from, to;
};

/// Surfaces that a camera may see. Both answers are the same for any number of threads and any order of triangles.
class Receivers {
public:
    virtual ~Receivers() = default;
    /// From the least to the greatest depth; empty where there is nothing.
    [[nodiscard]] virtual Extent depths() const = 0;
    /// One entry a slice, of what lies in it.
    [[nodiscard]] virtual std::vector<LightExtents> extents(std::span<const DepthSlice> slices,
                                                            const LightSpace& light) const = 0;
};

/// All triangles of the scene, seen or hidden, cut to the view's sides and to `planes`: with v = p - eye, p counts
/// where dot((v, 1), plane) is nowhere negative. `scene` must outlive it. At most 4 planes.
[[nodiscard]] std::unique_ptr<Receivers> receivers_in_view(const Scene& scene, const View& view,
                                                           std::span<const dvec4> planes);

/// The points of the batch that ask for S_j of the light and lie within `planes`, as above.
[[nodiscard]] std::unique_ptr<Receivers> receivers_of(const Scene& scene, const PointBatch& points, LightId light,
                                                      const View& view, std::span<const dvec4> planes);

}  // namespace umbra
