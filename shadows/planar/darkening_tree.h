// The surface points on one receiver, in a tree in which shadows darken them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/base/raw_vector.h"
#include "umbra/shadows/planar/outline.h"
#include "umbra/shadows/planar/project.h"

namespace umbra::planar {

/// Points of a plane as a tree of boxes over an order in which neighbours are near: leaves of 16 points, 8 branches a
/// node. All are bright at first. Points become dark, and stay so until all are brightened; a branch whose points are
/// all dark is not entered again. Which thread darkens a point makes no difference to the result.
class DarkeningTree {
public:
    /// `points` are indices into the batch, (x, y) their coordinates in the plane. `in_order`: they come in such an
    /// order; else they are sorted along the Morton curve of the plane.
    DarkeningTree(RawVector<std::uint32_t> points, RawVector<double> x, RawVector<double> y, bool in_order);

    /// The points as given, in the tree's order.
    [[nodiscard]] std::span<const std::uint32_t> points() const { return points_; }
    /// `i` counts in the tree's order.
    [[nodiscard]] bool is_dark(std::size_t i) const { return dark_[i] != 0; }

    void brighten();

    /// Coordinates of point i of the tree's order.
    [[nodiscard]] dvec2 place(std::size_t i) const { return {x_[i], y_[i]}; }

    /// Darkens the points within the shadow; those on its boundary are within. May run from many threads.
    void darken(const Shadow& shadow, const std::array<Side, 3>& sides);

    /// Darkens the points over which the outline counts shadows, on many threads (counted_points.cpp). Returns the
    /// points, in the tree's order, where rounding may have made that count of some shadows or of none: those are left
    /// as they are.
    [[nodiscard]] std::vector<std::uint32_t> darken(const Outline& outline);

    /// Darkens point i of the tree's order.
    void darken(std::size_t i) { dark_[i] = 1; }

private:
    static constexpr std::size_t kLeaf = 16, kBranches = 8;
    struct Node {
        float low_x[kBranches], low_y[kBranches], high_x[kBranches], high_y[kBranches];
        std::uint8_t dark = 0;  ///< a bit for each branch
    };
    enum class Cover : std::uint8_t { none, some, all };

    class Counter;
    struct Range {
        std::size_t begin, end;
    };

    [[nodiscard]] std::size_t leaf_count() const { return (points_.size() + kLeaf - 1) / kLeaf; }
    void sort();
    void build_boxes();
    void set_box(Node& node, std::size_t k, std::size_t child, std::size_t children) const;
    static Cover cover(const std::array<Side, 3>& sides, const Node& node, std::size_t k);
    bool darken(std::size_t level, std::size_t n, const Shadow& shadow, const std::array<Side, 3>& sides);
    bool darken_leaf(std::size_t leaf, const std::array<Side, 3>& sides);
    /// The points under child `child` of a node of `level`.
    [[nodiscard]] Range points_under(std::size_t level, std::size_t child) const;
    void fill(std::size_t level, std::size_t child);

    RawVector<std::uint32_t> points_;
    RawVector<double> x_, y_;  ///< filled up to whole leaves
    std::vector<std::uint8_t> dark_;
    std::vector<std::vector<Node>> levels_;  ///< lowest first
};

}  // namespace umbra::planar
