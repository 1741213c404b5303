// The edges that a row of the sweep passes through (covering.h), from left to right.
//
//   hi ---2-----3/---    Most rows begin where an edge ends and the next one of its chain begins: that one takes over
//   lo ---1\----3----    its place and its slot, and nothing has to be sorted.
//
// This work is based on:
// Jon Bentley, Thomas Ottmann. Algorithms for Reporting and Counting Geometric Intersections. 1979
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "umbra/core/base/lanes.h"

namespace umbra::exact_visibility {

// Steps of the sweep for all edges of a row in double, several at a time. Lists are filled up to a multiple of kLanes.

/// Edges by their lower and upper ends.
struct EdgeLists {
    const double *low_x, *low_y, *width, *height, *high_x, *high_y;
};
/// x[k] becomes x of edge k at y, for k < n, exact at its upper end. The lower end lies below y; `height` is not 0.
void edges_at(const EdgeLists& edges, std::size_t n, double y, double* x);
/// The least of n values, n > 0.
[[nodiscard]] double least_of(const double* values, std::size_t n);
/// Appends those of n that end at `y` or below.
void ends_at(const double* high_y, std::size_t n, double y, std::vector<std::uint32_t>& ended);

template <class T>
struct PlanePoint {
    T x, y;
};

/// An edge of an occluder or of the light; its lower end lies below its upper one.
template <class T>
struct SweptEdge {
    PlanePoint<T> low, high;
    int step      = 0;  ///< D right of the edge less D left of it
    bool of_light = false;
    int cap       = -1;  ///< of the light: the number of the chord, or -1
    [[nodiscard]] T at(const T& y) const {
        if (y == low.y) return low.x;
        if (y == high.y) return high.x;
        return low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y));
    }
};

/// The layers and the light to the left of an edge.
struct LeftOfEdge {
    int layers;
    bool inside;  ///< the light
    template <class T>
    [[nodiscard]] LeftOfEdge past(const SweptEdge<T>& e) const {
        return {layers + e.step, inside != e.of_light};
    }
    [[nodiscard]] bool shows() const { return inside && layers == 0; }
};

template <class T>
class ActiveEdges {
public:
    using Edge = SweptEdge<T>;
    using Slot = std::uint32_t;  ///< below size(): the index of an edge's values

    void clear();
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const Edge& edge(Slot s) const { return *edge_[s]; }
    /// x at the bottom and at the top of the row.
    [[nodiscard]] const T& bottom(Slot s) const { return bottom_[s]; }
    [[nodiscard]] const T& top(Slot s) const { return top_[s]; }
    /// x between them: 0 at the bottom, 1 at the top.
    [[nodiscard]] T between(Slot s, const T& part) const { return bottom_[s] + (top_[s] - bottom_[s]) * part; }

    // A row, from the bottom to the top.

    /// It begins at y, the top of the one before: edges that end there are marked, the others go on.
    void begin_row(const T& y);
    /// An edge that begins in this row: in the place of one that ends where it begins, else at the far right. It must
    /// outlive the row.
    void begin(const Edge& edge);
    /// Removes edges that have ended and are not continued.
    void remove_ended();
    /// The least height at which one ends; size() is not 0.
    [[nodiscard]] T next_end() const;
    /// The row ends at y, and all edges there or above: they are sorted as they are just above its bottom, with `left`
    /// at the far left.
    void end_row(const T& y, LeftOfEdge left);

    /// From left to right.
    [[nodiscard]] std::span<const Slot> order() const { return order_; }
    /// The left of each edge of order(), and at the end the right of all, just above the bottom of the row.
    [[nodiscard]] std::span<const LeftOfEdge> left() const { return left_; }
    /// Places in order(): edges with visible light to their left, and edges of the light.
    [[nodiscard]] std::span<const std::uint32_t> open() const { return open_; }
    [[nodiscard]] std::span<const std::uint32_t> of_light() const { return of_light_; }

