// A bounding volume hierarchy that never loses a box: for exact questions, so apart from Embree.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// Binary tree of axis-aligned boxes, split by binned surface area. Items are indices into the boxes that the tree was
/// made of.
/// [Ingo Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007]
class BoxTree {
public:
    using Item = std::uint32_t;

    explicit BoxTree(std::vector<Box> boxes);

    /// A piece of a line: from + s direction, 0 <= s <= length (which may be infinite). `slack` is how far the true
    /// piece may lie from this one, in every coordinate.
    struct Piece {
        dvec3 from{0}, direction{0, 1, 0};
        double length = 1;
        double slack  = 0;
    };

    /// Calls visit(item) for every item whose box the piece may meet, until visit returns false. Conservative:
    /// the boxes are widened by more than the rounding of the test.
    template <class Visit>
    void visit(const Piece& piece, const Visit& visit) const {
        const dvec3 inverse = 1.0 / piece.direction;  // infinite where a component is 0: the test below copes
        descend([&](std::uint32_t, const Node& node) { return meets(node, piece, inverse); }, visit);
    }

    /// A convex region: the points q with dot(normal, q - from) + offset >= 0 for each of its planes. Every coordinate
    /// of `from` may have an error of `slack`, that of a normal one of `tilt`.
    struct Region {
        struct Plane {
            dvec3 normal{0};
            double offset = 0;
        };
        std::array<Plane, 5> planes{};
        dvec3 from{0};
        double slack = 0, tilt = 0;
    };

    /// The same for every item whose box may meet the region: all of those, and some that only come close. Asks
    /// enter(node, box) first, and leaves out all that is in nodes for which it says no.
    template <class Enter, class Visit>
    void visit(const Region& region, const Enter& enter, const Visit& visit) const {
        const WidePlanes planes = widened(region);
        descend(
            [&](std::uint32_t index, const Node& node) {
                return meets(node, region.from, planes) && enter(index, Box{node.min, node.max});
            },
            visit);
    }

    /// Calls visit(item) for every item in nodes that enter(box) says yes to, and whose parents it said yes to. The
    /// last call of `enter` before a visit was for the item's leaf.
    template <class Enter, class Visit>
    void visit_entered(const Enter& enter, const Visit& visit) const {
        descend(
            [&](std::uint32_t, const Node& node) {
                return enter(Box{node.min, node.max});
            },
            [&](Item item) { return visit(item), true; });
    }

    /// of(item) of all items in a node, joined; one a node: for `enter`.
    template <class Of, class Join>
    [[nodiscard]] auto summaries(const Of& of, const Join& join) const {
        std::vector<decltype(of(Item{}))> all(nodes_.size());
        for (std::size_t n = nodes_.size(); n-- > 0;) {  // children come after their parent
            const Node& node = nodes_[n];
            all[n]           = node.count > 0 ? of(order_[node.first]) : join(all[node.first], all[node.first + 1]);
            for (std::uint32_t k = 1; k < node.count; ++k) all[n] = join(all[n], of(order_[node.first + k]));
        }
        return all;
    }

    /// Numbers the items in the order of the leaves, so that what lies together is numbered so. What they were before,
    /// by their new numbers.
    [[nodiscard]] std::vector<Item> renumber() {
        std::vector<Item> before(order_.size());
        std::iota(before.begin(), before.end(), Item{0});
        before.swap(order_);
        return before;
    }

    [[nodiscard]] std::size_t memory_bytes() const {
        return nodes_.size() * sizeof(Node) + order_.size() * sizeof(Item);
    }

private:
    struct Node {
        vec3 min{0}, max{0};
        std::uint32_t first = 0;  ///< leaf: index into order_; inner: index of two neighbouring nodes
        std::uint32_t count = 0;  ///< 0: inner
    };

    /// Calls visit(item) for the items of all leaves that enters(index, node) says yes to, as to their parents, until
    /// visit returns false.
    template <class Enters, class Visit>
    void descend(const Enters& enters, const Visit& visit) const {
        if (nodes_.empty()) return;
        std::uint32_t stack[64];
        int depth      = 0;
        stack[depth++] = 0;
        while (depth > 0) {
            const std::uint32_t index = stack[--depth];
            const Node& node          = nodes_[index];
            if (!enters(index, node)) continue;
            if (node.count > 0) {
                for (std::uint32_t k = 0; k < node.count; ++k)
                    if (!visit(order_[node.first + k])) return;
            } else {
                stack[depth++] = node.first;
                stack[depth++] = node.first + 1;
            }
        }
    }

    static bool meets(const Node& node, const Piece& piece, const dvec3& inverse) {
        double enter = 0, leave = piece.length;
        for (int k = 0; k < 3; ++k) {
            // Widened by the slack and, relative to the numbers at hand, by far more than two roundings.
            const double lo   = static_cast<double>(node.min[k]) - piece.from[k];
            const double hi   = static_cast<double>(node.max[k]) - piece.from[k];
            const double wide = piece.slack + 1e-14 * (std::abs(lo) + std::abs(hi));
            if (piece.direction[k] == 0) {
                if (lo > wide || hi < -wide) return false;
                continue;
            }
            double a = (lo - wide) * inverse[k], b = (hi + wide) * inverse[k];
            if (a > b) std::swap(a, b);
            enter = std::max(enter, a);
            leave = std::min(leave, b);
        }
        return enter <= leave + 1e-14 * std::abs(leave);
    }

    /// A region's plane, and the error at a corner q less `from`: weight . |q|. Rounding of the sum is below 1e-14 of
    /// its terms' magnitudes; the rest of the error is in the offset.
    struct WidePlane {
        dvec3 normal{0}, weight{0};
        double offset = 0;
    };
    using WidePlanes = std::array<WidePlane, 5>;

    static WidePlanes widened(const Region& region) {
        WidePlanes wide;
        for (std::size_t k = 0; k < wide.size(); ++k) {
            const Region::Plane& plane = region.planes[k];
            const dvec3 size           = glm::abs(plane.normal);
            wide[k]                    = {plane.normal, 1e-14 * size + region.tilt,
                                          plane.offset + 1e-14 * std::abs(plane.offset) +
                                              (size.x + size.y + size.z + 3 * region.tilt) * region.slack};
        }
        return wide;
    }

    /// By the corner that lies farthest on each plane's inner side.
    static bool meets(const Node& node, dvec3 from, const WidePlanes& planes) {
        const dvec3 lo = dvec3(node.min) - from, hi = dvec3(node.max) - from;
        for (const WidePlane& plane : planes) {
            const dvec3 q(plane.normal.x > 0 ? hi.x : lo.x, plane.normal.y > 0 ? hi.y : lo.y,
                          plane.normal.z > 0 ? hi.z : lo.z);
            const double value = plane.normal.x * q.x + plane.normal.y * q.y + plane.normal.z * q.z;
            const double wide =
                plane.weight.x * std::abs(q.x) + plane.weight.y * std::abs(q.y) + plane.weight.z * std::abs(q.z);
            if (value + plane.offset < -wide) return false;
        }
        return true;
    }

    struct Builder;
    std::vector<Node> nodes_;
    std::vector<Item> order_;
};

}  // namespace umbra
