// Surface points seen from one position, sorted into a tree so that all points within a cone of half-spaces can be
// counted at once: what a stencil buffer does for pixels, for points anywhere between them. All lights use one tree,
// and each has counts of its own.
#pragma once

#include <array>
#include <bit>
#include <limits>
#include <vector>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/raw_vector.h"
#include "umbra/core/render/points.h"

namespace umbra {

/// Where points are looked at from: an origin and an orthonormal, right-handed frame, x right, y down, z forward.
struct ViewFrame {
    dvec3 origin{0};
    dvec3 right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};

    [[nodiscard]] dvec3 turned(dvec3 v) const { return {glm::dot(right, v), glm::dot(down, v), glm::dot(forward, v)}; }
    [[nodiscard]] dvec3 seen(dvec3 p) const { return turned(p - origin); }
};

/// f(x, y, w) = (nx x + ny y) + (nz + nw w) + tie, for a point at (X, Y, Z) seen from the view: x = X/Z, y = Y/Z, w =
/// 1/Z. So (n, nw) is the plane n.(X, Y, Z) + nw = 0, and f has the sign of its side. The point is within where f > 0.
/// `tie` decides for points that give exactly 0, in the same way for all that share the plane, either way round.
struct HalfSpace {
    double nx = 0, ny = 0, nz = 0, nw = 0, tie = 0;

    /// The side of the plane where `sense` is +1, or the other where it is -1; together they hold every point once.
    static HalfSpace side(dvec3 n, double nw, int sense) {
        const double s = sense;
        return {s * n.x, s * n.y, s * n.z, s * nw, s * std::numeric_limits<double>::min()};
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

    void add(const HalfSpace& h) { faces[static_cast<std::size_t>(count++)] = h; }
};

/// The surface points of a batch, in a tree over (x, y, w).
class CountingTree {
public:
    /// Takes the points that have a triangle. All lie in front of the view.
    CountingTree(const Scene& scene, const PointBatch& points);

    [[nodiscard]] const ViewFrame& view() const { return view_; }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    friend class PointCounts;
    static constexpr std::size_t kLeaf   = 16;  // points in a leaf
    static constexpr std::size_t kFanOut = 4;   // children of a node
    /// The boxes in (x, y, w) of four nodes that have one parent; each at its index in every array.
    struct alignas(32) Siblings {
        double min[3][kFanOut], max[3][kFanOut];
    };
    using Level = RawVector<Siblings>;

    /// Up to whole siblings: the last may be empty.
    [[nodiscard]] std::size_t leaf_count() const {
        return (size() + kFanOut * kLeaf - 1) / (kFanOut * kLeaf) * kFanOut;
    }
    [[nodiscard]] std::size_t size() const { return index_.size(); }
    void project(const Scene& scene, const PointBatch& points);
    void build_nodes();

    RawVector<std::uint32_t> index_;  // point of the batch
    ViewFrame view_;
    RawVector<double> x_, y_, w_;  // padded to whole leaves
    std::vector<Level> levels_;    // leaves first; the children of node i are those at i, one level below
};

/// Counts at the points of a tree that need an answer for one light: those whose facing to it is `front` or `partly`.
class PointCounts {
public:
    /// `points` are those of the tree, which must outlive this object.
    PointCounts(const CountingTree& tree, const PointBatch& points, LightId light);

    /// Whether no point needs an answer.
    [[nodiscard]] bool empty() const { return levels_.empty() || levels_.back().asks[0] == 0; }

    /// Adds `weight` to every point within the region. From any number of threads at once; sums of integers are the
    /// same in any order.
    void add(const Region& region, std::int32_t weight);

    /// Calls visit(point of the batch, sum of the weights of the regions that it lies in), in parallel. Once, at the
    /// end.
    template <class Visit>
    void for_each(const Visit& visit);

private:
    static constexpr std::size_t kLeaf = CountingTree::kLeaf, kFanOut = CountingTree::kFanOut;
    using Siblings = CountingTree::Siblings;
    struct Level {
        std::vector<std::array<std::int32_t, kFanOut>> count;  // of each node of the tree
        RawVector<std::uint8_t> asks;  // a bit for each of four: some point below needs an answer
    };

    void descend(const Region& region, std::int32_t weight, std::size_t level, std::size_t parent, unsigned open);
    void add_to_leaf(const Region& region, std::int32_t weight, std::size_t leaf, unsigned open);
    void push_down();
    static unsigned within(const Siblings& nodes, const Region& region);
    static bool are_large(const Siblings& nodes, const Region& region, unsigned which);
    static unsigned cover(const HalfSpace& f, const Siblings& nodes);
    static unsigned cover(const HalfSpace& f, const double* low_x, const double* high_x, const double* low_y,
                          const double* high_y, const double* low_w, const double* high_w);

    const CountingTree& tree_;
    RawVector<std::uint16_t> asks_;  // of each leaf: a bit for each point
    RawVector<std::int32_t> count_;  // of each point; set in leaves where some point asks
    std::vector<Level> levels_;
};

/// The point as it is named, less `origin`, in double: but where it is closer to its triangle's border than 2^-44 of
/// the triangle's distance from `origin`, so much within (and no further than 2^-26 of the triangle). That is far above
/// the rounding of doubles there and far below that of floats; it keeps a point from lying on the planes through the
/// edges of its own triangle, where every triangle around would claim it.
[[nodiscard]] dvec3 named_point(const Scene& scene, const PointBatch& points, std::size_t i, dvec3 origin);

template <class Visit>
void PointCounts::for_each(const Visit& visit) {
    push_down();
    parallel_ranges(tree_.leaf_count(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            const std::int32_t all = levels_[0].count[leaf / kFanOut][leaf % kFanOut];
            for (unsigned asks = asks_[leaf]; asks != 0; asks &= asks - 1) {
                const std::size_t k = leaf * kLeaf + static_cast<std::size_t>(std::countr_zero(asks));
                visit(tree_.index_[k], count_[k] + all);
            }
        }
    });
}

}  // namespace umbra
