// A bounding volume hierarchy over triangles that never loses one: for exact questions, so apart from Embree.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/scene.h"

namespace umbra {

/// Binary tree of axis-aligned boxes, split by binned surface area.
/// [Ingo Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007]
class TriangleTree {
public:
    explicit TriangleTree(const Scene& scene);

    /// A piece of a line: from + s direction, 0 <= s <= length (which may be infinite). `slack` is how far the true
    /// piece may lie from this one, in every coordinate.
    struct Piece {
        dvec3 from{0}, direction{0, 1, 0};
        double length = 1;
        double slack  = 0;
    };

    /// Calls visit(triangle) for every triangle whose box the piece may meet, until visit returns false. Conservative:
    /// the boxes are widened by more than the rounding of the test.
    template <class Visit>
    void visit(const Piece& piece, const Visit& visit) const {
        if (nodes_.empty()) return;
        const dvec3 inverse = 1.0 / piece.direction;  // infinite where a component is 0: the test below copes
        std::uint32_t stack[64];
        int depth      = 0;
        stack[depth++] = 0;
        while (depth > 0) {
            const Node& node = nodes_[stack[--depth]];
            if (!meets(node, piece, inverse)) continue;
            if (node.count > 0) {
                for (std::uint32_t k = 0; k < node.count; ++k)
                    if (!visit(order_[node.first + k])) return;
            } else {
                stack[depth++] = node.first;
                stack[depth++] = node.first + 1;
            }
        }
    }

    [[nodiscard]] std::size_t memory_bytes() const {
        return nodes_.size() * sizeof(Node) + order_.size() * sizeof(TriangleId);
    }

private:
    struct Node {
        vec3 min{0}, max{0};
        std::uint32_t first = 0;  ///< leaf: index into order_; inner: index of two neighbouring nodes
        std::uint32_t count = 0;  ///< 0: inner
    };

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

    struct Builder;
    std::vector<Node> nodes_;
    std::vector<TriangleId> order_;
};

}  // namespace umbra
