#include "umbra/shadows/planar/darkening_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"

namespace umbra::planar {

// ---- points in a plane ----------------------------------------------------------------------------------------------

void sort_in_plane(RawVector<std::uint32_t>& points, Places& places) {
    const std::size_t count                = points.size();
    const RawVector<std::uint32_t> indices = points;
    const RawVector<double> x = places.x, y = places.y;
    dvec2 low(+kInfinity), high(-kInfinity);
    for (std::size_t i = 0; i < count; ++i) {
        low  = glm::min(low, dvec2(x[i], y[i]));
        high = glm::max(high, dvec2(x[i], y[i]));
    }
    const double extent = std::max({high.x - low.x, high.y - low.y, 1e-300});
    struct Keyed {
        std::uint64_t key;
        std::uint32_t at;
    };
    std::vector<Keyed> order(count);
    parallel_ranges(count, 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const dvec2 p = (dvec2(x[i], y[i]) - low) / extent * 0x1p31;
            order[i]      = {morton_code(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y)),
                             static_cast<std::uint32_t>(i)};
        }
    });
    parallel_sort(order.begin(), order.end(),
                  [](const Keyed& l, const Keyed& r) { return l.key != r.key ? l.key < r.key : l.at < r.at; });
    parallel_ranges(count, 65536, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            points[i]   = indices[order[i].at];
            places.x[i] = x[order[i].at];
            places.y[i] = y[order[i].at];
        }
    });
}

PlaneTree::PlaneTree(Places places) : size(places.x.size()), x(std::move(places.x)), y(std::move(places.y)) {
    // Filled up, so that leaves are tested whole.
    x.resize(leaf_count() * kLeaf, 0);
    y.resize(leaf_count() * kLeaf, 0);
    if (size == 0) return;
    std::size_t children = leaf_count();
    do {
        std::vector<Node> nodes((children + kBranches - 1) / kBranches);
        parallel_ranges(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n)
                for (std::size_t k = 0; k < kBranches; ++k) set_box(nodes[n], k, n * kBranches + k, children);
        });
        children = nodes.size();
        levels.push_back(std::move(nodes));
    } while (children > 1);
}

/// The box of branch k of a node of the level that is being built: child `child` of the level below it. Children of the
/// lowest nodes are leaves.
void PlaneTree::set_box(Node& node, std::size_t k, std::size_t child, std::size_t children) const {
    vec2 low(+kInfinity), high(-kInfinity);
    if (child < children && levels.empty()) {
        const std::size_t begin = child * kLeaf, end = std::min(size, begin + kLeaf);
        dvec2 least(x[begin], y[begin]), most        = least;
        for (std::size_t i = begin + 1; i < end; ++i) {
            least = glm::min(least, dvec2(x[i], y[i]));
            most  = glm::max(most, dvec2(x[i], y[i]));
        }
        low  = {float_below(least.x), float_below(least.y)};
        high = {float_above(most.x), float_above(most.y)};
    } else if (child < children) {
        const Node& below = levels.back()[child];
        for (std::size_t i = 0; i < kBranches; ++i) {
            low  = glm::min(low, vec2(below.low_x[i], below.low_y[i]));
            high = glm::max(high, vec2(below.high_x[i], below.high_y[i]));
        }
    }
    node.low_x[k]  = low.x;
    node.low_y[k]  = low.y;
    node.high_x[k] = high.x;
    node.high_y[k] = high.y;
}

PlaneTree::Range PlaneTree::points_under(std::size_t level, std::size_t child) const {
    std::size_t width = kLeaf;
    for (std::size_t l = 0; l < level; ++l) width *= kBranches;
    return {child * width, std::min(size, (child + 1) * width)};
}

std::size_t PlaneTree::memory_bytes() const {
    std::size_t bytes = 2 * x.size() * sizeof(double);
    for (const auto& nodes : levels) bytes += nodes.size() * sizeof(Node);
    return bytes;
}

// ---- darkening ------------------------------------------------------------------------------------------------------

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

void DarkeningTree::darken(const Shadow& shadow, const std::array<Side, 3>& sides) {
    if (!points_.levels.empty()) darken(points_.levels.size() - 1, 0, shadow, sides);
}

