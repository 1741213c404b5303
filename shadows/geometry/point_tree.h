// Surface points in a tree of boxes, over an order in which neighbours are near.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/raw_vector.h"
#include "umbra/core/render/points.h"

namespace umbra {

/// A float below, or above, the float nearest to x: the next, or the one beside that.
[[nodiscard]] float float_below(double x);
[[nodiscard]] float float_above(double x);

/// Boxes, each at its index in every array. Empty ones have low > high.
template <class T, int kAxes, std::size_t kCount>
struct alignas(32) BoxLanes {
    using Vec = glm::vec<kAxes, T>;
    struct Bounds {
        Vec low{+std::numeric_limits<T>::infinity()}, high{-std::numeric_limits<T>::infinity()};
    };

    void set(std::size_t k, const Bounds& box) {
        for (int axis = 0; axis < kAxes; ++axis) low[axis][k] = box.low[axis], high[axis][k] = box.high[axis];
    }
    /// Around all.
    [[nodiscard]] Bounds bounds() const {
        Bounds all;
        for (int axis = 0; axis < kAxes; ++axis)
            for (std::size_t k = 0; k < kCount; ++k) {
                all.low[axis]  = std::min(all.low[axis], low[axis][k]);
                all.high[axis] = std::max(all.high[axis], high[axis][k]);
            }
        return all;
    }
    /// Those that a box meets: one bit each.
    [[nodiscard]] unsigned meeting(const Vec& least, const Vec& most) const {
        using Bits       = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;  // as wide: vector code
        const auto meets = [&](int axis, std::size_t k) {
            return Bits{high[axis][k] >= least[axis]} & Bits{low[axis][k] <= most[axis]};
        };
        Bits bits = 0;
#pragma GCC unroll 1
        for (std::size_t k = 0; k < kCount; ++k) bits |= (meets(0, k) & meets(1, k) & meets(kAxes - 1, k)) << k;
        return static_cast<unsigned>(bits);
    }

    T low[kAxes][kCount], high[kAxes][kCount];
};

/// The tree: leaves of 16 points, nodes of some branches, which are leaves or nodes of the level below. Boxes of
/// doubles fit their points; those of floats are up to two steps of floats larger on each side.
template <class T, int kAxes, std::size_t kOfNode>
class PointTree {
public:
    static constexpr std::size_t kLeaf = 16, kBranches = kOfNode;
    using Node  = BoxLanes<T, kAxes, kBranches>;
    using Point = glm::vec<kAxes, double>;

    PointTree() = default;
    /// fill(at, begin, end) writes at[axis][i] for the points i of a leaf, or for all 16 places in it. Called from many
    /// threads, each of which has copies of `fill` for leaves that follow one another, and may keep results of the
    /// last.
    template <class Fill>
    PointTree(std::size_t points, const Fill& fill) : size(points) {
        for (auto& coordinates : at) coordinates.resize(leaf_count() * kLeaf);
        if (size == 0) return;
        add_level(leaf_count(), [this, fill = fill](std::size_t leaf) mutable { return fill_leaf(leaf, fill); });
        while (levels.back().size() > 1)
            add_level(levels.back().size(), [&below = levels.back()](std::size_t n) { return below[n].bounds(); });
    }

    [[nodiscard]] Point point(std::size_t i) const {
        Point p;
        for (int axis = 0; axis < kAxes; ++axis) p[axis] = at[axis][i];
        return p;
    }
    [[nodiscard]] std::size_t leaf_count() const { return (size + kLeaf - 1) / kLeaf; }
    struct Range {
        std::size_t begin, end;
    };
    /// The points under child `child` of a node of `level`.
    [[nodiscard]] Range points_under(std::size_t level, std::size_t child) const {
        std::size_t width = kLeaf;
        for (std::size_t l = 0; l < level; ++l) width *= kBranches;
        return {child * width, std::min(size, (child + 1) * width)};
    }
    [[nodiscard]] std::size_t memory_bytes() const {
        std::size_t bytes = kAxes * at[0].size() * sizeof(double);
        for (const auto& nodes : levels) bytes += nodes.size() * sizeof(Node);
        return bytes;
    }

    /// visitor.node(level, n, state..., go_on), where go_on(k, state of branch k...) goes on below that branch: to
    /// visitor.leaf(leaf, state...) or to a node. Each gives what the visitor finds there.
    template <class Visitor, class... State>
    UMBRA_FOR_EACH_PROCESSOR static auto descend(Visitor& visitor, std::size_t level, std::size_t n,
                                                 const State&... state) -> decltype(visitor.leaf(n, state...)) {
        return visitor.node(level, n, state..., [&visitor, level, n](std::size_t k, const State&... below) {
            const std::size_t child = n * kBranches + k;
            return level == 0 ? visitor.leaf(child, below...) : descend(visitor, level - 1, child, below...);
        });
    }

