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
#include <cstdint>
#include <span>
#include <type_traits>
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

template <class T>
class Covering {
public:
    struct Point {
        T x, y;
    };

    class Outline;

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
    [[nodiscard]] std::pair<double, double> uncovered(const Outline& light, int layers, std::span<ChordState> chords,
                                                      const Piece& piece);

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
        T bottom, top, middle;    ///< x in this row
        T width, height;          ///< of the edge
        std::uint32_t place = 0;  ///< in active_, see find_crossings

        explicit Active(const Edge& e)
            : edge(&e), bottom(e.low.x), top(0), middle(0), width(e.high.x - e.low.x), height(e.high.y - e.low.y) {}
        /// The edge's x at y, its lower end being below.
        [[nodiscard]] T above(const T& y) const {
            const T x = edge->low.x + width * ((y - edge->low.y) / height);
            return y == edge->high.y ? edge->high.x : x;
        }
    };

    [[nodiscard]] bool find_crossings(const T& lo, const T& hi, int layers, std::size_t& all);
    template <class Keep>
    void keep_what_shows(int layers, const Keep& keep);
    template <class X, class Gap>
    T open_width(int layers, const X& x, std::span<ChordState> chords, const Gap& gap) const;

    /// Two edges, by their places in active_: the left one comes to be the right one.
    struct Crossing {
        T y;
        std::uint32_t left, right;
    };
    /// What is left of an edge.
    struct Left {
        int layers;
        bool inside;  ///< the light
        [[nodiscard]] Left past(const Edge& e) const { return {layers + e.step, inside != e.of_light}; }
        [[nodiscard]] bool shows() const { return inside && layers == 0; }
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
    static void sort_heights(std::vector<T>& heights);
    void find_rows(const Outline& light);

    std::vector<Edge> edges_;
    std::vector<Start> starts_;
    std::vector<Entry> entries_;
    std::vector<T> begins_, ends_, both_, rows_;  ///< heights
    std::vector<T> crossings_;
    std::vector<Active> active_, by_top_;
    std::vector<Crossing> pairs_;
    std::vector<std::uint32_t> order_, place_of_;
    std::vector<Left> left_of_;
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
    std::vector<T> heights_;
};

template <class T>
void Covering<T>::Outline::assign(std::vector<LightCorner<T>> corners) {
    corners_ = std::move(corners);
    edges_.clear();
    heights_.clear();
    for (std::size_t k = 0; k < corners_.size(); ++k) {
        const LightCorner<T>&a = corners_[k], &b = corners_[(k + 1) % corners_.size()];
        if (a.y < b.y) edges_.push_back({{a.x, a.y}, {b.x, b.y}, 0, true, a.cap});
        if (b.y < a.y) edges_.push_back({{b.x, b.y}, {a.x, a.y}, 0, true, a.cap});
        heights_.push_back(a.y);
    }
    sort_starts(edges_, starts_);
    sort_heights(heights_);
}

/// Sorts by insertion: rows differ little from the one below. Calls swapped(left, right) for each swapped pair.
template <class Range, class Less, class Swapped>
void insertion_sort(Range& range, const Less& less, const Swapped& swapped) {
    for (std::size_t i = 1; i < range.size(); ++i)
        for (std::size_t k = i; k > 0 && less(range[k], range[k - 1]); --k) {
            swapped(range[k - 1], range[k]);
            std::swap(range[k - 1], range[k]);
        }
}

/// The same, where swaps are of no interest.
template <class Range, class Less>
void insertion_sort(Range& range, const Less& less) {
    const auto begin = range.begin();
    for (auto i = begin; i != range.end(); ++i) {
        auto to = i;
        while (to != begin && less(*i, *(to - 1))) --to;
        if (to != i) std::rotate(to, i, i + 1);
    }
}

/// Edges by the heights of their lower ends; of one height in the order in which they came.
template <class T>
void Covering<T>::sort_starts(const std::vector<Edge>& edges, std::vector<Start>& starts) {
    starts.clear();
    for (std::uint32_t k = 0; k < edges.size(); ++k) {
        if constexpr (std::is_same_v<T, double>)
            starts.push_back({edges[k].low.y, k});
        else
            starts.push_back({&edges[k].low.y, k});
    }
    boost::sort::pdqsort_branchless(starts.begin(), starts.end());
}

/// Each is left once.
template <class T>
void Covering<T>::sort_heights(std::vector<T>& heights) {
    if constexpr (std::is_same_v<T, double>)
        boost::sort::pdqsort_branchless(heights.begin(), heights.end());
    else
        std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
}