    [[nodiscard]] bool sorted_at_top();
    /// Sorts at the top of the row what is not in order there, if nothing is visible between those edges whichever
    /// comes first; the number of pairs that change their order. Else 0, and nothing is changed.
    [[nodiscard]] std::size_t cross_unseen();
    /// Sorts at the top. Calls crossed(left, right) for each pair that comes to be in the other order.
    template <class Crossed>
    void sort_at_top(const Crossed& crossed);
    /// Sorts there, as `between`; left(), open() and of_light() are as there.
    void sort_between(const T& part, LeftOfEdge left);
    /// `order` is that of all edges just above the bottom of the row.
    void restore(std::span<const Slot> order);

private:
    static constexpr bool kInLanes = std::is_same_v<T, double>;  ///< lists are filled up
    static constexpr double kNever = std::numeric_limits<double>::infinity();

    template <class Less>
    bool sort(const Less& less);
    void grow();
    void set(Slot s, const Edge& edge);
    void remove(Slot s);
    void count(LeftOfEdge left);

    Slot size_ = 0;
    std::vector<T> low_x_, low_y_, width_, height_, high_x_, high_y_, bottom_, top_, middle_;
    std::vector<const Edge*> edge_;
    std::vector<Slot> order_, ended_, before_;
    std::vector<LeftOfEdge> left_;
    std::vector<std::uint32_t> open_, of_light_;
    bool counted_  = false;  ///< left_, open_ and of_light_ are those of order_
    bool strictly_ = false;  ///< order_ was that at the top of the row before, no two at one place
};

template <class T>
void ActiveEdges<T>::clear() {
    order_.clear();
    size_    = 0;
    counted_ = strictly_ = false;
    if constexpr (kInLanes) std::fill(high_y_.begin(), high_y_.end(), kNever);
}

template <class T>
void ActiveEdges<T>::begin_row(const T& y) {
    std::swap(bottom_, top_);
    ended_.clear();
    if constexpr (kInLanes) {
        ends_at(high_y_.data(), size_, y, ended_);
    } else {
        for (Slot s = 0; s < size_; ++s)
            if (high_y_[s] <= y) ended_.push_back(s);
    }
}

template <class T>
void ActiveEdges<T>::begin(const Edge& edge) {
    for (Slot& ended : ended_)
        if (high_x_[ended] == edge.low.x) {
            const Edge& before = *edge_[ended];
            counted_           = counted_ && before.step == edge.step && before.of_light == edge.of_light;
            set(ended, edge);
            ended = ended_.back();
            ended_.pop_back();
            return;
        }
    if (size_ == low_x_.size()) grow();
    set(size_, edge);
    order_.push_back(size_++);
    counted_ = strictly_ = false;
}

template <class T>
void ActiveEdges<T>::remove_ended() {
    if (ended_.empty()) return;
    counted_ = false;
    std::sort(ended_.begin(), ended_.end());
    for (; !ended_.empty(); ended_.pop_back()) remove(ended_.back());
}

template <class T>
T ActiveEdges<T>::next_end() const {
    if constexpr (kInLanes)
        return least_of(high_y_.data(), size_);
    else
        return *std::min_element(high_y_.begin(), high_y_.begin() + size_);
}

template <class T>
void ActiveEdges<T>::end_row(const T& y, LeftOfEdge left) {
    if constexpr (kInLanes) {
        edges_at({low_x_.data(), low_y_.data(), width_.data(), height_.data(), high_x_.data(), high_y_.data()}, size_,
                 y, top_.data());
    } else {
        for (Slot s = 0; s < size_; ++s)
            top_[s] = y == high_y_[s] ? high_x_[s] : T(low_x_[s] + width_[s] * ((y - low_y_[s]) / height_[s]));
    }
    const auto at_bottom = [this](Slot a, Slot b) {
        return bottom_[a] < bottom_[b] || (bottom_[a] == bottom_[b] && top_[a] < top_[b]);
    };
    if (!strictly_ && sort(at_bottom)) counted_ = false;
    if (!counted_ || left.layers != left_.front().layers) count(left);
}

template <class T>
void ActiveEdges<T>::count(LeftOfEdge left) {
    counted_ = true;
    left_.resize(size_ + 1);
    open_.clear(), of_light_.clear();
    for (std::uint32_t k = 0; k < size_; ++k) {
        const Edge& edge = *edge_[order_[k]];
        left_[k]         = left;
        if (left.shows()) open_.push_back(k);
        if (edge.of_light) of_light_.push_back(k);
        left = left.past(edge);
    }
    left_[size_] = left;
}

