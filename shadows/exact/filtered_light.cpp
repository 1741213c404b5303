#include "umbra/shadows/exact/filtered_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "umbra/core/base/rounding.h"
#include "umbra/shadows/exact/horizon.h"

namespace umbra::exact_visibility {
namespace {

/// Steps of ExactArea::Workspace to project a triangle, to cut a cell, and to look at one.
constexpr std::uint64_t kStepsOfTriangle = 150, kStepsOfCut = 100, kStepsOfLook = 2;

Rational3 scaled(const Rational3& a, const Rational& by) { return {a[0] * by, a[1] * by, a[2] * by}; }

/// A vector, exact and in double.
struct Rounded {
    Rational3 exact;
    dvec3 near{0};        ///< each off by less than two roundings
    bool is_near = true;  ///< so large, or 0, that products of two neither under- nor overflow

    explicit Rounded(Rational3 of) : exact(std::move(of)) {
        for (int k = 0; k < 3; ++k) {
            const Rational& x = exact[static_cast<std::size_t>(k)];
            near[k]           = CGAL::to_double(x);
            const double size = std::abs(near[k]);
            is_near           = is_near && (CGAL::sign(x) == 0 || (size > 1e-140 && size < 1e140));
        }
    }
    Rounded(int x, int y, int z) : Rounded(Rational3{x, y, z}) {}
};

/// A half plane of the light's plane, g . (x, y, 1) > 0, in the coordinates in which the light is |x|, |y| <= 1.
using LightHalf = Rounded;
/// A point of it, (x, y, 1) times a positive number.
using Corner = Rounded;

LightHalf turned_over(const LightHalf& g) { return LightHalf(scaled(g.exact, Rational(-1))); }

/// 1 where the half plane holds the point, 0 on its border, else -1.
int side_of(const LightHalf& g, const Corner& c) {
    const dvec3 terms  = g.near * c.near;
    const double value = terms.x + terms.y + terms.z;
    // Each term is off by five roundings, and the sum by two more.
    const double bound = 16 * 0x1p-53 * sum_of_magnitudes(terms);
    if (g.is_near && c.is_near && value > bound) return 1;
    if (g.is_near && c.is_near && value < -bound) return -1;
    return static_cast<int>(CGAL::sign(dot(g.exact, c.exact)));
}

/// Where the borders of two half planes meet.
Corner meeting(const LightHalf& a, const LightHalf& b) {
    Rational3 c = cross(a.exact, b.exact);
    if (CGAL::sign(c[2]) < 0) c = scaled(c, Rational(-1));
    return Corner(c);
}

/// An edge on the border of a half plane, and the corner that it ends at.
struct CellEdge {
    LightHalf border;
    Corner end;
};

/// A convex polygon, anticlockwise. Corners are meetings of two borders that were given, so that their digits do not
/// grow from cut to cut.
struct Cell {
    std::vector<CellEdge> edges;
    dvec3 share{1};  ///< of the light that passes what lies before it, per channel
};

/// The part of a cell in a half plane; no edges where there is none with an area.
Cell clipped(const Cell& cell, const LightHalf& g) {
    const std::size_t n = cell.edges.size();
    std::vector<int> side(n);
    bool any_inside = false, any_outside = false;
    for (std::size_t k = 0; k < n; ++k) {
        side[k]     = side_of(g, cell.edges[k].end);
        any_inside  = any_inside || side[k] > 0;
        any_outside = any_outside || side[k] < 0;
    }
    if (!any_inside) return {{}, cell.share};
    if (!any_outside) return cell;
    Cell part{{}, cell.share};
    for (std::size_t k = 0; k < n; ++k) {
        const CellEdge& edge = cell.edges[k];
        const int from = side[(k + n - 1) % n], to = side[k];
        if (from < 0 && to > 0) part.edges.push_back({g, meeting(g, edge.border)});
        if (from == 0 && to > 0) part.edges.push_back({g, cell.edges[(k + n - 1) % n].end});
        if (from > 0 && to < 0) part.edges.push_back({edge.border, meeting(g, edge.border)});
        if ((from > 0 && to >= 0) || (from <= 0 && to > 0)) part.edges.push_back(edge);
    }
    return part;
}

/// In a light of area 1. Corners are rounded to double once.
double area_of(const Cell& cell) {
    const auto place = [](const Corner& c) {
        return dvec2(CGAL::to_double(Rational(c.exact[0] / c.exact[2])),
                     CGAL::to_double(Rational(c.exact[1] / c.exact[2])));
    };
    const dvec2 origin = place(cell.edges[0].end);
    double twice       = 0;
    for (std::size_t k = 1; k + 1 < cell.edges.size(); ++k) {
        const dvec2 a = place(cell.edges[k].end) - origin, b = place(cell.edges[k + 1].end) - origin;
        twice += a.x * b.y - a.y * b.x;
    }
    return twice / 2 / 4;  // the light is 2 x 2
}

/// The light's points that a triangle (a, b, c) hides from the viewpoint. The segment to (x, y) passes through it
/// where det(a, b, (x, y, 1)) and the other two have the sign of det(a, b, c), and meets it there at W = det(a, b, c)
/// over their sum, which is before the light where it is less than the light's height.
struct Hidden {
    std::array<LightHalf, 4> inside, outside;
};
std::optional<Hidden> hidden_by(const Scene& scene, const RationalSpace& space, TriangleId t) {
    std::array<Rational3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
        const Numerators<Rational> q = space.project(scene.vertex(t, static_cast<int>(k)));
        corner[k]                    = {q.x, q.y, q.w};
    }
    const Rational volume = dot(corner[0], cross(corner[1], corner[2]));
    const int sign        = static_cast<int>(CGAL::sign(volume));
    if (sign == 0) return std::nullopt;  // seen edge-on
    std::array<Rational3, 4> hidden;
    for (std::size_t k = 0; k < 3; ++k) hidden[k] = scaled(cross(corner[k], corner[(k + 1) % 3]), Rational(sign));
    hidden[3]    = scaled(hidden[0] + hidden[1] + hidden[2], space.height());
    hidden[3][2] = hidden[3][2] - Rational(sign) * volume;
    const LightHalf a(hidden[0]), b(hidden[1]), c(hidden[2]), d(hidden[3]);
    return Hidden{{a, b, c, d}, {turned_over(a), turned_over(b), turned_over(c), turned_over(d)}};
}

Cell whole_light() {
    const LightHalf left{1, 0, 1}, right{-1, 0, 1}, low{0, 1, 1}, high{0, -1, 1};
    Cell cell;
    for (const auto& [border, next] : {std::pair{low, right}, {right, high}, {high, left}, {left, low}})
        cell.edges.push_back({border, meeting(border, next)});
    return cell;
}

/// Replaces a cell by its parts: what the triangle hides, dimmed, and the rest.
void divide(Cell cell, const Hidden& hidden, dvec3 passes, std::vector<Cell>& into) {
    const auto is_outside = [&](const LightHalf& g) {
        return std::ranges::all_of(cell.edges, [&](const CellEdge& edge) { return side_of(g, edge.end) <= 0; });
    };
    if (std::ranges::any_of(hidden.inside, is_outside)) {
        into.push_back(std::move(cell));
        return;
    }
    const std::size_t before = into.size();
    Cell rest                = cell;
    for (std::size_t k = 0; k < hidden.inside.size(); ++k) {
        Cell beside = clipped(rest, hidden.outside[k]);
        if (!beside.edges.empty()) into.push_back(std::move(beside));
        rest = clipped(rest, hidden.inside[k]);
        if (rest.edges.empty()) {  // none of it is hidden, and nothing is to be cut
            into.resize(before);
            into.push_back(std::move(cell));
            return;
        }
    }
    rest.share *= passes;
    if (rest.share != dvec3(0)) into.push_back(std::move(rest));
}

}  // namespace

std::optional<dvec3> light_through_filters(const Sight& sight, const RationalSpace& space,
                                           std::span<const TriangleId> between, std::uint64_t& steps) {
    const Scene& scene = sight.viewpoint.scene();
    std::vector<Cell> cells{whole_light()}, next;
    if (sight.partly) {
        const auto horizon = horizon_of<Rational>(sight);
        cells[0]           = clipped(cells[0], LightHalf(Rational3{horizon.lx, horizon.ly, horizon.l}));
        if (cells[0].edges.empty()) return dvec3(0);
    }
    for (const TriangleId t : between) {
        const auto hidden = hidden_by(scene, space, t);
        if (!hidden) continue;
        next.clear();
        for (Cell& cell : cells) divide(std::move(cell), *hidden, dvec3(scene.lets_through(t)), next);
        steps += kStepsOfTriangle + kStepsOfLook * cells.size();
        if (next.size() > cells.size()) steps += kStepsOfCut * (next.size() - cells.size());
        if (next.size() > kMostCells) return std::nullopt;
        std::swap(cells, next);
    }
    dvec3 passed(0);
    for (const Cell& cell : cells) passed += area_of(cell) * cell.share;
    return passed;
}

}  // namespace umbra::exact_visibility
