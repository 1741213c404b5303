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
    doubtful_.clear();
    for (std::size_t level = 0; level < points_.levels.size(); ++level) {
        const std::size_t nodes    = points_.levels[level].size();
        const std::size_t children = level == 0 ? points_.leaf_count() : points_.levels[level - 1].size();
        // Branches that do not exist are dark.
        dark_branches_[level].assign(nodes, 0);
        dark_branches_[level].back() = static_cast<std::uint8_t>(0xffu << (children - (nodes - 1) * kBranches));
    }
}

/// Visits the nodes that a shadow may darken; what is below a branch answers whether it is all dark now.
struct DarkeningTree::OneShadow {
    DarkeningTree& tree;
    const Shadow& shadow;
    const std::array<ShadowSide, 3>& sides;

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
        double sure[kLeaf], open[kLeaf];
        for (std::size_t i = 0; i < kLeaf; ++i) {
            const double at[3] = {sides[0].value.at(x[i], y[i]), sides[1].value.at(x[i], y[i]),
                                  sides[2].value.at(x[i], y[i])};
            sure[i]            = std::min({at[0] - sides[0].doubt, at[1] - sides[1].doubt, at[2] - sides[2].doubt});
            open[i]            = std::min({at[0] + sides[0].doubt, at[1] + sides[1].doubt, at[2] + sides[2].doubt});
        }
        bool all = true;
        for (std::size_t i = 0; i < std::min(kLeaf, tree.points_.size - leaf * kLeaf); ++i) {
            const std::atomic_ref<std::uint8_t> dark(tree.dark_[leaf * kLeaf + i]);
            if (sure[i] > 0 && !shadow.may_be_none) {
                dark.store(1, std::memory_order_relaxed);
            } else if (dark.load(std::memory_order_relaxed) == 0) {
                all = false;
                if (!(open[i] < 0)) tree.add_doubtful({leaf * kLeaf + i, leaf * kLeaf + i + 1});
            }
        }
        return all;
    }

private:
    enum class Cover : std::uint8_t { none, some, all };

    /// How the shadow covers a box, from the greatest and least value of each side over it.
    [[nodiscard]] Cover cover(const PlaneTree::Node& node, std::size_t k) const {
        const double x  = 0.5 * (static_cast<double>(node.low[0][k]) + static_cast<double>(node.high[0][k]));
        const double y  = 0.5 * (static_cast<double>(node.low[1][k]) + static_cast<double>(node.high[1][k]));
        const double rx = static_cast<double>(node.high[0][k]) - x, ry = static_cast<double>(node.high[1][k]) - y;
        bool all = !shadow.may_be_none;
        for (const auto& [s, of_side] : sides) {
            const double middle = s.at(x, y);
            const double reach  = std::abs(s.a) * rx + std::abs(s.b) * ry;
            const double doubt  = of_side + 1e-14 * (std::abs(s.a * x) + std::abs(s.b * y) + std::abs(s.c));
            if (middle + reach < -doubt) return Cover::none;
            all = all && middle - reach > doubt;
        }
        return all ? Cover::all : Cover::some;
    }
};

void DarkeningTree::darken(const Shadow& shadow, const std::array<ShadowSide, 3>& sides) {
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

void DarkeningTree::add_doubtful(PlaneTree::Range which) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = which.begin; i < which.end; ++i) doubtful_.push_back(static_cast<std::uint32_t>(i));
}

std::vector<std::uint32_t> DarkeningTree::doubtful() const {
    std::vector<std::uint32_t> found = doubtful_;
    std::erase_if(found, [&](std::uint32_t i) { return is_dark(i); });
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace umbra::planar
