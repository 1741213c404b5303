// How much of a convex light lies under no occluder, in the plane: a sweep over the edges where the number of layers
// that lie over the light changes.
//
// Each occluder covers a part of the plane; D(x), the number of occluders over x, changes at edges alone. An edge says
// by how much, and edges within an occluder, where nothing changes, need not be there. Wherever the corners of an
// occluder come to lie, its edges close, so that D is well defined; rounded corners move edges, but tear no holes.
//
//   hi ----\----/----   Between two heights at which an edge begins, ends or crosses another one the edges are ordered
//          1\ 0/ 1       from left to right; D is summed up along the row, and each gap in which it is 0 is a trapezoid
//   lo -----\/--------   of the visible area.
//
// This work is based on:
// Jon Bentley, Thomas Ottmann. Algorithms for Reporting and Counting Geometric Intersections. 1979
// Samuli Laine et al. Soft Shadow Volumes for Ray Tracing. 2005
#pragma once

#include <CGAL/Gmpq.h>
#include <CGAL/Gmpz.h>

#include <boost/sort/pdqsort/pdqsort.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "umbra/shadows/exact/active_edges.h"
#include "umbra/shadows/exact/whole_light.h"

namespace umbra::exact_visibility {

/// A corner of the light, anticlockwise. `cap`: the number of the chord that runs from here to the next corner, or -1.
template <class T>
struct LightCorner {
    T x, y;
    int cap = -1;
};

/// The state of the light just within a chord.
enum class ChordState : std::uint8_t { absent, hidden, visible };

/// A piece of the light between two heights; x on the left and on the right of it, below and above.
struct Trapezoid {
    double low, high;
    double low_left, low_right, high_left, high_right;
};
/// For areas alone.
struct NoPieces {
    void operator()(const Trapezoid& /*piece*/) const {}
};

/// Sums of areas. Doubles are added up; rationals are cut after 160 binary digits, since the denominators of an exact
/// sum would grow beyond measure.
template <class T>
class AreaSum {
public:
    void add(double area) { sum_ += area; }
    [[nodiscard]] double value() const { return sum_; }

private:
    double sum_ = 0;
};
template <>
class AreaSum<CGAL::Gmpq> {
public:
    void add(const CGAL::Gmpq& area) {
        const CGAL::Gmpz scaled = area.numerator() << kDigits;
        whole_ += scaled / area.denominator();
    }
    [[nodiscard]] double value() const { return CGAL::to_double(CGAL::Gmpq(whole_, CGAL::Gmpz(1) << kDigits)); }

private:
    static constexpr long kDigits = 160;
    CGAL::Gmpz whole_             = 0;
};

inline double as_double(double x) { return x; }
inline double as_double(const CGAL::Gmpq& x) { return CGAL::to_double(x); }

/// The points with x times their x, y times their y and `least` together above 0.
struct HalfPlane {
    double x, y, least;
};

template <class T>
class Covering {
public:
    using Point = PlanePoint<T>;
    class Outline;

    void clear() {
        edges_.clear();
        entries_.clear();
    }
    [[nodiscard]] bool empty() const { return edges_.empty() && entries_.empty(); }

    /// An edge from a to b, to whose left the plane is covered `change` times more than to its right. All edges are cut
    /// off at one line x = const left of the light: `a_cut`, `b_cut` say that the edge goes on beyond it.
    void add(Point a, Point b, int change, bool a_cut, bool b_cut) {
        // Just right of that line, D grows by the layers to the left of an edge that comes in, and shrinks by those to
        // the left of one that goes out.
        if (a_cut) entries_.push_back({a.y, change});
        if (b_cut) entries_.push_back({b.y, -change});
        if (a.y < b.y)
            edges_.push_back({std::move(a), std::move(b), -change});
        else if (b.y < a.y)
            edges_.push_back({std::move(b), std::move(a), change});
    }

