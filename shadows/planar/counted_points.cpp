// Counts the shadows over the points of a tree from an outline's edges.
//
// A node knows the count over one point in it and the edges that may pass through it, which are all that can change the
// count on a way within the node: so its branches, and in the end the points of a leaf, find theirs. Where no edge
// passes, all points have one count and none is looked at.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/planar/darkening_tree.h"

namespace umbra::planar {

struct DarkeningTree::Counter {
    using Edges = std::array<std::vector<std::uint32_t>, kBranches>;  ///< those that may pass through each branch

    /// A node or a leaf: the edges that may pass through it, a point in it, and the count over that.
    struct Uncounted {
        std::span<const std::uint32_t> edges;
        dvec2 from{0};
        double count = 0;
        Edges* below = nullptr;  ///< room for the edges of branches, by level
    };

    /// Finds the count over a point of each branch, and the edges that may pass through it. Branches through which none
    /// passes are settled.
    template <class GoOn>
    void node(std::size_t level, std::size_t n, const Uncounted& part, const GoOn& go_on) {
        const std::uint32_t there = static_cast<std::uint8_t>(~tree.dark_branches_[level][n]);
        BoxLanes<double, 2, kBranches> box;
        double x[kBranches], y[kBranches], counts[kBranches], doubt[kBranches];
        Edges& edges = part.below[level];
        for (std::size_t k = 0; k < kBranches; ++k) {
            for (int axis = 0; axis < 2; ++axis) {
                box.low[axis][k]  = double(points.levels[level][n].low[axis][k]);
                box.high[axis][k] = double(points.levels[level][n].high[axis][k]);
            }
            edges[k].clear();
        }
        const auto& [low_x, low_y]   = box.low;
        const auto& [high_x, high_y] = box.high;
        // Any point of a box serves: the first that the ways to all are beside no edge.
        for (const auto& [share_x, share_y] : kPlaces) {
            for (std::size_t k = 0; k < kBranches; ++k) {
                x[k] = low_x[k] + share_x * (high_x[k] - low_x[k]), y[k] = low_y[k] + share_y * (high_y[k] - low_y[k]);
                counts[k] = part.count, doubt[k] = 0;
            }
            for (const std::uint32_t e : part.edges) add_changes(outline.edges[e], part.from, x, y, counts, doubt);
            bool sure = true;
            for (std::size_t k = 0; k < kBranches; ++k) sure &= (there >> k & 1) == 0 || doubt[k] == 0;
            if (sure) break;
        }
        for (const std::uint32_t e : part.edges) {
            const OutlineEdge& edge = outline.edges[e];
            const dvec2 least       = glm::min(edge.from, edge.to) - edge.slack,
                        most        = glm::max(edge.from, edge.to) + edge.slack;
            for (unsigned meets = box.meeting(least, most) & there; meets != 0; meets &= meets - 1) {
                const auto k       = static_cast<std::size_t>(std::countr_zero(meets));
                const double reach = std::abs(edge.side.a) * std::max(high_x[k] - x[k], x[k] - low_x[k]) +
                                     std::abs(edge.side.b) * std::max(high_y[k] - y[k], y[k] - low_y[k]);
                if (std::abs(edge.side.at(x[k], y[k])) <= reach + edge.doubt) edges[k].push_back(e);
            }
        }
        const auto settle = [&](std::size_t k, Edges* below) {
            // Each triangle counts as one over a point or not at all.
            if ((there >> k & 1) == 0) return;
            if (doubt[k] != 0 || counts[k] < 0)
                tree.add_doubtful(points.points_under(level, n * kBranches + k));
            else if (!edges[k].empty())
                go_on(k, Uncounted{edges[k], dvec2(x[k], y[k]), counts[k], below});
            else if (counts[k] > 0)
                tree.fill(level, n * kBranches + k);
        };
        if (level == 0 || level + kParallel < points.levels.size())
            for (std::size_t k = 0; k < kBranches; ++k) settle(k, part.below);
        else
            parallel_ranges(kBranches, 1, [&](std::size_t begin, std::size_t end) {
                std::vector<Edges> below(level);
                for (std::size_t k = begin; k < end; ++k) settle(k, below.data());
            });
    }

    void leaf(std::size_t leaf, const Uncounted& part) {
        const std::size_t begin = leaf * kLeaf, size = std::min(kLeaf, points.size - begin);
        double x[kLeaf], y[kLeaf], counts[kLeaf], doubt[kLeaf];
        for (std::size_t i = 0; i < kLeaf; ++i) {
            x[i] = points.at[0][begin + i], y[i] = points.at[1][begin + i];
            counts[i] = part.count, doubt[i] = 0;
        }
        for (const std::uint32_t e : part.edges) add_changes(outline.edges[e], part.from, x, y, counts, doubt);
        for (std::size_t i = 0; i < size; ++i) {
            if (counts[i] - doubt[i] > 0)
                tree.dark_[begin + i] = 1;
            else if (doubt[i] != 0 || counts[i] < 0)
                tree.add_doubtful({begin + i, begin + i + 1});
        }
    }

    static constexpr std::size_t kParallel = 4;  ///< uppermost levels whose branches are given to many threads

    DarkeningTree& tree;
    const PlaneTree& points;
    const Outline& outline;
};

void DarkeningTree::darken(const Outline& outline) {
    if (points_.levels.empty() || (outline.edges.empty() && outline.count == 0)) return;
    Counter counter{*this, points_, outline};
    const auto [low, high] = points_.levels.back()[0].bounds();
    const Reach& reach     = outline.reach;
    if (double(low.x) >= reach.low.x && double(high.x) <= reach.high.x && double(low.y) >= reach.low.y &&
        double(high.y) <= reach.high.y) {
        std::vector<std::uint32_t> all(outline.edges.size());
        std::iota(all.begin(), all.end(), 0u);
        std::vector<Counter::Edges> below(points_.levels.size());
        PlaneTree::descend(counter, below.size() - 1, 0,
                           Counter::Uncounted{all, outline.reference, outline.count, below.data()});
    } else {
        add_doubtful({0, points_.size});
    }
}

}  // namespace umbra::planar
