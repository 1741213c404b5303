// Spheres, boxes, cylinders, cones and tori among the meshes of a scene: bodies that rays may meet by a formula instead
// of by triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

inline constexpr std::uint32_t kNoBody = 0xffffffffu;

enum class BodyKind : std::uint8_t { sphere, box, cylinder, cone, torus };

/// One body. World space. Cylinder, cone and torus turn around the third axis; the cone's tip is at its end.
struct Body {
    BodyKind kind        = BodyKind::sphere;
    bool inside_out      = false;        ///< triangles are seen from within: their winding faces the centre
    std::uint32_t object = 0;            ///< which has its triangles
    TriangleId holder    = kNoTriangle;  ///< the first of these: for what is the same on all, as the material is
    dvec3 centre{0};
    double radius = 0;   ///< of a sphere, a cylinder, a cone's base, and the circle that a torus goes around
    dmat3 axes{1};       ///< of all but spheres: columns are unit and perpendicular
    dvec3 half_size{0};  ///< the same, along the axes; of a torus the third is the radius of its tube
};

struct Bodies {
    std::vector<Body> list;              ///< in order of `holder`
    std::vector<std::uint32_t> of_mesh;  ///< one a triangle: index of the body that it is a part of, or kNoBody

    [[nodiscard]] std::size_t count(BodyKind kind) const;
    [[nodiscard]] std::size_t triangles() const;  ///< that are a part of some body
};

/// The connected components of the objects' meshes that stand for a body.
/// Triangles are connected where they share vertices, and, where that gives no such body, where positions are equal.
///
/// All kinds: closed, and wound one way. Sphere: at least 20 triangles, none of them near the centre; vertices at one
/// distance from the centre and vertex normals radial, within the rounding of float. Box: 12 triangles, corners of a
/// box in any orientation, and vertex normals absent or those of the faces. Cylinder, cone and torus: at least 20
/// triangles, regular around their axis (of the vertices' principal axes the one whose moment no other has), vertices on
/// the surface or amid a cap, and vertex normals its own.
///
/// Time n log n in triangles. Parallel; the same result for any number of threads.
[[nodiscard]] Bodies find_bodies(const Scene& scene);

}  // namespace umbra