    std::size_t size = 0;                     ///< points
    std::array<RawVector<double>, kAxes> at;  ///< [axis][point], filled up to whole leaves
    std::vector<RawVector<Node>> levels;      ///< lowest first; the last has one node

private:
    template <class Fill>
    UMBRA_FOR_EACH_PROCESSOR typename Node::Bounds fill_leaf(std::size_t leaf, Fill& fill) {
        const auto [begin, end] = points_under(0, leaf);
        fill(at, begin, end);
        Point least(+std::numeric_limits<double>::infinity()), most(-least);
        for (std::size_t i = begin; i < end; ++i) least = glm::min(least, point(i)), most = glm::max(most, point(i));
        typename Node::Bounds box;
        for (int axis = 0; axis < kAxes; ++axis) {
            for (std::size_t i = end; i < begin + kLeaf; ++i) at[axis][i] = 0;  // leaves are tested whole
            box.low[axis] = outwards(least[axis], T{-1}), box.high[axis] = outwards(most[axis], T{+1});
        }
        return box;
    }

    static T outwards(double x, T way) {
        if constexpr (std::is_same_v<T, double>)
            return x;
        else
            return way < 0 ? float_below(x) : float_above(x);
    }

    template <class BoundsOf>
    void add_level(std::size_t children, const BoundsOf& bounds_of) {
        RawVector<Node> nodes((children + kBranches - 1) / kBranches);
        parallel_ranges(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
            BoundsOf bounds = bounds_of;
            for (std::size_t k = begin * kBranches; k < end * kBranches; ++k)
                nodes[k / kBranches].set(k % kBranches, k < children ? bounds(k) : typename Node::Bounds{});
        });
        levels.push_back(std::move(nodes));
    }
};

/// Where the points of a leaf lie, in double, in a frame of the caller's: corners_of(t) is the first corner of triangle
/// t, and the ways from there to the others.
template <class CornersOf>
class LeafPlaces {
    static constexpr std::size_t kLeaf = 16;

public:
    /// `index`: the points of all leaves.
    LeafPlaces(const PointBatch& points, std::span<const std::uint32_t> index, const CornersOf& corners_of)
        : points_(points), index_(index), corners_of_(corners_of) {}

    /// For a leaf with points index[begin] to index[end - 1].
    void find(std::size_t begin, std::size_t end) {
        const std::uint32_t* const index = index_.data() + begin;
        // The next in memory are other points: of blocks of 4 x 4 pixels, the first of each row.
        if (begin + 5 * kLeaf < index_.size())
            for (const std::size_t ahead : {64, 66, 72, 74}) {
                __builtin_prefetch(&points_.triangle[index[ahead]]);
                __builtin_prefetch(&points_.u[index[ahead]]);
                __builtin_prefetch(&points_.v[index[ahead]]);
            }
        const std::size_t count = end - begin;
        bool together           = count == kLeaf;
        for (std::size_t k = 0; k < count; ++k) {
            u[k] = static_cast<double>(points_.u[index[k]]), v[k] = static_cast<double>(points_.v[index[k]]);
            together &= points_.triangle[index[k]] == points_.triangle[index[0]];
        }
        const auto stand_on = [&](std::size_t k) {  // neighbours are mostly on one triangle
            if (const TriangleId t = points_.triangle[index[k]]; t != last_) last_ = t, corners_ = corners_of_(t);
        };
        const auto place = [&](std::size_t k) {
            const auto& [a, ab, ac] = corners_;
            x[k]                    = a.x + u[k] * ab.x + v[k] * ac.x;
            y[k]                    = a.y + u[k] * ab.y + v[k] * ac.y;
            z[k]                    = a.z + u[k] * ab.z + v[k] * ac.z;
        };
        if (together) {
            stand_on(0);
            for (std::size_t k = 0; k < kLeaf; ++k) place(k);
        } else {
            for (std::size_t k = 0; k < count; ++k) stand_on(k), place(k);
        }
    }

    double u[kLeaf]{}, v[kLeaf]{}, x[kLeaf]{}, y[kLeaf]{}, z[kLeaf]{};

private:
    const PointBatch& points_;
    std::span<const std::uint32_t> index_;
    CornersOf corners_of_;
    TriangleId last_ = kNoTriangle;
    std::array<dvec3, 3> corners_{};
};

/// places[i]: of points[i], before they are sorted.
void sort_by_places(std::span<std::uint32_t> points, std::span<const dvec2> places);

/// Sorts points along the Morton curve of a plane, an order in which neighbours are near. place_of(p) is where point p
/// of the batch lies in the plane.
template <class PlaceOf>
void sort_in_plane(std::span<std::uint32_t> points, const PlaceOf& place_of) {
    RawVector<dvec2> places(points.size());
    parallel_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) places[i] = place_of(points[i]);
    });
    sort_by_places(points, places);
}

}  // namespace umbra
