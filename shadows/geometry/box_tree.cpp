#include "umbra/shadows/geometry/box_tree.h"

#include <array>
#include <atomic>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr int kBins           = 16;
constexpr std::uint32_t kLeaf = 4;
constexpr int kMaxDepth       = 60;  ///< the stack of a visit holds 64

float half_area(const Box& b) {
    if (b.empty()) return 0;
    const vec3 s = b.size();
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

}  // namespace

struct BoxTree::Builder {
    BoxTree& tree;
    std::vector<Box> boxes;
    std::vector<vec3> centres;
    std::atomic<std::uint32_t> used{1};

    struct Bin {
        Box box;
        std::uint32_t count = 0;
    };

    void build(std::uint32_t index, std::uint32_t begin, std::uint32_t end, int depth) {
        Box box, centre_box;
        for (std::uint32_t i = begin; i < end; ++i) {
            box        = extend(box, boxes[tree.order_[i]]);
            centre_box = extend(centre_box, centres[tree.order_[i]]);
        }
        Node& node = tree.nodes_[index];
        node.min   = box.min;
        node.max   = box.max;

        const std::uint32_t middle = end - begin > kLeaf && depth < kMaxDepth ? split(begin, end, centre_box) : begin;
        if (middle == begin || middle == end) {
            node.first = begin;
            node.count = end - begin;
            return;
        }
        const std::uint32_t children = used.fetch_add(2);
        node.first                   = children;
        node.count                   = 0;
        const auto left              = [&] { build(children, begin, middle, depth + 1); };
        const auto right             = [&] { build(children + 1, middle, end, depth + 1); };
        if (end - begin > 10000) {
            parallel_pair(left, right);
        } else {
            left();
            right();
        }
    }

    /// Sorts [begin, end) into two runs at the best of kBins planes along the widest axis; returns where the second
    /// begins.
    std::uint32_t split(std::uint32_t begin, std::uint32_t end, const Box& centre_box) {
        const vec3 size = centre_box.size();
        const int axis  = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        // All centres in one point, or so near that kBins over their distance may not be finite: any halves do.
        if (!(size[axis] > 1e-30f)) return begin + (end - begin) / 2;
        const float scale = kBins / size[axis];
        const auto bin_of = [&](Item t) {
            return std::clamp(static_cast<int>((centres[t][axis] - centre_box.min[axis]) * scale), 0, kBins - 1);
        };
        std::array<Bin, kBins> bins;
        for (std::uint32_t i = begin; i < end; ++i) {
            Bin& bin = bins[static_cast<std::size_t>(bin_of(tree.order_[i]))];
            bin.box  = extend(bin.box, boxes[tree.order_[i]]);
            ++bin.count;
        }
        std::array<float, kBins> right_cost{};
        Bin right;
        for (std::size_t k = kBins; k-- > 1;) {
            right.box = extend(right.box, bins[k].box);
            right.count += bins[k].count;
            right_cost[k] = half_area(right.box) * static_cast<float>(right.count);
        }
        Bin left;
        float best_cost = kInfinity;
        int best        = 0;
        for (int k = 1; k < kBins; ++k) {
            const Bin& bin = bins[static_cast<std::size_t>(k - 1)];
            left.box       = extend(left.box, bin.box);
            left.count += bin.count;
            const float cost =
                half_area(left.box) * static_cast<float>(left.count) + right_cost[static_cast<std::size_t>(k)];
            if (cost < best_cost) {
                best_cost = cost;
                best      = k;
            }
        }
        const auto first  = tree.order_.begin() + begin;
        const auto middle = std::partition(first, tree.order_.begin() + end, [&](Item t) { return bin_of(t) < best; });
        const auto count  = static_cast<std::uint32_t>(middle - first);
        return count == 0 || count == end - begin ? begin + (end - begin) / 2 : begin + count;
    }
};

BoxTree::BoxTree(std::vector<Box> boxes) {
    const auto n = static_cast<std::uint32_t>(boxes.size());
    if (n == 0) return;
    Builder builder{*this, std::move(boxes), std::vector<vec3>(n)};
    order_.resize(n);
    for (Item t = 0; t < n; ++t) {
        order_[t]          = t;
        builder.centres[t] = builder.boxes[t].centre();
    }
    nodes_.resize(2 * static_cast<std::size_t>(n));
    builder.build(0, 0, n, 0);
    nodes_.resize(builder.used);
}

}  // namespace umbra
