// The pieces and the receiver's border form an arrangement. The number of triangles over a face follows from that over
// its neighbour and the change of the edge between them; faces that no triangle covers are lit.
//
// This work is based on:
// Kevin Weiler, Peter Atherton. Hidden Surface Removal Using Polygon Area Sorting. 1977
// Ron Wein, Eric Berberich, Efi Fogel, Dan Halperin, Michael Hemmer, Oren Salzman, Baruch Zukerman. 2D Arrangements.
// CGAL
#include "umbra/shadows/atherton/lit_part.h"

#include <CGAL/Arr_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arr_walk_along_line_point_location.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

namespace umbra::atherton {
namespace {

using Kernel   = CGAL::Exact_predicates_exact_constructions_kernel;
using Segments = CGAL::Arr_segment_traits_2<Kernel>;
using Traits   = CGAL::Arr_curve_data_traits_2<Segments, int, std::plus<int>>;  // changes of edges that coincide add up
using Arrangement = CGAL::Arrangement_2<Traits, CGAL::Arr_face_extended_dcel<Traits, int>>;
using Curve       = Traits::X_monotone_curve_2;
using FaceHandle  = Arrangement::Face_handle;

constexpr int kUnknown = std::numeric_limits<int>::min();

Kernel::Point_2 point(const std::array<Exact, 2>& p) { return {Kernel::FT(p[0]), Kernel::FT(p[1])}; }

/// With its change as seen along the curve from its lexicographically smaller end.
Curve curve(const std::array<Exact, 2>& from, const std::array<Exact, 2>& to, int change) {
    return {Segments::X_monotone_curve_2(point(from), point(to)), from < to ? change : -change};
}

std::vector<Curve> curves(const std::vector<OutlinePiece>& pieces) {
    const std::array<Exact, 2> a{0, 0}, b{1, 0}, c{0, 1};
    std::vector<Curve> all{curve(a, b, 0), curve(b, c, 0), curve(c, a, 0)};
    for (const OutlinePiece& piece : pieces) all.push_back(curve(piece.from, piece.to, piece.change));
    return all;
}

template <class Visit>
void visit_border(FaceHandle face, const Visit& visit) {
    const auto around = [&](Arrangement::Ccb_halfedge_circulator first) {
        auto edge = first;
        do visit(edge);
        while (++edge != first);
    };
    if (face->has_outer_ccb()) around(face->outer_ccb());
    for (auto hole = face->inner_ccbs_begin(); hole != face->inner_ccbs_end(); ++hole) around(*hole);
}

/// Writes into each bounded face how many triangles cover it.
void count_covers(Arrangement& plane, float u, float v, int covers) {
    for (auto face = plane.faces_begin(); face != plane.faces_end(); ++face) face->set_data(kUnknown);
    const CGAL::Arr_walk_along_line_point_location<Arrangement> location(plane);
    const CGAL::Object found = location.locate(Kernel::Point_2(u, v));  // of whichever variant this CGAL has
    const auto* start        = CGAL::object_cast<Arrangement::Face_const_handle>(&found);
    if (start == nullptr) throw std::logic_error("a receiver's point lies on an outline");
    std::vector<FaceHandle> open{plane.non_const_handle(*start)};
    open.back()->set_data(covers);
    while (!open.empty()) {
        const FaceHandle face = open.back();
        open.pop_back();
        visit_border(face, [&](Arrangement::Halfedge_handle edge) {
            const FaceHandle next = edge->twin()->face();
            if (next->is_unbounded()) return;
            // Its own face is to the left of a halfedge: above it where the halfedge runs from left to right.
            const int change =
                edge->direction() == CGAL::ARR_LEFT_TO_RIGHT ? edge->curve().data() : -edge->curve().data();
            const int there = face->data() - change;
            if (there < 0 || (next->data() != kUnknown && next->data() != there))
                throw std::logic_error("the numbers of triangles over a receiver contradict one another");
            if (next->data() == kUnknown) {
                next->set_data(there);
                open.push_back(next);
            }
        });
    }
}

/// Removes all edges but those of lit polygons; faces are then 1 where lit, else 0.
void keep_lit(Arrangement& plane) {
    for (auto face = plane.faces_begin(); face != plane.faces_end(); ++face)
        face->set_data(!face->is_unbounded() && face->data() == 0 ? 1 : 0);
    std::vector<Arrangement::Halfedge_handle> needless;
    for (auto edge = plane.edges_begin(); edge != plane.edges_end(); ++edge)
        if (edge->face()->data() == edge->twin()->face()->data()) needless.push_back(edge);
    for (const auto edge : needless) plane.remove_edge(edge);
}

std::array<Exact, 2> coordinates(const Kernel::Point_2& p) { return {p.x().exact(), p.y().exact()}; }
dvec2 rounded(const std::array<Exact, 2>& p) { return {CGAL::to_double(p[0]), CGAL::to_double(p[1])}; }

bool on_border(const std::array<Exact, 2>& a, const std::array<Exact, 2>& b) {
    return (a[0] == 0 && b[0] == 0) || (a[1] == 0 && b[1] == 0) || (a[0] + a[1] == 1 && b[0] + b[1] == 1);
}

/// Sign of a number near `quick`, with an error of at most `error`; `exact` decides the rest.
template <class ExactValue>
int sign(double quick, double error, const ExactValue& exact) {
    if (std::abs(quick) > error) return quick > 0 ? 1 : -1;
    return static_cast<int>(CGAL::sign(exact()));
}

constexpr std::size_t kDigits = 128;      ///< bytes of a rational's numerator and denominator, as they usually are
constexpr double kRounded     = 0x1p-52;  ///< how far a rounded coordinate, in [0, 1], may be off, with room to spare

}  // namespace

LitPart::LitPart(const std::vector<OutlinePiece>& pieces, float u, float v, int covers) {
    Arrangement plane;
    const std::vector<Curve> all = curves(pieces);
    CGAL::insert(plane, all.begin(), all.end());
    count_covers(plane, u, v, covers);
    keep_lit(plane);
    for (auto edge = plane.edges_begin(); edge != plane.edges_end(); ++edge)
        add_edge(coordinates(edge->source()->point()), coordinates(edge->target()->point()));
    for (auto face = plane.faces_begin(); face != plane.faces_end(); ++face) {
        if (face->data() != 1) continue;
        const auto add_loop = [&](Arrangement::Ccb_halfedge_circulator first) {
            loops_.emplace_back();
            auto edge = first;
            do loops_.back().push_back(rounded(coordinates(edge->source()->point())));
            while (++edge != first);
        };
        add_loop(face->outer_ccb());
        for (auto hole = face->inner_ccbs_begin(); hole != face->inner_ccbs_end(); ++hole) add_loop(*hole);
    }
    sort_into_rows();
}

void LitPart::add_edge(const std::array<Exact, 2>& a, const std::array<Exact, 2>& b) {
    const bool border = on_border(a, b);
    edges_.push_back({rounded(a), rounded(b), border});
    ends_.push_back({a, b});
    divides_ = divides_ || !border;
}

std::size_t LitPart::row(double v) const {
    const auto rows = static_cast<double>(row_first_.size() - 1);
    return static_cast<std::size_t>(std::clamp(v * rows, 0.0, rows - 1));
}

void LitPart::sort_into_rows() {
    row_first_.assign(std::clamp<std::size_t>(edges_.size() / 2, 1, 65536) + 1, 0);
    const auto each = [&](const auto& visit) {
        for (std::uint32_t e = 0; e < edges_.size(); ++e) {
            const auto [low, high] = std::minmax(edges_[e].a.y, edges_[e].b.y);
            for (std::size_t r = row(low - 1e-9); r <= row(high + 1e-9); ++r) visit(r, e);
        }
    };
    each([&](std::size_t r, std::uint32_t) { ++row_first_[r + 1]; });
    for (std::size_t r = 1; r < row_first_.size(); ++r) row_first_[r] += row_first_[r - 1];
    row_edges_.resize(row_first_.back());
    std::vector<std::uint32_t> next(row_first_.begin(), row_first_.end() - 1);
    each([&](std::size_t r, std::uint32_t e) { row_edges_[next[r]++] = e; });
}

/// Inside the lit polygons if the ray from (u, v) towards smaller u crosses an odd number of their edges. An edge
/// counts from its lower end on, without its upper end.
LitPart::At LitPart::at(float u, float v) const {
    const double x = u, y = v;
    bool inside = false, on_own_border = false;
    const std::size_t r = row(y);
    for (std::uint32_t k = row_first_[r]; k < row_first_[r + 1]; ++k) {
        const LitEdge& edge = edges_[row_edges_[k]];
        const Ends& ends    = ends_[row_edges_[k]];
        const int a_over    = sign(edge.a.y - y, kRounded, [&]() -> Exact { return ends.a[1] - Exact(y); });
        const int b_over    = sign(edge.b.y - y, kRounded, [&]() -> Exact { return ends.b[1] - Exact(y); });
        if (a_over * b_over > 0) continue;
        if (std::min(edge.a.x, edge.b.x) > x + kRounded) continue;
        const bool crosses = (a_over > 0) != (b_over > 0);
        if (std::max(edge.a.x, edge.b.x) < x - kRounded) {
            inside = inside != crosses;
            continue;
        }
        const dvec2 d = edge.b - edge.a, q = dvec2(x, y) - edge.a;
        const double error = 4 * kRounded * (std::abs(d.x) + std::abs(d.y) + std::abs(q.x) + std::abs(q.y) + kRounded);
        const int left     = sign(d.x * q.y - d.y * q.x, error, [&]() -> Exact {
            return (ends.b[0] - ends.a[0]) * (Exact(y) - ends.a[1]) - (ends.b[1] - ends.a[1]) * (Exact(x) - ends.a[0]);
        });
        if (left == 0) {
            // On its line, and between its ends as far as v tells; a level edge needs u, too.
            const bool level   = a_over == 0 && b_over == 0;
            const auto [l, h]  = std::minmax(ends.a[0], ends.b[0]);
            const bool outside = level && (Exact(x) < l || h < Exact(x));
            if (outside) continue;
            if (!edge.border) return At::boundary;
            on_own_border = true;
            continue;
        }
        // An edge that runs up has the points to its left at smaller u.
        if (crosses && (left > 0) != (b_over > a_over)) inside = !inside;
    }
    return inside || on_own_border ? At::lit : At::umbra;
}

std::vector<std::array<dvec2, 3>> LitPart::triangles() const {
    using Vertices = CGAL::Triangulation_vertex_base_2<Kernel::Exact_kernel>;
    using Faces    = CGAL::Constrained_triangulation_face_base_2<
        Kernel::Exact_kernel, CGAL::Triangulation_face_base_with_info_2<int, Kernel::Exact_kernel>>;
    using Triangulation =
        CGAL::Constrained_Delaunay_triangulation_2<Kernel::Exact_kernel,
                                                   CGAL::Triangulation_data_structure_2<Vertices, Faces>>;
    Triangulation plane;
    for (const Ends& edge : ends_) plane.insert_constraint({edge.a[0], edge.a[1]}, {edge.b[0], edge.b[1]});
    for (const auto face : plane.all_face_handles()) face->info() = kUnknown;
    std::vector<Triangulation::Face_handle> open{plane.infinite_face()};
    open.back()->info() = 0;
    while (!open.empty()) {  // every edge has a lit side and one that is not
        const auto face = open.back();
        open.pop_back();
        for (int k = 0; k < 3; ++k) {
            const auto next = face->neighbor(k);
            if (next->info() != kUnknown) continue;
            next->info() = face->is_constrained(k) ? 1 - face->info() : face->info();
            open.push_back(next);
        }
    }
    const auto corner = [](const Triangulation::Point& p) {
        return dvec2(CGAL::to_double(p.x()), CGAL::to_double(p.y()));
    };
    std::vector<std::array<dvec2, 3>> lit;
    for (const auto face : plane.finite_face_handles())
        if (face->info() == 1)
            lit.push_back(
                {corner(face->vertex(0)->point()), corner(face->vertex(1)->point()), corner(face->vertex(2)->point())});
    return lit;
}

std::size_t LitPart::memory_bytes() const {
    std::size_t bytes = sizeof(*this) + edges_.size() * sizeof(LitEdge) +
                        (row_first_.size() + row_edges_.size()) * sizeof(std::uint32_t) +
                        loops_.size() * sizeof(std::vector<dvec2>);
    for (const auto& loop : loops_) bytes += loop.size() * sizeof(dvec2);
    bytes += ends_.size() * (sizeof(Ends) + 4 * kDigits);
    return bytes;
}

}  // namespace umbra::atherton
