// Small random scenes in which visibility is hard to decide: slivers, folds, contacts, cracks, lights in the planes of
// faces, on edges and in corners, extreme scales, and surface points that lie exactly on edges.
//
// A scene is a pure function of its seed, the same with every compiler and library: no distribution of the standard
// library, no sine, sums of doubles without contraction.
#pragma once

#include <string>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

struct AdversarialScene {
    Scene scene;
    PointBatch points;    ///< with their facing
    std::string pattern;  ///< what it is built of, for reports
};

enum class LightsWanted : std::uint8_t {
    hard,   ///< point, spot and directional lights
    area,   ///< rectangles, disks and spheres, of any size, most of them beside an edge as some point sees it
    round,  ///< disks and spheres in bad positions: at contacts, in planes of faces, containing points
    seams   ///< point and directional lights behind edges and corners of surfaces, exactly, on a lattice that doubles
            ///< hold
};

/// With `lights` lights and `points` surface points; fewer points where triangles have no area.
[[nodiscard]] AdversarialScene adversarial_scene(std::uint64_t seed, LightsWanted wanted, int lights, int points);

}  // namespace umbra
