// A light as shadow rays see it, and triangles so close before a hard light that no ray reaches them.
//
// Rays end a fraction of the segment before the light, so that triangles on which the light lies, as those of its own
// shape, do not block it. Triangles in that last part of a segment that do not touch the light are tested here.
#pragma once

#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"

namespace umbra::rays {

/// The fraction of the segment to the light that rays do not trace: 256 float steps, enough for incidence down to about
/// a degree.
inline constexpr double kUntraced = 0x1p-16;

/// The end of rays before the light; NearLight has the rest.
inline constexpr float kTraced = 1 - static_cast<float>(kUntraced);

/// The light in ray space. Rays to a light whose farthest point is at distance D run in units of `unit`, a power of two
/// near D where D is far beyond the scene and 1 else, so that nothing over- or underflows.
struct Target {
    LightKind kind = LightKind::point;
    double unit    = 1;
    float per_unit = 1;         ///< 1 / unit; 0 where the scene is a point for the light
    float reach    = kTraced;   ///< tfar: where rays end, in ray space
    vec3 centre{0};             ///< in units; directional: the unit vector to the light
    vec3 axis_u{0}, axis_v{0};  ///< in units: rectangle: half edges; disk: perpendicular radii
    dvec3 sphere{0};            ///< sphere: centre and radius, not in units
    double radius = 0;
};

[[nodiscard]] Target make_target(const Light& light, const RaySpace& space);

/// The triangles in the untraced part of some segment to one hard light. Empty for other lights, and for most scenes.
/// Const members may be called from many threads.
class NearLight {
public:
    /// The scene must outlive this object.
    NearLight(const Scene& scene, const RayScene& rays, LightId light);

    [[nodiscard]] bool empty() const { return near_.empty(); }

    /// Which of them hides the light from point i; kNoTriangle where none does.
    [[nodiscard]] TriangleId blocker(const PointBatch& points, std::size_t i) const;

    [[nodiscard]] std::size_t memory_bytes() const { return near_.capacity() * sizeof(Occluder); }

private:
    /// Corners less the light's position, which is exact in double for any two floats within 2^29 of each other, and
    /// the side of the triangle's plane that the light is on, not 0.
    struct Occluder {
        TriangleId triangle = kNoTriangle;
        dvec3 a{0}, b{0}, c{0};
        int light_side = 0;
    };

    static double squared_distance(const Occluder& t);
    static bool passes_through(const Occluder& t, dvec3 p);

    const Scene* scene_;
    dvec3 light_;
    std::vector<Occluder> near_;
};

}  // namespace umbra::rays
