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

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace umbra::exact_detail {

/// A corner of the light, anticlockwise. `cap`: the number of the chord that runs from here to the next corner, or -1.
template <class T>
struct LightCorner {
    T x, y;
    int cap = -1;
};

/// What is known of the light just within a chord.
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
class AreaSum {
public:
    void add(double area) { sum_ += area; }
    void add(const CGAL::Gmpq& area) {
        const CGAL::Gmpz scaled = area.numerator() << kDigits;
        whole_ += scaled / area.denominator();
    }
    [[nodiscard]] double value() const { return sum_ + CGAL::to_double(CGAL::Gmpq(whole_, CGAL::Gmpz(1) << kDigits)); }

private:
    static constexpr long kDigits = 160;
    double sum_                   = 0;
    CGAL::Gmpz whole_             = 0;
};

inline double as_double(double x) { return x; }
inline double as_double(const CGAL::Gmpq& x) { return CGAL::to_double(x); }

template <class T>
class Covering {
public:
    struct Point {
        T x, y;
    };

    void clear() {
        edges_.clear();
        entries_.clear();
    }
    [[nodiscard]] bool empty() const { return edges_.empty() && entries_.empty(); }

    /// An edge from a to b, to whose left the plane is covered `change` times more than to its right. All edges are cut
    /// off at one line x = const left of the light: `a_cut`, `b_cut` say that the edge goes on beyond it.
    void add(Point a, Point b, int change, bool a_cut, bool b_cut) {
        // Just right of that line, D grows by what lies to the left of an edge that comes in, and shrinks by what lies
        // to the left of one that goes out.
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

    /// The area of the light where D is 0, given D at the far left of the lowest row. `chords[k]` becomes what the
    /// light just within chord k is, and stays where the chord is not there. The second value
    /// is the sum of the rows' heights times the edges and crossings in each: doubles are off by less than 16 roundings
    /// of it. (An edge's x in a row is off by a few roundings. A crossing whose height is off by e leaves two edges in
    /// the wrong order where they are that close, an area of e times their roundings.)
    /// Each uncovered part of a row goes to piece(Trapezoid), rounded.
    template <class Piece>
    [[nodiscard]] std::pair<double, double> uncovered(const std::vector<LightCorner<T>>& light, int layers,
                                                      std::span<ChordState> chords, const Piece& piece);

private:
    struct Edge {
        Point low, high;
        int step      = 0;  ///< D right of the edge less D left of it
        bool of_light = false;
        int cap       = -1;
        [[nodiscard]] T at(const T& y) const {
            if (y == low.y) return low.x;
            if (y == high.y) return high.x;
            return low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y));
        }
    };
    struct Entry {
        T y;
        int change;
    };
    struct Active {
        const Edge* edge;
        T bottom, top, middle;  ///< x in this row
    };

    [[nodiscard]] bool find_crossings(const T& lo, const T& hi);
    template <class X, class Gap>
    T open_width(int layers, const X& x, std::span<ChordState> chords, const Gap& gap) const;

    std::vector<Edge> edges_, all_;
    std::vector<Entry> entries_;
    std::vector<T> heights_, crossings_;
    std::vector<Active> active_, by_top_;
};

/// Sorts by insertion: rows differ little from the one below. Calls swapped(left, right) for each swapped pair.
template <class Range, class Less, class Swapped>
void insertion_sort(Range& range, const Less& less, const Swapped& swapped) {
    for (std::size_t i = 1; i < range.size(); ++i)
        for (std::size_t k = i; k > 0 && less(range[k], range[k - 1]); --k) {
            swapped(range[k - 1], range[k]);
            std::swap(range[k - 1], range[k]);
        }
}

/// Where edges that are in order at the bottom of the row are not at its top. False where all are. A crossing may be
/// too close to the bottom or the top to have a height of its own; the order then still changes there.
template <class T>
bool Covering<T>::find_crossings(const T& lo, const T& hi) {
    crossings_.clear();
    bool any = false;
    by_top_  = active_;
    insertion_sort(
        by_top_, [](const Active& a, const Active& b) { return a.top < b.top; },
        [&](const Active& a, const Active& b) {
            const T below = b.bottom - a.bottom, above = a.top - b.top;
            const T y = lo + (hi - lo) * (below / (below + above));
            if (lo < y && y < hi) crossings_.push_back(y);
            any = true;
        });
    std::sort(crossings_.begin(), crossings_.end());
    crossings_.erase(std::unique(crossings_.begin(), crossings_.end()), crossings_.end());
    return any;
}