    /// D at p, less D at the far left of the lowest row.
    [[nodiscard]] int relative_layers(const Point& p) const {
        int layers = 0;
        for (const Entry& e : entries_)
            if (e.y <= p.y) layers += e.change;
        for (const Edge& e : edges_)
            if (e.low.y <= p.y && p.y < e.high.y && e.at(p.y) < p.x) layers += e.step;
        return layers;
    }

    /// Calls body(low, high) for each edge.
    template <class Body>
    void each_edge(const Body& body) const {
        for (const Edge& e : edges_) body(e.low, e.high);
    }

    /// The area of the light where D is 0, given D at the far left of the lowest row. `chords[k]` becomes the state of
    /// the light just within chord k, and stays where the chord is not there. The second value is the sum of the rows'
    /// heights times the edges and crossings in each: doubles have an error below 16 roundings of it. (An edge's x in a
    /// row has one of a few roundings. A crossing with an error e in its height leaves two edges in the wrong order
    /// where they are that close, an area of e times their roundings.)
    /// Each uncovered part of a row goes to piece(Trapezoid), rounded.
    template <class Piece>
    [[nodiscard]] std::pair<double, double> uncovered(const Outline& light, int layers, std::span<ChordState> chords,
                                                      const Piece& piece);

    /// The same of a square or a disk, to its rim, or of its part before a line. May be asked once, and nothing after
    /// it: the edges are cut.
    template <class Shape>
    [[nodiscard]] std::pair<double, double> uncovered_of(int layers,
                                                         const std::optional<HalfPlane>& before = std::nullopt);

private:
    using Edge = SweptEdge<T>;
    using Slot = typename ActiveEdges<T>::Slot;
    struct Entry {
        T y;
        int change;
    };

    [[nodiscard]] bool find_crossings(const T& lo, const T& hi, std::size_t& all);
    template <class Keep>
    void keep_what_shows(LeftOfEdge left, const Keep& keep);
    template <class X, class Gap>
    T open_width(const X& x, const Gap& gap) const;
    /// Bottom and top of the row that is swept.
    struct Row {
        const T &lo, &hi;
    };
    [[nodiscard]] T x_at(const Row& row, Slot s, const T& y) const {
        if (y == row.lo) return active_.bottom(s);
        return y == row.hi ? active_.top(s) : active_.between(s, (y - row.lo) / (row.hi - row.lo));
    }
    template <class Add>
    double sweep(const std::vector<Edge>& edges, const Outline* light, LeftOfEdge at_left, const T& lowest,
                 const T& highest, const Add& add);
    /// `goes_on`: both ends do, as of an edge that is part of a line.
    template <class Shape>
    void cut_at_rim(const Edge& edge, bool goes_on = false);
    template <class Shape>
    [[nodiscard]] int cover_behind(const HalfPlane& before);
    void mark_chords(std::span<ChordState> chords) const;

    /// The left one comes to be the right one.
    struct Crossing {
        T y;
        Slot left, right;
    };

    /// The lower end of an edge, by its number. Doubles are copied, so that they are sorted fast.
    struct Start {
        std::conditional_t<std::is_same_v<T, double>, double, const T*> y;
        std::uint32_t edge;
        friend bool operator<(const Start& a, const Start& b) {
            if constexpr (std::is_same_v<T, double>)
                return (a.y < b.y) | ((a.y == b.y) & (a.edge < b.edge));  // no jumps
            else
                return *a.y < *b.y || (*a.y == *b.y && a.edge < b.edge);
        }
    };
    static void sort_starts(const std::vector<Edge>& edges, std::vector<Start>& starts);
    static void sort_many_starts(const std::vector<Edge>& edges, std::vector<Start>& starts);
    static constexpr std::size_t kManyStarts = 48;