/// How the shadow covers a box, from the greatest and least value of each side over it. Rounding is far below the float
/// steps that boxes were grown by, but where sides are that close the answer is `some`.
DarkeningTree::Cover DarkeningTree::cover(const std::array<Side, 3>& sides, const Node& node, std::size_t k) {
    const double x  = 0.5 * (static_cast<double>(node.low_x[k]) + static_cast<double>(node.high_x[k]));
    const double y  = 0.5 * (static_cast<double>(node.low_y[k]) + static_cast<double>(node.high_y[k]));
    const double rx = static_cast<double>(node.high_x[k]) - x, ry = static_cast<double>(node.high_y[k]) - y;
    bool all = true;
    for (const Side& s : sides) {
        const double middle = s.at(x, y);
        const double reach  = std::abs(s.a) * rx + std::abs(s.b) * ry;
        const double doubt  = 1e-14 * (std::abs(s.a * x) + std::abs(s.b * y) + std::abs(s.c));
        if (middle + reach < -doubt) return Cover::none;
        all = all && middle - reach > doubt;
    }
    return all ? Cover::all : Cover::some;
}

/// Returns whether the whole node is dark now.
bool DarkeningTree::darken(std::size_t level, std::size_t n, const Shadow& shadow, const std::array<Side, 3>& sides) {
    const Node& node = points_.levels[level][n];
    const std::atomic_ref<std::uint8_t> dark(dark_branches_[level][n]);
    std::uint32_t hit = 0;
    for (std::uint32_t k = 0; k < kBranches; ++k)
        hit |= static_cast<std::uint32_t>((node.low_x[k] <= shadow.high.x) & (node.high_x[k] >= shadow.low.x) &
                                          (node.low_y[k] <= shadow.high.y) & (node.high_y[k] >= shadow.low.y))
               << k;
    hit &= ~static_cast<std::uint32_t>(dark.load(std::memory_order_relaxed));
    const vec2 size = shadow.high - shadow.low;
    for (; hit != 0; hit &= hit - 1) {
        const auto k  = static_cast<std::size_t>(std::countr_zero(hit));
        Cover covered = Cover::some;
        if (node.high_x[k] - node.low_x[k] < size.x || node.high_y[k] - node.low_y[k] < size.y)
            covered = cover(sides, node, k);
        if (covered == Cover::none) continue;
        const std::size_t child = n * kBranches + k;
        bool all                = covered == Cover::all;
        if (all)
            fill(level, child);
        else
            all = level == 0 ? darken_leaf(child, sides) : darken(level - 1, child, shadow, sides);
        if (all) dark.fetch_or(static_cast<std::uint8_t>(1u << k), std::memory_order_relaxed);
    }
    return dark.load(std::memory_order_relaxed) == 0xff;
}

/// Returns whether the whole leaf is dark now.
bool DarkeningTree::darken_leaf(std::size_t leaf, const std::array<Side, 3>& sides) {
    const double* const x = points_.x.data() + leaf * kLeaf;
    const double* const y = points_.y.data() + leaf * kLeaf;
    double least[kLeaf];
    for (std::size_t i = 0; i < kLeaf; ++i)
        least[i] = std::min({sides[0].at(x[i], y[i]), sides[1].at(x[i], y[i]), sides[2].at(x[i], y[i])});
    bool all = true;
    for (std::size_t i = 0; i < std::min(kLeaf, points_.size - leaf * kLeaf); ++i) {
        const std::atomic_ref<std::uint8_t> dark(dark_[leaf * kLeaf + i]);
        if (least[i] >= 0)
            dark.store(1, std::memory_order_relaxed);
        else
            all = all && dark.load(std::memory_order_relaxed) != 0;
    }
    return all;
}

/// All points under child `child` of `level` become dark.
void DarkeningTree::fill(std::size_t level, std::size_t child) {
    const Range under = points_.points_under(level, child);
    for (std::size_t i = under.begin; i < under.end; ++i)
        std::atomic_ref<std::uint8_t>(dark_[i]).store(1, std::memory_order_relaxed);
}

}  // namespace umbra::planar
