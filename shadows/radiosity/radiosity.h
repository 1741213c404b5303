// The values of radiosity; radiosity.cpp has the recipe.
#pragma once

#include <array>
#include <vector>

#include "umbra/shadows/method.h"
#include "umbra/shadows/radiosity/elements.h"
#include "umbra/shadows/radiosity/patches.h"
#include "umbra/shadows/radiosity/sight.h"

namespace umbra {

/// The result of build: the patches of a scene, and rays between their points and lights.
struct RadiosityPatches final : Built {
    /// `size`: the longest edge, scene diagonals.
    RadiosityPatches(const Scene& of, const SceneFacts& its_facts, double size)
        : Built(of, its_facts), diagonal(bounds(of).diagonal()), sight(of), patches(of, size * diagonal) {}
    [[nodiscard]] std::size_t memory_bytes() const override { return sight.memory_bytes() + patches.memory_bytes(); }

    /// Where point i of a batch lies.
    [[nodiscard]] patches::InPatch find(const PointBatch& points, std::size_t i) const {
        return patches.find(points.triangle[i], points.u[i], points.v[i]);
    }
    /// A point of a patch, seen from one side; `flipped`: from that which its winding does not face.
    [[nodiscard]] patches::SurfacePoint place(patches::PatchId patch, bool flipped, dvec2 at) const;

    const double diagonal;  ///< of the scene
    const patches::Sight sight;
    const patches::Patches patches;
};

/// The result of aim: S_j of one light over all patches.
struct RadiosityElements final : Aimed {
    RadiosityElements(const RadiosityPatches& from, LightId at)
        : Aimed(from, at),
          surfaces(from),
          sides{ElementsOfPatches(from.patches.size()), ElementsOfPatches(from.patches.size())} {}
    [[nodiscard]] std::size_t memory_bytes() const override;

    /// The element that a point lies in, of its side.
    struct ElementId {
        patches::PatchId patch = 0;
        std::uint32_t leaf     = 0;
    };
    [[nodiscard]] ElementId element(const PointBatch& points, std::size_t i) const;

    using ElementsOfPatches = std::vector<patches::Elements>;  ///< one a patch
    const RadiosityPatches& surfaces;
    std::array<ElementsOfPatches, 2> sides;  ///< that which the winding faces, and the other
};

}  // namespace umbra
