// The surfaces that a camera sees between two depths: cascades are fitted to them.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/camera.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/maps/light_frame.h"

namespace umbra {

/// A camera. Depths are along its forward axis, from its eye, or from the window of an orthographic one; >= 0.
class View {
public:
    explicit View(const CameraFrame& frame) : frame_(frame) {}

    [[nodiscard]] dvec3 eye() const { return frame_.eye; }
    [[nodiscard]] double depth(dvec3 p) const { return glm::dot(frame_.forward, p - frame_.eye); }

    /// The view's sides, and that nothing is behind the eye: p lies within where, with v = p - eye, dot((v, 1), side)
    /// is nowhere negative.
    [[nodiscard]] std::array<dvec4, 5> sides() const;

    /// Corners of the part from one depth to another, world space.
    [[nodiscard]] std::array<dvec3, 8> corners(double from, double to) const;

    struct Sphere {
        dvec3 centre;
        double radius;
    };
    /// The smallest one about all corners of that part with its centre on the view's axis. Its radius does not depend
    /// on where the camera is and looks. [Michal Valient, Stable Rendering of Cascaded Shadow Maps, 2008]
    [[nodiscard]] Sphere sphere(double from, double to) const;

private:
    [[nodiscard]] bool is_perspective() const { return frame_.projection == Projection::perspective; }
    CameraFrame frame_;
};

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
    /// One entry a slice.
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
