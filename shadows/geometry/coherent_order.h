// Triangles in an order in which those that follow one another are next to one another, so that eight of them are
// looked up together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// The triangles t of the scene with `casts[t]` not 0, each once: as they are numbered where triangles of near numbers
/// are near in space as they are in most meshes that a program made, otherwise along Morton's curve through the box of
/// all.
[[nodiscard]] std::vector<TriangleId> coherent_order(const Scene& scene, std::span<const std::uint8_t> casts);

}  // namespace umbra
