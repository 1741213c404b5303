// Surface points seen from one position, sorted into a tree so that all points within a cone of half-spaces can be
// counted at once: what a stencil buffer does for pixels, for points anywhere between them. All lights use one tree,
// and each has counts of its own.
#pragma once

#include <array>
#include <bit>
#include <limits>
#include <vector>

#include "umbra/shadows/geometry/point_tree.h"

namespace umbra {

/// Where points are looked at from: an origin and an orthonormal, right-handed frame, x right, y down, z forward.
struct ViewFrame {
    dvec3 origin{0};
    dvec3 right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};

    [[nodiscard]] dvec3 turned(dvec3 v) const { return {glm::dot(right, v), glm::dot(down, v), glm::dot(forward, v)}; }
    [[nodiscard]] dvec3 seen(dvec3 p) const { return turned(p - origin); }
};

/// f(x, y, w) = (nx x + ny y) + (nz + nw w), for a point at (X, Y, Z) seen from the view: x = X/Z, y = Y/Z, w = 1/Z. So
/// (n, nw) is the plane n.(X, Y, Z) + nw = 0, and f has the sign of its side. Its unit is how far rounding may move it:
/// the point is surely within where f > 1, and surely not where f < -1.
struct HalfSpace {
    double nx = 0, ny = 0, nz = 0, nw = 0;

    /// The side of the plane where `sense` is +1, or the other where it is -1. `doubt`: how far rounding may move
    /// n.(X, Y, Z)/Z + nw/Z, of the plane and of the point together. Where that underflows nothing is sure.
    static HalfSpace side(dvec3 n, double nw, int sense, double doubt) {
        const double s = doubt > 1e-290 ? sense / doubt : 0;
        return {s * n.x, s * n.y, s * n.z, s * nw};
    }
};

/// A part of space: what lies within all its half-spaces. They may be culled by the box in (x, y, w), which must hold
/// all of the part.
struct Region {
    static constexpr int kMaxFaces = 5;
    std::array<HalfSpace, kMaxFaces> faces;
    int count = 0;
    dvec3 box_min{-std::numeric_limits<double>::infinity()};
    dvec3 box_max{+std::numeric_limits<double>::infinity()};
    /// The triangle of a near cap, whose plane is the first face, and whether the region is on the light's side of that
    /// plane. A point of that triangle is on that side.
    TriangleId cap       = kNoTriangle;
    bool on_light_s_side = false;

    void add(const HalfSpace& h) { faces[static_cast<std::size_t>(count++)] = h; }
};

/// The surface points of a batch, in a tree over (x, y, w).
class CountingTree {
public:
    /// Takes the points that have a triangle. All lie in front of the view.
    CountingTree(const Scene& scene, const PointBatch& points);

    [[nodiscard]] const ViewFrame& view() const { return view_; }
    /// w of the nearest point.
    [[nodiscard]] double largest_w() const { return index_.empty() ? 0 : tree_.levels.back()[0].bounds().high[2]; }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    friend class PointCounts;
    using Tree = PointTree<double, 3, 4>;

    RawVector<std::uint32_t> index_;  // point of the batch
    ViewFrame view_;
    Tree tree_;
    std::vector<RawVector<TriangleId>> own_;  // [level][child of a node]: of all points below, where they share one
};

/// Counts at the points of a tree that need an answer for one light: those whose facing to it is `front` or `partly`.
class PointCounts {
public:
    /// `points` are those of the tree, which must outlive this object.
    PointCounts(const CountingTree& tree, const Scene& scene, const PointBatch& points, LightId light);

    /// Whether no point needs an answer.
    [[nodiscard]] bool empty() const { return levels_.empty() || levels_.back().asks[0] == 0; }

    /// Adds `weight` to every point within the region, and marks the points of which rounding leaves that open. From
    /// any number of threads at once; sums of integers are the same in any order.
    void add(const Region& region, std::int32_t weight);

    /// Calls visit(point of the batch, sum of the weights of the regions that it lies in, whether that is sure), in
    /// parallel.
    template <class Visit>
    void for_each(const Visit& visit) const;

private:
    using Tree                         = CountingTree::Tree;
    static constexpr std::size_t kLeaf = Tree::kLeaf, kFanOut = Tree::kBranches;
    struct Level {
        std::vector<std::array<std::int32_t, kFanOut>> count;  // of each node of the tree
        RawVector<std::uint8_t> asks;  // a bit for each branch: some point below needs an answer
    };

    struct OneRegion;

    const Tree& tree_;
    const RawVector<std::uint32_t>& index_;
    const std::vector<RawVector<TriangleId>>& own_;
    const Scene& scene_;
    const PointBatch& points_;
    RawVector<std::uint16_t> asks_;  // of each leaf: a bit for each point
    RawVector<std::uint16_t> open_;  // of each leaf: a bit for each point of which rounding leaves the sum open
    RawVector<std::int32_t> count_;  // of each point; set in leaves where some point asks
    std::vector<Level> levels_;
};

template <class Visit>
void PointCounts::for_each(const Visit& visit) const {
    if (empty()) return;
    parallel_ranges(levels_[0].count.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
            std::int32_t above = 0;
            for (std::size_t level = 1, n = node; level < levels_.size(); ++level, n /= kFanOut)
                above += levels_[level].count[n / kFanOut][n % kFanOut];
            for (std::size_t leaf = node * kFanOut; leaf < std::min(asks_.size(), (node + 1) * kFanOut); ++leaf) {
                const std::int32_t all = above + levels_[0].count[node][leaf % kFanOut];
                for (unsigned asks = asks_[leaf]; asks != 0; asks &= asks - 1) {
                    const std::size_t k = leaf * kLeaf + static_cast<std::size_t>(std::countr_zero(asks));
                    visit(index_[k], count_[k] + all, (open_[leaf] >> k % kLeaf & 1u) == 0);
                }
            }
        }
    });
}

}  // namespace umbra
