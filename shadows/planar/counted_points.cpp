// Counts the shadows over the points of a tree from an outline's edges.
//
// A node knows the count over one point in it and the edges that may pass through it, which are all that can change the
// count on a way within the node: so its branches, and in the end the points of a leaf, find theirs. Where no edge
// passes, all points have one count and none is looked at.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/shadows/planar/darkening_tree.h"

namespace umbra::planar {

class DarkeningTree::Counter {
public:
    Counter(DarkeningTree& tree, const Outline& outline) : tree_(tree), points_(tree.points_), outline_(outline) {}

    std::vector<std::uint32_t> run() {
        const std::size_t top = points_.levels.size() - 1;
        if (!is_within_reach(points_.levels[top][0])) {
            Work all;
            for (std::size_t k = 0; k < kBranches; ++k) add_doubtful(top, k, all);
            return std::move(all.doubtful);
        }
        std::vector<Part> parts(1);
        parts[0] = {0, {}, outline_.reference, outline_.count};
        for (std::uint32_t e = 0; e < outline_.edges.size(); ++e) parts[0].edges.push_back(e);
        // Level by level, until there is work for many threads.
        std::size_t level = top;
        std::vector<std::uint32_t> doubtful;
        for (; level > 0 && parts.size() < 256; --level) {
            std::vector<std::vector<Part>> below(parts.size());
            std::vector<Work> works(parts.size());
            parallel_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t p = begin; p < end; ++p) {
                    std::array<std::vector<std::uint32_t>, kBranches> edges;
                    split(level, parts[p].node, parts[p].edges, parts[p].from, parts[p].count, edges, works[p],
                          [&](std::size_t k, dvec2 from, double count) {
                              below[p].push_back({parts[p].node * kBranches + k, std::move(edges[k]), from, count});
                          });
                }
            });
            parts.clear();
            for (std::size_t p = 0; p < below.size(); ++p) {
                std::ranges::move(below[p], std::back_inserter(parts));
                doubtful.insert(doubtful.end(), works[p].doubtful.begin(), works[p].doubtful.end());
            }
        }
        std::vector<Work> works(parts.size());
        parallel_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                works[p].edges.resize(level + 1);
                count(level, parts[p].node, parts[p].edges, parts[p].from, parts[p].count, works[p]);
            }
        });
        for (const Work& w : works) doubtful.insert(doubtful.end(), w.doubtful.begin(), w.doubtful.end());
        return doubtful;
    }

