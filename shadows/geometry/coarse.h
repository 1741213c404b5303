// Coarser occluders: fewer triangles, about as far from the surface as the cells that their vertices are joined in are
// wide.
//
// This work is based on:
// Jarek Rossignac, Paul Borrel. Multi-Resolution 3D Approximations for Rendering Complex Scenes. 1993
#pragma once

#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// The triangles of a scene with the vertices of each object joined that lie in one cell of a grid, `cell` wide, world
/// units, above 0. Each has its number in the scene, and no area (one vertex three times) where two of its corners were
/// joined, or where another triangle now has the same three. A cell's vertices become the one of them that is most of a
/// corner (the mean direction of its edges is longest), so that flat parts shrink before their borders move.
[[nodiscard]] std::vector<uvec3> coarse_triangles(const Scene& scene, double cell);

}  // namespace umbra
