// The surface points on one receiver in a tree, and the shadows of one light that darken them.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "umbra/shadows/geometry/point_tree.h"
#include "umbra/shadows/planar/outline.h"
#include "umbra/shadows/planar/project.h"

namespace umbra::planar {

/// The points on one receiver, in its coordinates.
using PlaneTree = PointTree<float, 2, 8>;

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

    /// Darkens the points within the shadow. Those at its sides, as near as rounding, are left as they are: doubtful.
    /// May run from many threads.
    void darken(const Shadow& shadow, const std::array<ShadowSide, 3>& sides);

    /// Darkens the points over which the outline counts shadows, on many threads (counted_points.cpp). Those where
    /// rounding may have made that count of some shadows or of none are left as they are: doubtful.
    void darken(const Outline& outline);

    /// The doubtful points that are not dark since they were brightened, in the tree's order.
    [[nodiscard]] std::vector<std::uint32_t> doubtful() const;

    /// Darkens point i of the tree's order.
    void darken(std::size_t i) { dark_[i] = 1; }

private:
    static constexpr std::size_t kLeaf = PlaneTree::kLeaf, kBranches = PlaneTree::kBranches;

    struct OneShadow;
    struct Counter;

    void fill(std::size_t level, std::size_t child);
    void add_doubtful(PlaneTree::Range which);

    const PlaneTree& points_;
    std::vector<std::uint8_t> dark_;                        ///< of each point
    std::vector<std::vector<std::uint8_t>> dark_branches_;  ///< of each node: a bit for each branch
    std::vector<std::uint32_t> doubtful_;
    std::mutex mutex_;  ///< of `doubtful_`
};

}  // namespace umbra::planar