    std::vector<Edge> edges_;
    std::vector<Edge> inside_;  ///< their parts within the light's rim
    std::vector<Start> starts_;
    std::vector<Entry> entries_;
    ActiveEdges<T> active_;
    std::vector<Crossing> pairs_;
    std::vector<T> crossings_;             ///< heights
    std::vector<Slot> at_bottom_, order_;  ///< from left to right
    std::vector<std::uint32_t> place_of_;
    std::vector<LeftOfEdge> left_of_;
};

/// A convex light that is swept, perhaps many times.
template <class T>
class Covering<T>::Outline {
public:
    Outline() = default;
    explicit Outline(std::vector<LightCorner<T>> corners) { assign(std::move(corners)); }
    void assign(std::vector<LightCorner<T>> corners);

    [[nodiscard]] const std::vector<LightCorner<T>>& corners() const { return corners_; }
    [[nodiscard]] bool empty() const { return corners_.size() < 3; }

private:
    friend class Covering;
    std::vector<LightCorner<T>> corners_;
    std::vector<Edge> edges_;
    std::vector<Start> starts_;
    T lowest_{}, highest_{};
};

template <class T>
void Covering<T>::Outline::assign(std::vector<LightCorner<T>> corners) {
    corners_ = std::move(corners);
    edges_.clear();
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const LightCorner<T>&a = corners_[k], &b = corners_[(k + 1) % corners_.size()];
        if (a.y < b.y) edges_.push_back({{a.x, a.y}, {b.x, b.y}, 0, true, a.cap});
        if (b.y < a.y) edges_.push_back({{b.x, b.y}, {a.x, a.y}, 0, true, a.cap});
        if (k == 0 || a.y < lowest_) lowest_ = a.y;
        if (k == 0 || highest_ < a.y) highest_ = a.y;
    }
    sort_starts(edges_, starts_);
}

/// Edges by the heights of their lower ends; of one height in the order in which they came.
template <class T>
void Covering<T>::sort_starts(const std::vector<Edge>& edges, std::vector<Start>& starts) {
    starts.clear();
    if constexpr (std::is_same_v<T, double>) {
        if (edges.size() > kManyStarts) {
            sort_many_starts(edges, starts);
            return;
        }
    }
    for (std::uint32_t k = 0; k < edges.size(); ++k) {
        if constexpr (std::is_same_v<T, double>)
            starts.push_back({edges[k].low.y, k});
        else
            starts.push_back({&edges[k].low.y, k});
    }
    boost::sort::pdqsort_branchless(starts.begin(), starts.end());
}

/// The same: into drawers by height first, which leaves little to be put in order.
template <class T>
void Covering<T>::sort_many_starts(const std::vector<Edge>& edges, std::vector<Start>& starts) {
    constexpr std::size_t kDrawers = 256;  // from -1.125 to 1.125: edges are cut around the light
    const auto drawer              = [](const Edge& edge) {
        return static_cast<std::size_t>(std::clamp((edge.low.y + 1.125) * (kDrawers / 2.25), 0.0, kDrawers - 1.0));
    };
    std::array<std::uint32_t, kDrawers + 1> begin{};
    for (const Edge& edge : edges) ++begin[drawer(edge) + 1];
    for (std::size_t k = 0; k < kDrawers; ++k) begin[k + 1] += begin[k];
    starts.resize(edges.size());
    for (std::uint32_t k = 0; k < edges.size(); ++k) starts[begin[drawer(edges[k])]++] = {edges[k].low.y, k};
    for (std::size_t i = 1, moves = 0; i < starts.size(); ++i) {
        const Start moved = starts[i];
        std::size_t to    = i;
        for (; to > 0 && moved < starts[to - 1]; --to) starts[to] = starts[to - 1];
        starts[to] = moved;
        moves += i - to;
        if (moves > 16 * starts.size()) {  // too many in one drawer
            boost::sort::pdqsort_branchless(starts.begin(), starts.end());
            return;
        }
    }
}

