// Light that arrives by way of a mirror: what S_j, which asks for the straight segment, cannot see, and neither can
// rays that start at the eye.
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// A plane with flat triangles that mirror: its points x have normal.x = offset. World space, `normal` unit.
struct MirrorPlane {
    dvec3 normal{0};
    double offset = 0;
    double area   = 0;  ///< of these triangles
};

/// The planes of all triangles with reflect > 0 whose corners have the face's normal, largest area first, at most
/// `most`. Triangles within a millionth of the scene's diagonal of a plane, and of a direction, are of that plane.
[[nodiscard]] std::vector<MirrorPlane> mirror_planes(const Scene& scene, std::size_t most = 16);

/// [point]: 1 where light j (of an area light the centre) reaches a point of the batch, on the side of its normal, over
/// one of the planes: the ray to the light's mirror image meets a mirror of that plane first, and from there the
/// segment to the light is free. Lights' cones and ranges count at the mirror. Parallel. Curved mirrors, and paths over
/// two mirrors, are left out.
[[nodiscard]] std::vector<std::uint8_t> lit_by_mirrors(const RayScene& rays, const Scene& scene,
                                                       const PointBatch& points, LightId light,
                                                       const std::vector<MirrorPlane>& planes);

}  // namespace umbra
