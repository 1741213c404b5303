// Ray intersection: Embree 3 or 4 behind one class. The only file pair that includes Embree.
#pragma once

#include <cstddef>
#include <memory>

#include "core/points.h"
#include "core/scene.h"

namespace umbra {

/// How a shadow ray keeps from hitting the surface that it starts on.
enum class OffsetPolicy : std::uint8_t {
    skip_triangle,   ///< starts at the point; its own triangle, by id, is no hit, nor is what lies within the point's
                     ///< rounding
    integer_offset,  ///< moves the start along the normal by a few float steps
                     ///< [Carsten Waechter, Nikolaus Binder, A Fast and Robust Method for Avoiding Self-Intersection,
                     ///< 2019]
    epsilon          ///< starts at a constant distance (a share of the scene's diagonal) along the normal
};

/// An Embree scene over all triangles of a Scene. Built once; all queries are const and may run from many threads at
/// once.
class RayScene {
public:
    explicit RayScene(const Scene& scene);  ///< copies what it needs; `scene` need not outlive it
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    RayScene(const RayScene&)            = delete;
    RayScene& operator=(const RayScene&) = delete;

    [[nodiscard]] std::size_t memory_bytes() const;

    struct Impl;
    [[nodiscard]] const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// The G-buffer: the surface point that each pixel centre sees, in parallel, packets of 8.
/// face_lights is called on the result. Deterministic for any number of threads.
[[nodiscard]] PointBatch primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width,
                                        int height);

}  // namespace umbra