/// All heights at which something begins or ends; the starts are sorted.
template <class T>
void Covering<T>::find_rows(const Outline& light) {
    begins_.clear(), ends_.clear(), rows_.clear();
    for (const Edge& e : edges_) ends_.push_back(e.high.y);
    for (const Entry& e : entries_) ends_.push_back(e.y);
    sort_heights(ends_);
    for (const Start& start : starts_)
        if (const T& y = edges_[start.edge].low.y; begins_.empty() || begins_.back() < y) begins_.push_back(y);
    const auto join = [](const std::vector<T>& a, const std::vector<T>& b, std::vector<T>& to) {
        std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(to));
    };
    both_.clear();
    join(begins_, ends_, both_);
    join(both_, light.heights_, rows_);
}

/// Where edges that are in order at the bottom of the row are not at its top. False where all are. A crossing may be
/// too close to the bottom or the top to have a height of its own; the order then still changes there. `layers` is D at
/// the far left; `all` grows by the number of crossings.
template <class T>
bool Covering<T>::find_crossings(const T& lo, const T& hi, int layers, std::size_t& all) {
    crossings_.clear();
    const auto by_top = [](const Active& a, const Active& b) { return a.top < b.top; };
    if (std::is_sorted(active_.begin(), active_.end(), by_top)) return false;
    for (std::uint32_t k = 0; k < active_.size(); ++k) active_[k].place = k;
    by_top_ = active_;
    pairs_.clear();
    insertion_sort(by_top_, by_top, [&](const Active& a, const Active& b) {
        const T below = b.bottom - a.bottom, above = a.top - b.top;
        pairs_.push_back({lo + (hi - lo) * (below / (below + above)), a.place, b.place});
    });
    all += pairs_.size();
    std::sort(pairs_.begin(), pairs_.end(), [](const Crossing& a, const Crossing& b) { return a.y < b.y; });
    bool any = false;
    keep_what_shows(layers, [&](const Crossing& crossing) {
        any = true;
        if (lo < crossing.y && crossing.y < hi && (crossings_.empty() || crossings_.back() < crossing.y))
            crossings_.push_back(crossing.y);
    });
    return any;
}

/// Calls keep(crossing) for those of pairs_ at which what is visible begins, ends or changes its edge. Others, under
/// occluders or beside the light, change nothing: edges go on in the order before, and D on either side of one is not 0
/// whichever comes first. From bottom to top, so that the two are neighbours; where rounding has them in another order,
/// all from there on are kept.
template <class T>
template <class Keep>
void Covering<T>::keep_what_shows(int layers, const Keep& keep) {
    order_.clear(), place_of_.clear(), left_of_.clear();
    Left left{layers, false};
    for (std::uint32_t k = 0; k < active_.size(); ++k) {
        order_.push_back(k), place_of_.push_back(k), left_of_.push_back(left);
        left = left.past(*active_[k].edge);
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
        left_of_[k + 1] = left_of_[k].past(*active_[order_[k]].edge);
        shows           = shows || left_of_[k + 1].shows();
        if (shows) keep(crossing);
    }
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
std::pair<double, double> Covering<T>::uncovered(const Outline& light, int layers, std::span<ChordState> chords,
                                                 const Piece& piece) {
    if (light.empty()) return {0, 0};
    sort_starts(edges_, starts_);
    std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.y < b.y; });
    find_rows(light);
    const T &lowest = light.heights_.front(), &highest = light.heights_.back();

    AreaSum<T> area;
    std::size_t next = 0, next_of_light = 0, entry = 0;
    double rounded = 0;
    active_.clear();
    for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
        const T &lo = rows_[row], &hi = rows_[row + 1];
        if (!(lo < highest)) break;
        for (; entry < entries_.size() && entries_[entry].y <= lo; ++entry) layers += entries_[entry].change;
        std::erase_if(active_, [&](const Active& a) { return a.edge->high.y <= lo; });
        for (Active& a : active_) a.bottom = a.top;
        const auto begin = [&](const std::vector<Edge>& edges, const std::vector<Start>& starts, std::size_t& k) {
            for (; k < starts.size() && edges[starts[k].edge].low.y <= lo; ++k)
                active_.emplace_back(edges[starts[k].edge]);
        };
        begin(edges_, starts_, next);
        begin(light.edges_, light.starts_, next_of_light);
        for (Active& a : active_) a.top = a.above(hi);
        insertion_sort(active_, [](const Active& a, const Active& b) {
            return a.bottom < b.bottom || (a.bottom == b.bottom && a.top < b.top);
        });
        if (lo < lowest) continue;

        std::size_t edges_and_crossings = active_.size();
        const bool crossed              = find_crossings(lo, hi, layers, edges_and_crossings);
        rounded += as_double(T(hi - lo)) * static_cast<double>(edges_and_crossings);
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
            insertion_sort(active_, [](const Active& a, const Active& b) { return a.middle < b.middle; });
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
