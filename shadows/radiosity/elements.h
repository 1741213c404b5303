// Elements: a patch cut into four, and each of these again, where a value changes over it.
//
//          c           Children 0, 1, 2 have one corner of their parent each, at the place of that corner, and two
//         / \          middles of its edges; child 3 has the three middles, each opposite to the corner of that place.
//        / 2 \         Their values are linear between the corners.
//       +-----+
//      / \ 3 / \       [Michael Cohen, Donald Greenberg, David Immel, Philip Brock, An Efficient Radiosity Approach for
//     / 0 \ / 1 \      Realistic Image Synthesis, 1986]
//    a-----+-----b
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra::patches {

class Elements {
public:
    /// Cuts the patch. `value(u, v)`: the value where u and v are the weights of the patch's second and third corner;
    /// an element is cut up to `levels` times where values at its corners, or that at the middle of an edge and the
    /// mean of its ends, differ by more than `threshold`.
    template <class Value>
    void grow(const Value& value, int levels, float threshold) {
        nodes_.assign(1, {{value(0, 0), value(1, 0), value(0, 1)}, 0});
        split(0, {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)}, value, levels, threshold);
        nodes_.shrink_to_fit();
    }

    /// The value at a place of the patch: linear between the corners of the element there, or their mean.
    [[nodiscard]] float at(double u, double v, bool linear) const {
        const auto& [a, b, c] = nodes_[descend(u, v)].value;
        if (!linear) return (a + b + c) / 3;
        const auto x = static_cast<float>(u), y = static_cast<float>(v);
        return std::clamp((1 - x - y) * a + x * b + y * c, 0.0f, 1.0f);
    }

    /// The element at a place, by a number that no other one has.
    [[nodiscard]] std::size_t leaf(double u, double v) const { return descend(u, v); }

    /// Where the corners of that element are: u and v of the patch.
    [[nodiscard]] std::array<dvec2, 3> corners(double u, double v) const {
        std::array<dvec2, 3> of_leaf{dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)};
        (void)descend(u, v, &of_leaf);
        return of_leaf;
    }

    [[nodiscard]] std::size_t leaves() const { return nodes_.size() - nodes_.size() / 4; }
    [[nodiscard]] std::size_t memory_bytes() const { return nodes_.capacity() * sizeof(Node); }

private:
    struct Node {
        std::array<float, 3> value{};
        std::uint32_t children = 0;  ///< the first of four; 0 where it is not cut
    };

    using Corners = std::array<dvec2, 3>;

    /// Opposite to each corner.
    static Corners middles(const Corners& corner) {
        return {0.5 * (corner[1] + corner[2]), 0.5 * (corner[2] + corner[0]), 0.5 * (corner[0] + corner[1])};
    }
    /// Child k's corners, or values there. `middle`: of the parent's edges, each opposite to its corner.
    template <class T>
    static std::array<T, 3> child(std::size_t k, const std::array<T, 3>& corner, const std::array<T, 3>& middle) {
        if (k == 3) return middle;
        std::array<T, 3> of_child;
        for (std::size_t i = 0; i < 3; ++i) of_child[i] = i == k ? corner[k] : middle[3 - i - k];
        return of_child;
    }

    /// The node at a place; u and v become weights of its corners, which `corners` follows.
    std::size_t descend(double& u, double& v, Corners* corners = nullptr) const {
        std::size_t node = 0;
        while (nodes_[node].children != 0) {
            const double w      = 1 - u - v;
            const std::size_t k = w >= 0.5 ? 0 : u >= 0.5 ? 1 : v >= 0.5 ? 2 : 3;
            u                   = k == 3 ? 1 - 2 * u : k == 1 ? 2 * u - 1 : 2 * u;
            v                   = k == 3 ? 1 - 2 * v : k == 2 ? 2 * v - 1 : 2 * v;
            node                = nodes_[node].children + k;
            if (corners != nullptr) *corners = child(k, *corners, middles(*corners));
        }
        return node;
    }

    template <class Value>
    void split(std::size_t node, const Corners& corner, const Value& value, int levels, float threshold) {
        if (levels == 0) return;
        const Corners middle          = middles(corner);
        const std::array<float, 3> at = nodes_[node].value,
                                   at_middle{value(middle[0].x, middle[0].y), value(middle[1].x, middle[1].y),
                                             value(middle[2].x, middle[2].y)};
        float change = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const float p = at[(k + 1) % 3], q = at[(k + 2) % 3];
            change = std::max({change, std::abs(p - q), std::abs(at_middle[k] - 0.5f * (p + q))});
        }
        if (!(change > threshold)) return;
        const std::size_t first = nodes_.size();
        nodes_[node].children   = static_cast<std::uint32_t>(first);
        for (std::size_t k = 0; k < 4; ++k) nodes_.push_back({child(k, at, at_middle), 0});
        for (std::size_t k = 0; k < 4; ++k) split(first + k, child(k, corner, middle), value, levels - 1, threshold);
    }

    std::vector<Node> nodes_;
};

}  // namespace umbra::patches
