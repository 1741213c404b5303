// What a surface point sees of a light, by mathematics that shares nothing with shadows/: the tests compare `exact`
// with it. Every number that decides is a rational.
//
// Hard lights: the point in which the segment to the light meets the plane of each triangle, and whether it lies in the
// triangle. Where it lies on edges and corners alone, the light is moved in every way that differs, and the point in
// which the segment then meets each plane is followed by its derivative. Area lights: every triangle, clipped to what
// lies between the surface point and the light's plane, is projected onto that plane; the area of the union of these
// polygons is hidden.
//
// No sweep, no silhouettes, no tree and no filter: slow, and as simple as can be.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra::oracle {

/// A surface point by its exact name, and the side of its triangle that sees.
struct SurfacePoint {
    TriangleId triangle = kNoTriangle;
    float u = 0, v = 0;
    bool flipped = false;  ///< the side against the winding sees
};

enum class Verdict : std::uint8_t { lit, umbra, on_boundary };

/// The fraction of an area light that a point sees.
struct Fraction {
    bool undefined = false;  ///< the point lies in the plane of a flat light, or on or in a sphere light: no fraction
    bool touched   = false;  ///< a triangle in front touches the point: the fraction jumps there
    double visible = 0;
};

class Oracle {
public:
    /// `scene` must outlive this object.
    explicit Oracle(const Scene& scene);
    ~Oracle();

    /// Whether the side against the winding sees, for a camera at `eye`; nothing where `eye` lies in the plane.
    [[nodiscard]] std::optional<bool> flipped(TriangleId triangle, vec3 eye) const;
    [[nodiscard]] Facing facing(const SurfacePoint& point, const Light& light) const;

    /// Of a light without an area that is in front of the point. `on_boundary` where lights beside it disagree, and
    /// where they agree on `lit` though a triangle is seen edge-on or meets the point. `touched`: no triangle is
    /// crossed, and an edge, a corner or an edge-on triangle is met.
    [[nodiscard]] Verdict verdict(const SurfacePoint& point, const Light& light, bool* touched = nullptr) const;
    /// Of an area light. Rounded where the polygons' areas are summed up: off by less than 1e-12.
    [[nodiscard]] Fraction fraction(const SurfacePoint& point, const Light& light) const;

private:
    struct Model;
    std::unique_ptr<Model> model_;
};

/// Area of the unit disk that lies within a polygon, whose corners follow one another; negative where they run
/// clockwise.
[[nodiscard]] double area_in_unit_disk(const std::vector<dvec2>& polygon);

}  // namespace umbra::oracle