/// Where edges that are in order at the bottom of the row are not at its top, and it shows. False where it does
/// nowhere. A crossing may be too close to the bottom or the top to have a height of its own; the order then still
/// changes there. `all` grows by the number of crossings.
template <class T>
bool Covering<T>::find_crossings(const T& lo, const T& hi, std::size_t& all) {
    if (active_.sorted_at_top()) return false;
    if (const std::size_t unseen = active_.cross_unseen(); unseen > 0) {
        all += unseen;
        return false;
    }
    const LeftOfEdge at_left = active_.left().front();
    at_bottom_.assign(active_.order().begin(), active_.order().end());
    crossings_.clear();
    pairs_.clear();
    active_.sort_at_top([&](Slot a, Slot b) {
        const T below = active_.bottom(b) - active_.bottom(a), above = active_.top(a) - active_.top(b);
        pairs_.push_back({lo + (hi - lo) * (below / (below + above)), a, b});
    });
    all += pairs_.size();
    std::sort(pairs_.begin(), pairs_.end(), [](const Crossing& a, const Crossing& b) { return a.y < b.y; });
    active_.restore(at_bottom_);
    bool any = false;
    keep_what_shows(at_left, [&](const Crossing& crossing) {
        any = true;
        if (lo < crossing.y && crossing.y < hi && (crossings_.empty() || crossings_.back() < crossing.y))
            crossings_.push_back(crossing.y);
    });
    return any;
}

/// Calls keep(crossing) for those of pairs_ at which visible light begins, ends or changes its edge. Others, under
/// occluders or beside the light, change nothing: edges go on in the order before, and D on either side of one is not 0
/// whichever comes first. From bottom to top, so that the two are neighbours; where rounding has them in another order,
/// all from there on are kept.
template <class T>
template <class Keep>
void Covering<T>::keep_what_shows(LeftOfEdge left, const Keep& keep) {
    order_ = at_bottom_;
    place_of_.resize(order_.size());
    left_of_.clear();
    for (std::uint32_t k = 0; k < order_.size(); ++k) {
        place_of_[order_[k]] = k;
        left_of_.push_back(left);
        left = left.past(active_.edge(order_[k]));
    }
    left_of_.push_back(left);
    bool in_order = true;
    for (const Crossing& crossing : pairs_) {
        const std::uint32_t k = place_of_[crossing.left];
        in_order              = in_order && place_of_[crossing.right] == k + 1;
        if (!in_order) {
            keep(crossing);
            continue;
        }
        bool shows = left_of_[k].shows() || left_of_[k + 1].shows() || left_of_[k + 2].shows();
        std::swap(order_[k], order_[k + 1]);
        place_of_[crossing.left] = k + 1, place_of_[crossing.right] = k;
        left_of_[k + 1] = left_of_[k].past(active_.edge(order_[k]));
        shows           = shows || left_of_[k + 1].shows();
        if (shows) keep(crossing);
    }
}

/// Marks the chords among the active edges as visible or hidden.
template <class T>
void Covering<T>::mark_chords(std::span<ChordState> chords) const {
    for (const std::uint32_t k : active_.of_light())
        if (const int cap = active_.edge(active_.order()[k]).cap; cap >= 0)
            chords[static_cast<std::size_t>(cap)] =
                active_.left()[k].layers == 0 ? ChordState::visible : ChordState::hidden;
}

/// Width of the light in a row where D is 0. `x` gives the position of an edge. Calls gap(left, right) for each pair of
/// edges between which that is.
template <class T>
template <class X, class Gap>
T Covering<T>::open_width(const X& x, const Gap& gap) const {
    T width = 0;
    for (const std::uint32_t k : active_.open()) {
        const Slot left = active_.order()[k - 1], right = active_.order()[k];
        width += x(right) - x(left);
        gap(left, right);
    }
    return width;
}