private:
    /// A node of a known level: the edges that may pass through it, a point in it, and the count over that.
    struct Part {
        std::size_t node = 0;
        std::vector<std::uint32_t> edges;
        dvec2 from{0};
        double count = 0;
    };
    struct Work {
        std::vector<std::uint32_t> doubtful;
        std::vector<std::array<std::vector<std::uint32_t>, kBranches>> edges;  ///< those of the branches, by level
    };

    [[nodiscard]] bool is_within_reach(const Node& top) const {
        const Reach& r = outline_.reach;
        for (std::size_t k = 0; k < kBranches; ++k)
            if (top.low_x[k] <= top.high_x[k] &&
                !(double(top.low_x[k]) >= r.low.x && double(top.high_x[k]) <= r.high.x &&
                  double(top.low_y[k]) >= r.low.y && double(top.high_y[k]) <= r.high.y))
                return false;
        return true;
    }

    void add_doubtful(std::size_t level, std::size_t child, Work& work) const {
        const Range under = points_.points_under(level, child);
        for (std::size_t i = under.begin; i < under.end; ++i)
            if (tree_.dark_[i] == 0) work.doubtful.push_back(static_cast<std::uint32_t>(i));
    }

    /// Finds the count over a point of each branch of a node, and the edges that may pass through it, which are written
    /// to edges[k]. Branches through which none passes are settled; body(k, point, count) gets the others.
    template <class Body>
    void split(std::size_t level, std::size_t n, std::span<const std::uint32_t> all, dvec2 from, double count,
               std::array<std::vector<std::uint32_t>, kBranches>& edges, Work& work, const Body& body) {
        const Node& node          = points_.levels[level][n];
        const std::uint32_t there = static_cast<std::uint8_t>(~tree_.dark_branches_[level][n]);
        double low_x[kBranches], low_y[kBranches], high_x[kBranches], high_y[kBranches], x[kBranches], y[kBranches];
        double counts[kBranches], doubt[kBranches];
        for (std::size_t k = 0; k < kBranches; ++k) {
            low_x[k] = double(node.low_x[k]), high_x[k] = double(node.high_x[k]);
            low_y[k] = double(node.low_y[k]), high_y[k] = double(node.high_y[k]);
            edges[k].clear();
        }
        // Any point of a box serves: the first that the ways to all are beside no edge.
        for (const auto& [share_x, share_y] : kPlaces) {
            for (std::size_t k = 0; k < kBranches; ++k) {
                x[k] = low_x[k] + share_x * (high_x[k] - low_x[k]), y[k] = low_y[k] + share_y * (high_y[k] - low_y[k]);
                counts[k] = count, doubt[k] = 0;
            }
            for (const std::uint32_t e : all) add_changes(outline_.edges[e], from, x, y, counts, doubt);
            bool sure = true;
            for (std::size_t k = 0; k < kBranches; ++k) sure &= (there >> k & 1) == 0 || doubt[k] == 0;
            if (sure) break;
        }
        for (const std::uint32_t e : all) {
            const OutlineEdge& edge = outline_.edges[e];
            const double left       = std::min(edge.from.x, edge.to.x) - edge.slack;
            const double right      = std::max(edge.from.x, edge.to.x) + edge.slack;
            const double bottom     = std::min(edge.from.y, edge.to.y) - edge.slack;
            const double top        = std::max(edge.from.y, edge.to.y) + edge.slack;
            std::uint32_t meets     = 0;
            for (std::size_t k = 0; k < kBranches; ++k)
                meets |= static_cast<std::uint32_t>((left <= high_x[k]) & (right >= low_x[k]) & (bottom <= high_y[k]) &
                                                    (top >= low_y[k]))
                         << k;
            for (meets &= there; meets != 0; meets &= meets - 1) {
                const auto k       = static_cast<std::size_t>(std::countr_zero(meets));
                const double reach = std::abs(edge.side.a) * std::max(high_x[k] - x[k], x[k] - low_x[k]) +
                                     std::abs(edge.side.b) * std::max(high_y[k] - y[k], y[k] - low_y[k]);
                if (std::abs(edge.side.at(x[k], y[k])) <= reach + edge.doubt) edges[k].push_back(e);
            }
        }
        for (std::uint32_t left = there; left != 0; left &= left - 1) {
            const auto k = static_cast<std::size_t>(std::countr_zero(left));
            // Each triangle counts as one over a point or not at all.
            if (doubt[k] != 0 || counts[k] < 0)
                add_doubtful(level, n * kBranches + k, work);
            else if (!edges[k].empty())
                body(k, dvec2(x[k], y[k]), counts[k]);
            else if (counts[k] > 0)
                tree_.fill(level, n * kBranches + k);
        }
    }

    void count(std::size_t level, std::size_t n, std::span<const std::uint32_t> all, dvec2 from, double over_from,
               Work& work) {
        auto& edges = work.edges[level];
        split(level, n, all, from, over_from, edges, work, [&](std::size_t k, dvec2 at, double over) {
            if (level == 0)
                count_leaf(n * kBranches + k, edges[k], at, over, work);
            else
                count(level - 1, n * kBranches + k, edges[k], at, over, work);
        });
    }

    void count_leaf(std::size_t leaf, std::span<const std::uint32_t> edges, dvec2 from, double over_from, Work& work) {
        const std::size_t begin = leaf * kLeaf, size = std::min(kLeaf, points_.size - begin);
        double x[kLeaf], y[kLeaf], counts[kLeaf], doubt[kLeaf];
        for (std::size_t i = 0; i < kLeaf; ++i) {
            x[i] = points_.x[begin + i], y[i] = points_.y[begin + i];
            counts[i] = over_from, doubt[i] = 0;
        }
        for (const std::uint32_t e : edges) add_changes(outline_.edges[e], from, x, y, counts, doubt);
        for (std::size_t i = 0; i < size; ++i) {
            if (counts[i] - doubt[i] > 0)
                tree_.dark_[begin + i] = 1;
            else if ((doubt[i] != 0 || counts[i] < 0) && tree_.dark_[begin + i] == 0)
                work.doubtful.push_back(static_cast<std::uint32_t>(begin + i));
        }
    }

    DarkeningTree& tree_;
    const PlaneTree& points_;
    const Outline& outline_;
};

std::vector<std::uint32_t> DarkeningTree::darken(const Outline& outline) {
    if (points_.levels.empty() || (outline.edges.empty() && outline.count == 0)) return {};
    return Counter(*this, outline).run();
}

}  // namespace umbra::planar
