#include "umbra/shadows/planar/darkening_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace umbra::planar {

DarkeningTree::DarkeningTree(const PlaneTree& points) : points_(points), dark_branches_(points.levels.size()) {
    brighten();
}

void DarkeningTree::brighten() {
    dark_.assign(points_.size, 0);
    for (std::size_t level = 0; level < points_.levels.size(); ++level) {
        const std::size_t nodes    = points_.levels[level].size();
        const std::size_t children = level == 0 ? points_.leaf_count() : points_.levels[level - 1].size();
        // What is not there is dark.
        dark_branches_[level].assign(nodes, 0);
        dark_branches_[level].back() = static_cast<std::uint8_t>(0xffu << (children - (nodes - 1) * kBranches));
    }
}

/// Visits the nodes that a shadow may darken; what is below a branch answers whether it is all dark now.
struct DarkeningTree::OneShadow {
    DarkeningTree& tree;
    const Shadow& shadow;
    const std::array<EdgeFunction, 3>& sides;

    template <class GoOn>
    bool node(std::size_t level, std::size_t n, const GoOn& go_on) {
        const PlaneTree::Node& node = tree.points_.levels[level][n];
        const std::atomic_ref<std::uint8_t> dark(tree.dark_branches_[level][n]);
        const vec2 size   = shadow.high - shadow.low;
        std::uint32_t hit = node.meeting(shadow.low, shadow.high);
        hit &= ~static_cast<std::uint32_t>(dark.load(std::memory_order_relaxed));
        for (; hit != 0; hit &= hit - 1) {
            const auto k  = static_cast<std::size_t>(std::countr_zero(hit));
            Cover covered = Cover::some;
            if (node.high[0][k] - node.low[0][k] < size.x || node.high[1][k] - node.low[1][k] < size.y)
                covered = cover(node, k);
            if (covered == Cover::none) continue;
            if (covered == Cover::all)
                tree.fill(level, n * kBranches + k);
            else if (!go_on(k))
                continue;
            dark.fetch_or(static_cast<std::uint8_t>(1u << k), std::memory_order_relaxed);
        }
        return dark.load(std::memory_order_relaxed) == 0xff;
    }

    bool leaf(std::size_t leaf) {
        const double* const x = tree.points_.at[0].data() + leaf * kLeaf;
        const double* const y = tree.points_.at[1].data() + leaf * kLeaf;
        double least[kLeaf];
        for (std::size_t i = 0; i < kLeaf; ++i)
            least[i] = std::min({sides[0].at(x[i], y[i]), sides[1].at(x[i], y[i]), sides[2].at(x[i], y[i])});
        bool all = true;
        for (std::size_t i = 0; i < std::min(kLeaf, tree.points_.size - leaf * kLeaf); ++i) {
            const std::atomic_ref<std::uint8_t> dark(tree.dark_[leaf * kLeaf + i]);
            if (least[i] >= 0)
                dark.store(1, std::memory_order_relaxed);
            else
                all = all && dark.load(std::memory_order_relaxed) != 0;
        }
        return all;
    }

private:
    enum class Cover : std::uint8_t { none, some, all };

    /// How the shadow covers a box, from the greatest and least value of each side over it. Rounding is far below the
    /// float steps that boxes were grown by, but where sides are that close the answer is `some`.
    [[nodiscard]] Cover cover(const PlaneTree::Node& node, std::size_t k) const {
        const double x  = 0.5 * (static_cast<double>(node.low[0][k]) + static_cast<double>(node.high[0][k]));
        const double y  = 0.5 * (static_cast<double>(node.low[1][k]) + static_cast<double>(node.high[1][k]));
        const double rx = static_cast<double>(node.high[0][k]) - x, ry = static_cast<double>(node.high[1][k]) - y;
        bool all = true;
        for (const EdgeFunction& s : sides) {
            const double middle = s.at(x, y);
            const double reach  = std::abs(s.a) * rx + std::abs(s.b) * ry;
            const double doubt  = 1e-14 * (std::abs(s.a * x) + std::abs(s.b * y) + std::abs(s.c));
            if (middle + reach < -doubt) return Cover::none;
            all = all && middle - reach > doubt;
        }
        return all ? Cover::all : Cover::some;
    }
};

void DarkeningTree::darken(const Shadow& shadow, const std::array<EdgeFunction, 3>& sides) {
    if (points_.levels.empty()) return;
    OneShadow visitor{*this, shadow, sides};
    PlaneTree::descend(visitor, points_.levels.size() - 1, 0);
}

/// All points under child `child` of `level` become dark.
void DarkeningTree::fill(std::size_t level, std::size_t child) {
    const PlaneTree::Range under = points_.points_under(level, child);
    for (std::size_t i = under.begin; i < under.end; ++i)
        std::atomic_ref<std::uint8_t>(dark_[i]).store(1, std::memory_order_relaxed);
}

}  // namespace umbra::planar