/// Sweeps `edges` between the heights `lowest` and `highest`, with the edges of a light, if any. `at_left`: at the far
/// left of the lowest row. For each row, or for each part of one between crossings that show, active_ is sorted and
/// counted, and add(row, from, to, middle) is called; `middle` is where between the bottom and the top of the row, or
/// nothing for a whole row. The sum of the rows' heights times the edges and crossings in each.
template <class T>
template <class Add>
double Covering<T>::sweep(const std::vector<Edge>& edges, const Outline* light, LeftOfEdge at_left, const T& lowest,
                          const T& highest, const Add& add) {
    sort_starts(edges, starts_);
    std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.y < b.y; });

    std::size_t next = 0, next_of_light = 0, entry = 0;
    double rounded = 0;
    active_.clear();
    const auto begin = [](const std::vector<Edge>& from, const std::vector<Start>& starts, std::size_t k) {
        return k < starts.size() ? &from[starts[k].edge] : nullptr;
    };
    const auto next_edge   = [&] { return begin(edges, starts_, next); };
    const auto next_of_rim = [&] { return light ? begin(light->edges_, light->starts_, next_of_light) : nullptr; };
    // Where something begins or ends next, above the height y.
    const auto height_above = [&](const T& y) {
        T least         = y < lowest ? lowest : highest;
        const auto take = [&](const T& other) {
            if (other < least) least = other;
        };
        if (active_.size() > 0) take(active_.next_end());
        if (const Edge* edge = next_edge()) take(edge->low.y);
        if (const Edge* edge = next_of_rim()) take(edge->low.y);
        if (entry < entries_.size()) take(entries_[entry].y);
        return least;
    };
    const T below = lowest - T(1);
    for (T lo = height_above(below), hi; lo < highest; lo = hi) {
        for (; entry < entries_.size() && entries_[entry].y <= lo; ++entry) at_left.layers += entries_[entry].change;
        active_.begin_row(lo);
        for (const Edge* edge; (edge = next_edge()) && edge->low.y <= lo; ++next) active_.begin(*edge);
        for (const Edge* edge; (edge = next_of_rim()) && edge->low.y <= lo; ++next_of_light) active_.begin(*edge);
        active_.remove_ended();
        hi = height_above(lo);
        active_.end_row(hi, at_left);
        if (lo < lowest) continue;

        std::size_t edges_and_crossings = active_.size();
        const bool crossed              = find_crossings(lo, hi, edges_and_crossings);
        rounded += as_double(T(hi - lo)) * static_cast<double>(edges_and_crossings);
        if (!crossed) {
            add(Row{lo, hi}, lo, hi, nullptr);
            continue;
        }
        crossings_.push_back(hi);
        T from = lo;
        for (const T& to : crossings_) {
            const T middle = ((from + to) / T(2) - lo) / (hi - lo);
            active_.sort_between(middle, at_left);
            add(Row{lo, hi}, from, to, &middle);
            from = to;
        }
    }
    return rounded;
}

template <class T>
template <class Piece>
std::pair<double, double> Covering<T>::uncovered(const Outline& light, int layers, std::span<ChordState> chords,
                                                 const Piece& piece) {
    if (light.empty()) return {0, 0};
    AreaSum<T> area;
    const auto add = [&](const Row& row, const T& from, const T& to, const T* middle) {
        mark_chords(chords);
        const auto gap = [&](Slot left, Slot right) {
            if constexpr (!std::is_same_v<Piece, NoPieces>) {
                const auto x = [&](Slot s, const T& y) { return as_double(x_at(row, s, y)); };
                piece(Trapezoid{as_double(from), as_double(to), x(left, from), x(right, from), x(left, to),
                                x(right, to)});
            }
        };
        if (middle)
            area.add(T((to - from) * open_width([&](Slot s) { return active_.between(s, *middle); }, gap)));
        else
            area.add(T((to - from) * open_width([this](Slot s) { return T(active_.bottom(s) + active_.top(s)); }, gap) /
                       T(2)));
    };
    const double rounded = sweep(edges_, &light, {layers, false}, light.lowest_, light.highest_, add);
    return {area.value(), rounded};
}

