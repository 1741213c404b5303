// Where shadow rays start, and how they keep from hitting the surface that they start on.
#pragma once

#include <cstdint>

#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"

namespace umbra::rays {

/// How a shadow ray keeps from hitting the surface that it starts on.
enum class OffsetPolicy : std::uint8_t {
    skip_triangle,   ///< starts at the point; hits neither its own triangle, by id, nor others within rounding
    integer_offset,  ///< moves the start along the normal by a few float steps
                     ///< [Carsten Waechter, Nikolaus Binder, A Fast and Robust Method for Avoiding Self-Intersection,
                     ///< 2019]
    epsilon          ///< starts at a constant distance (a fraction of the scene's diagonal) along the normal
};

/// Where the rays of up to eight points start, in ray space.
struct Starts {
    float x[8]{}, y[8]{}, z[8]{};
    float nx[8]{}, ny[8]{}, nz[8]{};
    float height[8]{};  ///< above the point's plane, at which the ray begins to hit triangles
    TriangleId id[8]{};
};

/// Lane `lane` as lane 0; the other lanes are zero.
[[nodiscard]] Starts lane_alone(const Starts& starts, int lane);

/// Finds where rays start. Const members may be called from many threads.
class StartPlaces {
public:
    /// `lift`: world units along the normal, used by OffsetPolicy::epsilon alone. The scene must outlive this object.
    StartPlaces(const Scene& scene, const RaySpace& space, OffsetPolicy offset, float lift)
        : scene_(&scene), space_(space), offset_(offset), lift_(lift) {}

    /// For the points first .. first + count - 1, at most eight. Lanes from `count` on stay as they were.
    void load(const PointBatch& points, std::size_t first, std::size_t count, Starts& starts) const;

private:
    [[nodiscard]] vec3 exact_start(const PointBatch& points, std::size_t i) const;

    const Scene* scene_;
    RaySpace space_;
    OffsetPolicy offset_;
    float lift_;
};

}  // namespace umbra::rays
