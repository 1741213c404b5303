// Patches: every triangle of a scene cut into equal smaller ones.
//
//      v
//      |\            A triangle with n parts a side has n^2 patches: in the cell (i, j) of its barycentric lattice the
//      |_\           lower one, with the corners (i, j), (i + 1, j), (i, j + 1), and, but for the last cell of a row,
//      |\|\          the upper one, with (i + 1, j + 1), (i, j + 1), (i + 1, j), which is the lower one turned by half
//      |_|_\ u       a revolution.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra::patches {

using PatchId = std::uint32_t;

/// A place in a patch: weights u, v of its second and third corner.
struct InPatch {
    PatchId patch = 0;
    double u = 0, v = 0;
};

class Patches {
public:
    /// Edges no longer than `longest`, world units; longer where the scene would have more than kMost patches.
    Patches(const Scene& scene, double longest);

    [[nodiscard]] std::size_t size() const { return triangle_.size(); }
    [[nodiscard]] TriangleId triangle(PatchId patch) const { return triangle_[patch]; }
    /// Its corners in the triangle's barycentric coordinates (weights of the second and third vertex).
    [[nodiscard]] std::array<dvec2, 3> corners(PatchId patch) const;
    /// The longest edge, world units.
    [[nodiscard]] double longest_edge(PatchId patch) const {
        return longest_[triangle_[patch]] / parts_[triangle_[patch]];
    }
    /// The place of a point of triangle t.
    [[nodiscard]] InPatch find(TriangleId t, double u, double v) const;
    [[nodiscard]] std::size_t memory_bytes() const;

    static constexpr std::size_t kMost = std::size_t{1} << 21;  ///< beyond one a triangle

private:
    std::vector<TriangleId> triangle_;  ///< one a patch
    std::vector<PatchId> first_;        ///< one a triangle
    std::vector<std::uint32_t> parts_;  ///< a side; one a triangle
    std::vector<double> longest_;       ///< edge; one a triangle
};

}  // namespace umbra::patches