/// Cuts an edge at the rim of the light: the part within goes to inside_, that left of the light to entries_.
template <class T>
template <class Shape>
void Covering<T>::cut_at_rim(const Edge& edge, bool goes_on) {
    const PartWithin part = Shape::within(edge.low, edge.high);
    const auto at         = [&](double t) -> Point {
        if (t <= 0) return edge.low;
        if (t >= 1) return edge.high;
        return {edge.low.x + t * (edge.high.x - edge.low.x), edge.low.y + t * (edge.high.y - edge.low.y)};
    };
    const auto beside = [&](double from_t, double to_t) {
        const Point low = at(from_t), high = at(to_t);
        const double from = std::max(low.y, -1.0), to = std::min(high.y, 1.0);
        if (!(from < to) && !goes_on) return;
        const double middle = from < to ? low.x + (high.x - low.x) * (((from + to) / 2 - low.y) / (high.y - low.y))
                                        : (low.x + high.x) / 2;
        if (!(middle < 0)) return;
        entries_.push_back({goes_on && from_t <= 0 ? -2 : low.y, edge.step});
        entries_.push_back({goes_on && to_t >= 1 ? 2 : high.y, -edge.step});
    };
    if (part.empty()) {
        beside(0, 1);
        return;
    }
    if (part.from > 0) beside(0, part.from);
    if (part.to < 1) beside(part.to, 1);
    const Point low = at(part.from), high = at(part.to);
    if (low.y < high.y) inside_.push_back({low, high, edge.step});
}

/// Covers all that is not before a line once more; by how much D grows at the far left of the lowest row.
template <class T>
template <class Shape>
int Covering<T>::cover_behind(const HalfPlane& before) {
    const double slope = std::hypot(before.x, before.y), distance = -before.least / slope;
    constexpr double kBeyond = 1.5;  // of all shapes
    if (!(slope > 0) || std::abs(distance) > kBeyond) return before.least < 0 ? 1 : 0;
    const double nx = before.x / slope, ny = before.y / slope;
    // The foot of the centre on the line, and so far along it that it passes all shapes.
    const Point foot{distance * nx, distance * ny};
    const Point one{foot.x + 4 * ny, foot.y - 4 * nx}, other{foot.x - 4 * ny, foot.y + 4 * nx};
    if (one.y == other.y) {
        entries_.push_back({foot.y, ny > 0 ? -1 : 1});
        return ny > 0 ? 1 : 0;
    }
    // Covered where nx x + ny y < distance: to the left where nx > 0.
    if (nx > 0)
        cut_at_rim<Shape>({one, other, -1}, true);
    else
        cut_at_rim<Shape>({other, one, 1}, true);
    return nx > 0 ? 1 : 0;
}

template <class T>
template <class Shape>
std::pair<double, double> Covering<T>::uncovered_of(int layers, const std::optional<HalfPlane>& before) {
    inside_.clear();
    for (const Edge& edge : edges_) cut_at_rim<Shape>(edge);
    if (before) layers += cover_behind<Shape>(*before);
    double area      = 0;
    std::size_t rows = 0;
    const auto add   = [&](const Row& /*row*/, double from, double to, const double* middle) {
        const auto order = active_.order();
        const auto twice = [&](std::size_t k) {
            return middle ? 2 * active_.between(order[k], *middle) : active_.bottom(order[k]) + active_.top(order[k]);
        };
        ++rows;
        double width = 0, rims = 0;  // twice the width between x = 0 and edges, and half areas
        for (const std::uint32_t k : active_.open()) {
            width += twice(k);
            if (k > 0)
                width -= twice(k - 1);
            else
                rims += 1;
        }
        if (active_.left().back().shows()) {
            if (!order.empty()) width -= twice(order.size() - 1);
            rims += 1;
        }
        if (order.empty()) rims *= 2;
        area += (to - from) * width / 2;
        if (rims > 0) area += rims * Shape::half_area(from, to);
    };
    const double rounded = sweep(inside_, nullptr, {layers, true}, -1, 1, add);
    // A rim's integral is off by its roundings in each row, a cut end by its own across an edge no longer than 3.
    return {area, rounded + static_cast<double>(rows + inside_.size())};
}

}  // namespace umbra::exact_visibility
