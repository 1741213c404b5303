// The triangles that block light, as a shaft looks for them: eight at a time, in boxes of eight.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/geometry/point_tree.h"

namespace umbra::rays {

/// Eight triangles in ray space, side by side; those that are too few repeat the last one.
struct EightTriangles {
    float x[3][8], y[3][8], z[3][8];
    TriangleId id[8];
};

/// Eight boxes along the axes of ray space, side by side; those that are too few repeat the last one.
using EightBoxes = BoxLanes<float, 3, 8>;

/// Planes around a convex region of ray space. Boxes above one of them by more than rounding are outside, others may
/// be.
class ShaftPlanes {
public:
    /// `normal` is of length 1 and points outside; `offset` is its product with the points of the plane.
    void add(dvec3 normal, double offset);

    /// Bit k: box k may reach into the region.
    [[nodiscard]] unsigned may_meet(const EightBoxes& boxes) const;
    /// Bit k: triangle k may.
    [[nodiscard]] unsigned may_meet(const EightTriangles& triangles) const;

private:
    static constexpr std::size_t kMost = 16;

    std::array<float, kMost> nx_{}, ny_{}, nz_{}, beyond_{};
    std::size_t count_ = 0;
};

/// Const members may be called from many threads.
class ShaftTree {
public:
    /// Without triangles where none blocks light.
    ShaftTree(const Scene& scene, const RaySpace& space);

    /// Calls visit(eight, which) for all triangles that may reach into the region, bit k of `which` for triangle k of
    /// the eight, until it returns false.
    template <class Visit>
    void visit(const ShaftPlanes& planes, const Visit& visit) const {
        if (levels_.empty()) return;
        struct Some {
            std::uint32_t level, node;
            unsigned which;  ///< of the node's eight
        };
        Some stack[kLevels];
        std::size_t depth = 0;
        const auto enter  = [&](std::uint32_t level, std::uint32_t node) {
            const unsigned which = planes.may_meet(levels_[level][node]) & present(level, node);
            if (which != 0) stack[depth++] = {level, node, which};
        };
        enter(static_cast<std::uint32_t>(levels_.size() - 1), 0);
        while (depth > 0) {
            Some& top                 = stack[depth - 1];
            const std::uint32_t level = top.level, child = 8 * top.node + std::countr_zero(top.which);
            top.which &= top.which - 1;
            if (top.which == 0) --depth;
            if (level > 0) {
                enter(level - 1, child);
                continue;
            }
            const EightTriangles& eight = leaves_[child];
            const unsigned met          = planes.may_meet(eight) & first(count_ - 8 * std::size_t{child});
            if (met != 0 && !visit(eight, met)) return;
        }
    }

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    static constexpr std::size_t kLevels = 16;

    /// Bit k: there is a child k. Only the last node of a level lacks some.
    [[nodiscard]] unsigned present(std::uint32_t level, std::uint32_t node) const {
        return first((level > 0 ? levels_[level - 1].size() : leaves_.size()) - 8 * std::size_t{node});
    }
    [[nodiscard]] static unsigned first(std::size_t some) { return some >= 8 ? 0xffu : (1u << some) - 1; }

    std::vector<EightTriangles> leaves_;
    std::size_t count_ = 0;                        ///< of triangles
    std::vector<std::vector<EightBoxes>> levels_;  ///< from the leaves' boxes up; the last one has one node
};

}  // namespace umbra::rays
