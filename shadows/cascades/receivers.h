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

/// Extents of x, y and z in the light space of a frame.
using LightExtents = std::array<MinMax, 3>;

/// A range of depths along the camera, closed.
struct DepthSlice {
    double from, to;
};

/// Surfaces that a camera may see. Both answers are the same for any number of threads and any order of triangles.
class Receivers {
public:
    virtual ~Receivers() = default;
    /// From the least to the greatest depth; empty where there is nothing.
    [[nodiscard]] virtual MinMax depths() const = 0;
    /// One entry a slice, of what lies in it.
    [[nodiscard]] virtual std::vector<LightExtents> extents(std::span<const DepthSlice> slices,
                                                            const LightFrame& light) const = 0;
};

/// All triangles of the scene, seen or hidden, cut to the view's sides and to `planes`: with v = p - eye, p counts
/// where dot((v, 1), plane) is nowhere negative. `scene` must outlive it. At most 4 planes.
[[nodiscard]] std::unique_ptr<Receivers> receivers_in_view(const Scene& scene, const View& view,
                                                           std::span<const dvec4> planes);

/// The points of the batch that ask for S_j of the light and lie within `planes`, as above. Which of them ask is
/// decided here where the batch has no `facing`. The scene and the batch must outlive it.
[[nodiscard]] std::unique_ptr<Receivers> receivers_of(const Scene& scene, const PointBatch& points, LightId light,
                                                      const View& view, std::span<const dvec4> planes);

}  // namespace umbra
