// Rays between a point of a patch and points of a light or of another patch.
#pragma once

#include <span>

#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"

namespace umbra::patches {

/// A point of a surface, world space; rays from it do not meet its own triangle.
struct SurfacePoint {
    dvec3 position{0}, normal{0, 1, 0};  ///< unit; the side from which it looks
    TriangleId triangle = kNoTriangle;
};

/// Const members may be called from any number of threads.
class Sight {
public:
    explicit Sight(const Scene& scene) : rays_(scene, Met::blocking) {}

    /// Which of at most eight targets are seen: bit k for the k-th. `to`: from the point to each target, or, with
    /// `infinite`, the direction of a target at infinity. Targets that are not in front of the point are not seen. A
    /// ray ends where it has run `reach` of its way.
    [[nodiscard]] unsigned seen(const SurfacePoint& from, std::span<const dvec3> to, bool infinite, float reach) const;

    /// The first triangle on the way, kNoTriangle where there is none.
    [[nodiscard]] TriangleId first_hit(const SurfacePoint& from, dvec3 to, bool infinite, float reach) const;

    [[nodiscard]] std::size_t memory_bytes() const { return rays_.memory_bytes(); }

private:
    RayScene rays_;
};

/// S_j by irradiance: the fraction of a light's irradiance that arrives at a point, of `samples` points of an area
/// light; 0 where none of them is in front of it.
[[nodiscard]] float light_share(const Sight& sight, const SurfacePoint& from, const Light& light, int samples);

/// A triangle that hides the light, or one of these points of it, from the point; kNoTriangle where none does.
[[nodiscard]] TriangleId light_blocker(const Sight& sight, const SurfacePoint& from, const Light& light, int samples);

}  // namespace umbra::patches
