// Polygons of mesh files, cut into triangles. Internal to core.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// Appends the n - 2 triangles of a polygon (n >= 3 indices into `positions`, all in range) with its orientation: a fan
/// from its first corner where that sees it whole, or where the polygon is not flat (as most programs cut it); ears cut
/// off one by one elsewhere. Returns false where no such triangles exist, as in a polygon that crosses itself: then it
/// is a fan nevertheless.
bool triangulate(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon,
                 std::vector<uvec3>& triangles);

}  // namespace umbra