template <class T>
bool ActiveEdges<T>::sorted_at_top() {
    bool sorted = true;
    strictly_   = true;
    for (std::size_t k = 1; k < order_.size(); ++k) {
        const T &left = top_[order_[k - 1]], &right = top_[order_[k]];
        sorted &= !(right < left);
        strictly_ &= left < right;
    }
    return sorted;
}

template <class T>
std::size_t ActiveEdges<T>::cross_unseen() {
    before_.assign(order_.begin(), order_.end());
    std::size_t first = order_.size(), last = 0, pairs = 0;
    for (std::size_t i = 1; i < order_.size(); ++i) {
        const Slot moved = order_[i];
        std::size_t to   = i;
        for (; to > 0 && top_[moved] < top_[order_[to - 1]]; --to) order_[to] = order_[to - 1];
        order_[to] = moved;
        if (to == i) continue;
        pairs += i - to, first = std::min(first, to), last = i;
    }
    // Layers between the first and the last of these edges are at least what they would be after all that lower them.
    int least     = left_[first].layers;
    bool of_light = false;
    for (std::size_t k = first; k <= last; ++k) {
        const Edge& edge = *edge_[order_[k]];
        least += std::min(edge.step, 0);
        of_light = of_light || edge.of_light;
    }
    if (of_light || (least <= 0 && left_[first].inside)) {
        std::swap(order_, before_);
        return 0;
    }
    for (std::size_t k = first; k < last; ++k) left_[k + 1] = left_[k].past(*edge_[order_[k]]);
    return pairs;
}

template <class T>
template <class Crossed>
void ActiveEdges<T>::sort_at_top(const Crossed& crossed) {
    for (std::size_t i = 1; i < order_.size(); ++i)
        for (std::size_t k = i; k > 0 && top_[order_[k]] < top_[order_[k - 1]]; --k) {
            crossed(order_[k - 1], order_[k]);
            std::swap(order_[k - 1], order_[k]);
        }
}

template <class T>
void ActiveEdges<T>::sort_between(const T& part, LeftOfEdge left) {
    middle_.resize(size_);
    for (Slot s = 0; s < size_; ++s) middle_[s] = between(s, part);
    sort([this](Slot a, Slot b) { return middle_[a] < middle_[b]; });
    count(left);
}

template <class T>
void ActiveEdges<T>::restore(std::span<const Slot> order) {
    order_.assign(order.begin(), order.end());
}

/// By insertion: rows differ little from the one below. Whether anything moved.
template <class T>
template <class Less>
bool ActiveEdges<T>::sort(const Less& less) {
    bool any = false;
    for (std::size_t i = 1; i < order_.size(); ++i) {
        const Slot moved = order_[i];
        std::size_t to   = i;
        for (; to > 0 && less(moved, order_[to - 1]); --to) order_[to] = order_[to - 1];
        order_[to] = moved;
        any        = any || to != i;
    }
    return any;
}

template <class T>
void ActiveEdges<T>::grow() {
    const std::size_t n = low_x_.size() + (kInLanes ? kLanes : 1);
    for (auto* list : {&low_x_, &low_y_, &width_, &high_x_, &bottom_, &top_}) list->resize(n, T(0));
    height_.resize(n, T(1));
    high_y_.resize(n, T(kInLanes ? kNever : 0));
    edge_.resize(n, nullptr);
}

template <class T>
void ActiveEdges<T>::set(Slot s, const Edge& edge) {
    low_x_[s] = edge.low.x, low_y_[s] = edge.low.y;
    width_[s] = edge.high.x - edge.low.x, height_[s] = edge.high.y - edge.low.y;
    high_x_[s] = edge.high.x, high_y_[s] = edge.high.y;
    bottom_[s] = edge.low.x;
    edge_[s]   = &edge;
}

/// The last one moves into its slot.
template <class T>
void ActiveEdges<T>::remove(Slot s) {
    const Slot last = --size_;
    order_.erase(std::find(order_.begin(), order_.end(), s));
    if (s != last) {
        for (auto* list : {&low_x_, &low_y_, &width_, &height_, &high_x_, &high_y_, &bottom_})
            (*list)[s] = (*list)[last];
        edge_[s]                                       = edge_[last];
        *std::find(order_.begin(), order_.end(), last) = s;
    }
    if constexpr (kInLanes) high_y_[last] = kNever;
}

}  // namespace umbra::exact_visibility
