// The light that comes back along a tree of rays: I = sum + k_r I_r + k_t I_t, intensities after all intersections.
//
// This work is based on:
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
#pragma once

#include <span>
#include <vector>

#include "umbra/bench/studies/light/ray_tree.h"
#include "umbra/core/image/image.h"
#include "umbra/core/render/ask_visibility.h"

namespace umbra {

/// What leaves each point of a tree towards its ray by itself, without what mirrors and glass bring.
struct TreeLight {
    std::vector<std::vector<dvec3>> local;  ///< [level][point]: the sum without fog, times RayLevel::own; the
                                            ///< background where a ray left
    std::uint64_t undefined = 0;            ///< answers among RayCounts::shadow that the method left undefined: lit
    double shadow_ms        = 0;            ///< S_j of all levels, where it was asked here
    double sum_ms           = 0;
};

/// `visibility`: [level][light], S_j at the points of each level. V is against the ray, also with a constant V for the
/// eye. Parallel. Throws std::logic_error where `visibility` is of another number of points, lights or levels.
[[nodiscard]] TreeLight light_of_rays(const Scene& scene, const RayTree& tree,
                                      std::span<const std::vector<VisibilityPlane>> visibility);
/// The same, with `ask` called once a level, with all its points. Throws what it throws.
[[nodiscard]] TreeLight light_of_rays(const Scene& scene, const RayTree& tree, const AskVisibility& ask);

/// R G B, scene-linear, of the raster: every level's light times its factors, and times the colour of what it passes
/// through, is added to the level before, up to `depth` levels (>= 1). With depth 1, or without mirrors and glass, it
/// is the picture of `shade` to the same bits.
/// Fog lies between eye and surface as in `shade`, and between two surfaces by their distance.
[[nodiscard]] Image gather(const Scene& scene, const RayTree& tree, const TreeLight& light, int depth);

}  // namespace umbra
