// A hard light's image: where points and triangles are as the light sees them. A directional light has one plane, a
// position six faces of a cube around it, which lie beside one another in one plane.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "umbra/core/base/lanes.h"
#include "umbra/core/scene/scene.h"

namespace umbra::bins {

/// A rectangle of the image. `depth`: the least of a triangle in it, the largest of points.
struct Extent {
    float low_u = 0, high_u = 0, low_v = 0, high_v = 0;
    float depth = 0;
    Extent()    = default;
    Extent(dvec2 low, dvec2 high, double at)
        : low_u(static_cast<float>(low.x)),
          high_u(static_cast<float>(high.x)),
          low_v(static_cast<float>(low.y)),
          high_v(static_cast<float>(high.y)),
          depth(static_cast<float>(at)) {}

    /// For triangles: the extent that adds nothing.
    [[nodiscard]] static Extent nothing() {
        constexpr float far = std::numeric_limits<float>::max();
        Extent e;
        e.low_u = e.low_v = e.depth = far, e.high_u = e.high_v = -far;
        return e;
    }
    /// For triangles: becomes the extent around both.
    void add(const Extent& e) {
        low_u = std::min(low_u, e.low_u), high_u = std::max(high_u, e.high_u);
        low_v = std::min(low_v, e.low_v), high_v = std::max(high_v, e.high_v);
        depth = std::min(depth, e.depth);
    }
    [[nodiscard]] bool empty() const { return low_u > high_u; }
    [[nodiscard]] float perimeter() const { return high_u - low_u + (high_v - low_v); }  ///< half of it
};

/// Eight extents; one that is empty meets nothing.
struct alignas(32) Extents {
    static constexpr float kFar = std::numeric_limits<float>::max();
    float low_u[kLanes], high_u[kLanes], low_v[kLanes], high_v[kLanes], depth[kLanes];

    void clear(std::size_t lane) {
        low_u[lane] = low_v[lane] = kFar, high_u[lane] = high_v[lane] = -kFar;
        depth[lane] = 0;
    }
    void set(std::size_t lane, const Extent& e) {
        low_u[lane] = e.low_u, high_u[lane] = e.high_u, low_v[lane] = e.low_v, high_v[lane] = e.high_v;
        depth[lane] = e.depth;
    }
    [[nodiscard]] bool empty(std::size_t lane) const { return low_u[lane] > high_u[lane]; }
    [[nodiscard]] Extent at(std::size_t lane) const {
        Extent e;
        e.low_u = low_u[lane], e.high_u = high_u[lane], e.low_v = low_v[lane], e.high_v = high_v[lane];
        e.depth = depth[lane];
        return e;
    }
};

class LightImage {
public:
    /// `centre`: near the scene, so that a directional light's image is centred. `reach`: the largest magnitude of the
    /// coordinates of all points and corners.
    LightImage(const Light& light, dvec3 centre, double reach);

    [[nodiscard]] int faces() const { return infinite_ ? 1 : 6; }

    /// Corners of eight triangles, [corner][axis][lane].
    using Corners = double[3][3][kLanes];

    /// Eight points of triangles. Places have errors far below the margins of extents.
    struct Places {
        double x[kLanes], y[kLanes], z[kLanes];  ///< position, world space
        double slack[3][kLanes];                 ///< how far each coordinate may be off: the corners may be far away
        float u[kLanes], v[kLanes];              ///< those of the faces do not overlap
        float depth[kLanes];        ///< along the light's direction, or along the axis of the face: larger is farther
        std::int32_t face[kLanes];  ///< -1: no place, for it could be anywhere: the point lies next to the light
    };
    /// The points that have weights `u` and `v` of their triangles' second and third corners.
    void places(const Corners& corners, const float (&u)[kLanes], const float (&v)[kLanes], Places& to) const;

    /// Around the part of a position's face that the triangle covers, and a little more; nothing where it surely covers
    /// none.
    [[nodiscard]] std::optional<Extent> extent(int face, const std::array<dvec3, 3>& corners) const;

    /// The extents of the triangles that lie in one face, so far from its border that they cover no part of another,
    /// and one bit for each of these; the other extents are empty.
    [[nodiscard]] unsigned extents(const Corners& corners, Extents& to) const;

    /// Which of eight triangles are wound counterclockwise as the light sees them, and which clockwise: one bit each,
    /// neither where rounding hides it.
    struct Windings {
        unsigned towards = 0, away = 0;
    };
    [[nodiscard]] Windings windings(const Corners& corners) const;

    /// Vectors along which light travels to the corners, of any length.
    void travel(const Corners& corners, Corners& to) const;

private:
    [[nodiscard]] unsigned infinite_extents(const Corners& corners, Extents& to) const;
    [[nodiscard]] unsigned cube_extents(const Corners& corners, Extents& to) const;

    bool infinite_;
    double reach_;
    dvec3 origin_;                 ///< the light's position, or `centre`
    std::array<dvec3, 3> axes_{};  ///< of a directional light: right, up, the direction of travel
};

}  // namespace umbra::bins