/// Width of the light in a row where D is 0. `x` gives the position of an edge; edges are in order. Calls gap(left,
/// right) for each pair of edges between which that is.
template <class T>
template <class X, class Gap>
T Covering<T>::open_width(int layers, const X& x, std::span<ChordState> chords, const Gap& gap) const {
    T width     = 0;
    bool inside = false;
    for (std::size_t k = 0; k < active_.size(); ++k) {
        const Edge& edge = *active_[k].edge;
        if (inside && layers == 0) {
            width += x(active_[k]) - x(active_[k - 1]);
            gap(active_[k - 1], active_[k]);
        }
        if (edge.of_light) {
            inside = !inside;
            if (edge.cap >= 0)
                chords[static_cast<std::size_t>(edge.cap)] = layers == 0 ? ChordState::visible : ChordState::hidden;
        } else {
            layers += edge.step;
        }
    }
    return width;
}

template <class T>
template <class Piece>
std::pair<double, double> Covering<T>::uncovered(const std::vector<LightCorner<T>>& light, int layers,
                                                 std::span<ChordState> chords, const Piece& piece) {
    all_ = edges_;
    for (std::size_t k = 0; k < light.size(); ++k) {
        const LightCorner<T>&a = light[k], &b = light[(k + 1) % light.size()];
        if (a.y < b.y) all_.push_back({{a.x, a.y}, {b.x, b.y}, 0, true, a.cap});
        if (b.y < a.y) all_.push_back({{b.x, b.y}, {a.x, a.y}, 0, true, a.cap});
    }
    std::stable_sort(all_.begin(), all_.end(), [](const Edge& a, const Edge& b) { return a.low.y < b.low.y; });
    std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.y < b.y; });
    const auto by_height         = [](const LightCorner<T>& a, const LightCorner<T>& b) { return a.y < b.y; };
    const auto [lowest, highest] = std::minmax_element(light.begin(), light.end(), by_height);

    heights_.clear();
    for (const Edge& e : all_) {
        heights_.push_back(e.low.y);
        heights_.push_back(e.high.y);
    }
    for (const Entry& e : entries_) heights_.push_back(e.y);
    std::sort(heights_.begin(), heights_.end());
    heights_.erase(std::unique(heights_.begin(), heights_.end()), heights_.end());

    AreaSum area;
    std::size_t next = 0, entry = 0;
    double rounded = 0;
    active_.clear();
    for (std::size_t row = 0; row + 1 < heights_.size(); ++row) {
        const T &lo = heights_[row], &hi = heights_[row + 1];
        if (!(lo < highest->y)) break;
        for (; entry < entries_.size() && entries_[entry].y <= lo; ++entry) layers += entries_[entry].change;
        std::erase_if(active_, [&](const Active& a) { return a.edge->high.y <= lo; });
        for (Active& a : active_) a.bottom = a.top;
        for (; next < all_.size() && all_[next].low.y <= lo; ++next)
            active_.push_back({&all_[next], all_[next].low.x, T(0), T(0)});
        for (Active& a : active_) a.top = a.edge->at(hi);
        insertion_sort(
            active_,
            [](const Active& a, const Active& b) {
                return a.bottom < b.bottom || (a.bottom == b.bottom && a.top < b.top);
            },
            [](const Active&, const Active&) {});
        if (lo < lowest->y) continue;

        const bool crossed = find_crossings(lo, hi);
        rounded += as_double(T(hi - lo)) * static_cast<double>(active_.size() + crossings_.size());
        if (!crossed) {
            const T twice = open_width(
                layers, [](const Active& a) { return T(a.bottom + a.top); }, chords,
                [&](const Active& left, const Active& right) {
                    if constexpr (!std::is_same_v<Piece, NoPieces>)
                        piece(Trapezoid{as_double(lo), as_double(hi), as_double(left.bottom), as_double(right.bottom),
                                        as_double(left.top), as_double(right.top)});
                });
            area.add(T((hi - lo) * twice / T(2)));
            continue;
        }
        crossings_.push_back(hi);
        T from = lo;
        for (const T& to : crossings_) {
            const T middle = ((from + to) / T(2) - lo) / (hi - lo);
            for (Active& a : active_) a.middle = a.bottom + (a.top - a.bottom) * middle;
            insertion_sort(
                active_, [](const Active& a, const Active& b) { return a.middle < b.middle; },
                [](const Active&, const Active&) {});
            const auto x_at = [&](const Active& a, const T& y) {
                return as_double(T(a.bottom + (a.top - a.bottom) * ((y - lo) / (hi - lo))));
            };
            area.add(T((to - from) * open_width(
                                         layers, [](const Active& a) { return a.middle; }, chords,
                                         [&](const Active& left, const Active& right) {
                                             if constexpr (!std::is_same_v<Piece, NoPieces>)
                                                 piece(Trapezoid{as_double(from), as_double(to), x_at(left, from),
                                                                 x_at(right, from), x_at(left, to), x_at(right, to)});
                                         })));
            from = to;
        }
    }
    return {area.value(), rounded};
}

}  // namespace umbra::exact_detail
