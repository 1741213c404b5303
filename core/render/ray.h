// Ray intersection: Embree 3 or 4 behind one class. Only core/render/embree_api.h and the bare loops in bench/speed
// include Embree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// Where rays are traced: x' = (x - centre) * scale, so that scenes far from the origin, huge ones and tiny ones all
/// meet Embree's floats near 1. For every vertex and surface point x' is exact: `scale` is a power of two, and an axis
/// is moved only where its vertices lie within a factor of three of each other, so that their differences are floats.
struct RaySpace {
    vec3 centre{0};
    float scale = 1;

    [[nodiscard]] vec3 point(vec3 p) const { return (p - centre) * scale; }
    [[nodiscard]] vec3 point(dvec3 p) const { return vec3((p - dvec3(centre)) * static_cast<double>(scale)); }
    [[nodiscard]] vec3 vector(dvec3 d) const { return vec3(d * static_cast<double>(scale)); }
};

/// Eight shadow rays in ray space, in Embree's layout. Every member of every lane is to be set, `time` and `flags` to 0
/// and `mask` to -1; a fresh packet has them so.
struct alignas(32) ShadowPacket {
    float org_x[8]{}, org_y[8]{}, org_z[8]{}, tnear[8]{};
    float dir_x[8]{}, dir_y[8]{}, dir_z[8]{}, time[8]{};
    float tfar[8]{};  ///< negative after the call where the ray was blocked
    std::uint32_t mask[8]{~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
    TriangleId id[8]{};  ///< this triangle does not count as a hit; kNoTriangle: every triangle does
    std::uint32_t flags[8]{};
    int valid[8]{};  ///< -1: trace this lane, 0: leave it alone. Not part of Embree's layout
};

/// One shadow ray in ray space, for lists of them; the members are those of ShadowPacket.
struct alignas(16) ShadowRay {
    float org_x = 0, org_y = 0, org_z = 0, tnear = 0;
    float dir_x = 0, dir_y = 0, dir_z = 0, time = 0;
    float tfar          = 0;
    std::uint32_t mask  = ~0u;
    TriangleId id       = kNoTriangle;
    std::uint32_t flags = 0;
};

/// `mask` of rays from the eye, which pass through objects that it does not see; all others have ~0.
inline constexpr std::uint32_t kEyeRay = 1;

/// Flushes denormal floats to zero on this thread while it lives, which Embree is several times faster with. Keep it
/// around the tracing alone: exact arithmetic needs denormals.
class FlushDenormals {
public:
    FlushDenormals();
    ~FlushDenormals();
    FlushDenormals(const FlushDenormals&)            = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned saved_;
};

/// Which triangles rays may meet.
enum class Met : std::uint8_t {
    all,
    blocking  ///< Scene::blocks: for rays to a light
};

/// An Embree scene over the triangles of a Scene. Built once; all queries are const and may run from many threads at
/// once.
class RayScene {
public:
    explicit RayScene(const Scene& scene, Met met = Met::all);  ///< copies what it needs; `scene` need not outlive it
    ~RayScene();
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    RayScene(const RayScene&)            = delete;
    RayScene& operator=(const RayScene&) = delete;

    [[nodiscard]] const RaySpace& space() const { return space_; }

    /// Tests the valid lanes for any hit in (tnear, tfar]. Call under FlushDenormals.
    void occluded(ShadowPacket& rays) const;
    /// The same for a list of neighbouring rays, of a tile's points to one light, which is where lists are the faster
    /// (by a third on a million triangles); for eight rays from one point a packet is.
    void occluded(std::span<ShadowRay> rays) const;

    /// Distance from a point in ray space to the nearest triangle, or `reach` where none is that near.
    [[nodiscard]] double clearance(dvec3 point, double reach) const;

    /// The triangle that the ray meets first, kNoTriangle where it meets none but its own. Call under FlushDenormals.
    [[nodiscard]] TriangleId first_hit(ShadowRay ray) const;

    [[nodiscard]] std::size_t memory_bytes() const;

    struct Impl;
    [[nodiscard]] const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
    RaySpace space_;
};

}  // namespace umbra
