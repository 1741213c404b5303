// Planes: triangles of a scene that lie in one plane, whichever objects they belong to.
#pragma once

#include <optional>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// Triangles that lie in one plane, to the rounding of their float vertices and no further.
struct PlanarReceiver {
    dvec3 normal{0, 1, 0};  ///< unit; to the side that most of the area is wound to
    double offset    = 0;   ///< dot(normal, x) = offset
    double tolerance = 0;   ///< largest distance of a vertex of its triangles from the plane
    double area      = 0;
    bool exact       = false;           ///< all vertices of its triangles lie in one plane, without any rounding
    std::vector<TriangleId> triangles;  ///< sorted; wound to either side
};

/// All planes that hold at least `area_share` of the scene's area, largest first. No triangle is in two of them.
[[nodiscard]] std::vector<PlanarReceiver> find_planes(const Scene& scene, double area_share);

/// The plane that all triangles [first, first + count) lie in, if there is one.
[[nodiscard]] std::optional<PlanarReceiver> common_plane(const Scene& scene, TriangleId first, std::uint32_t count);

}  // namespace umbra
