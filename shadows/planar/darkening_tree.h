// The surface points on one receiver in a tree, and the shadows of one light that darken them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/base/raw_vector.h"
#include "umbra/shadows/planar/outline.h"
#include "umbra/shadows/planar/project.h"

namespace umbra::planar {

/// Where points lie in a plane.
struct Places {
    RawVector<double> x, y;
};

/// Sorts points of a plane along its Morton curve, an order in which neighbours are near. `points` are their indices.
void sort_in_plane(RawVector<std::uint32_t>& points, Places& places);

/// Points of a plane as a tree of boxes over an order in which neighbours are near: leaves of 16 points, 8 branches a
/// node.
struct PlaneTree {
    static constexpr std::size_t kLeaf = 16, kBranches = 8;
    struct Node {
        float low_x[kBranches], low_y[kBranches], high_x[kBranches], high_y[kBranches];
    };

    /// The points come in that order.
    explicit PlaneTree(Places places);

    [[nodiscard]] dvec2 at(std::size_t i) const { return {x[i], y[i]}; }
    [[nodiscard]] std::size_t leaf_count() const { return (size + kLeaf - 1) / kLeaf; }
    /// The points under child `child` of a node of `level`.
    struct Range {
        std::size_t begin, end;
    };
    [[nodiscard]] Range points_under(std::size_t level, std::size_t child) const;
    [[nodiscard]] std::size_t memory_bytes() const;

    std::size_t size;                       ///< points
    RawVector<double> x, y;                 ///< filled up to whole leaves
    std::vector<std::vector<Node>> levels;  ///< lowest first

private:
    void set_box(Node& node, std::size_t k, std::size_t child, std::size_t children) const;
};

/// Shadows over the points of a tree. All points are bright at first. Points become dark, and stay so until all are
/// brightened; a branch whose points are all dark is not entered again. Which thread darkens a point makes no
/// difference to the result.
class DarkeningTree {
public:
    /// `points` must outlive this object.
    explicit DarkeningTree(const PlaneTree& points);

    /// `i` counts in the tree's order.
    [[nodiscard]] bool is_dark(std::size_t i) const { return dark_[i] != 0; }

    void brighten();

    /// Darkens the points within the shadow; those on its boundary are within. May run from many threads.
    void darken(const Shadow& shadow, const std::array<Side, 3>& sides);

    /// Darkens the points over which the outline counts shadows, on many threads (counted_points.cpp). Returns the
    /// points, in the tree's order, where rounding may have made that count of some shadows or of none: those are left
    /// as they are.
    [[nodiscard]] std::vector<std::uint32_t> darken(const Outline& outline);

    /// Darkens point i of the tree's order.
    void darken(std::size_t i) { dark_[i] = 1; }

private:
    static constexpr std::size_t kLeaf = PlaneTree::kLeaf, kBranches = PlaneTree::kBranches;
    using Node  = PlaneTree::Node;
    using Range = PlaneTree::Range;
    enum class Cover : std::uint8_t { none, some, all };

    class Counter;

    static Cover cover(const std::array<Side, 3>& sides, const Node& node, std::size_t k);
    bool darken(std::size_t level, std::size_t n, const Shadow& shadow, const std::array<Side, 3>& sides);
    bool darken_leaf(std::size_t leaf, const std::array<Side, 3>& sides);
    void fill(std::size_t level, std::size_t child);

    const PlaneTree& points_;
    std::vector<std::uint8_t> dark_;                        ///< of each point
    std::vector<std::vector<std::uint8_t>> dark_branches_;  ///< of each node: a bit for each branch
};

}  // namespace umbra::planar
