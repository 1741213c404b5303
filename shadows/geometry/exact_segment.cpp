// All decisions are signs of determinants. Vertices, barycentrics and light are the floats of the scene, unrounded.
//
// This work is based on:
// Rafael Segura, Francisco Feito. Algorithms to Test Ray-Triangle Intersection. Comparative Study. 2001
#include "umbra/shadows/geometry/exact_segment.h"

namespace umbra::exact_visibility {

Segment::Segment(const ExactPoint& start, const Light& light)
    : start_(start),
      infinite_(light.kind == LightKind::directional),
      end_(infinite_ ? -light.direction : light.position),
      to_(infinite_ ? Entries{dvec3(end_), 0} : start.to(end_)) {}

BoxTree::Piece Segment::piece() const {
    const dvec3 from = start_.rounded();
    return {from, infinite_ ? dvec3(end_) : dvec3(end_) - from, infinite_ ? double(kInfinity) : 1.0,
            2 * start_.slack()};
}

/// The side of the triangle's plane that the end is on; for a direction the side that it runs to.
int Segment::end_side(vec3 x, vec3 y, vec3 z) const {
    const dvec3 p = dvec3(y) - dvec3(x), q = dvec3(z) - dvec3(x);
    const dvec3 r      = infinite_ ? dvec3(end_) : dvec3(end_) - dvec3(x);
    const auto s       = sign_of_determinant(Entries{p, kUnit * largest(p)}, Entries{q, kUnit * largest(q)},
                                             Entries{r, infinite_ ? 0 : kUnit * largest(r)});
    const int positive = s ? *s
                           : sign_of_determinant(rational(y) - rational(x), rational(z) - rational(x),
                                                 infinite_ ? rational(end_) : rational(end_) - rational(x));
    // det(x - q, y - q, z - q) = -det(y - x, z - x, q - x): the sign that ExactPoint::side would give for q.
    return -positive;
}

/// On which side the line through start and end passes the edge from x to y; kUnsure where doubles cannot tell.
Filtered<int> Segment::quick_edge_side(vec3 x, vec3 y) const {
    return sign_of_determinant(start_.to(x), start_.to(y), to_);
}

int Segment::edge_side(vec3 x, vec3 y) const {
    return sign_of_determinant(rational(x) - start_.exact(), rational(y) - start_.exact(), direction());
}

/// Whether some of the triangle is in front of the plane of the surface point's triangle, where the light is.
bool Segment::rises(vec3 x, vec3 y, vec3 z) const {
    const int front = infinite_ ? start_.side_of_own_direction(end_) : start_.side_of_own(end_);
    return start_.side_of_own(x) == front || start_.side_of_own(y) == front || start_.side_of_own(z) == front;
}

/// A segment that begins in the plane of the triangle, which it may touch but not cross. Where it ends there, too, the
/// light sees the triangle edge-on. Rare, so in rationals throughout, in the two coordinates other than `axis`.
Segment::Meeting Segment::meeting_from_plane(vec3 x, vec3 y, vec3 z, bool ends_in_plane) const {
    if (!rises(x, y, z)) return Meeting::none;
    const std::array<Rational3, 3> corner = {rational(x), rational(y), rational(z)};
    const Rational3 normal                = cross(corner[1] - corner[0], corner[2] - corner[0]);
    std::size_t axis                      = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (CGAL::abs(normal[k]) > CGAL::abs(normal[axis])) axis = k;
    const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    const auto side = [&](const Rational3& p, const Rational3& q, const Rational3& r) {
        return static_cast<int>(CGAL::sign((q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i])));
    };
    const int inside       = side(corner[0], corner[1], corner[2]);
    const Rational3& start = start_.exact();
    if (!ends_in_plane) {
        for (std::size_t e = 0; e < 3; ++e)
            if (inside * side(corner[e], corner[(e + 1) % 3], start) < 0) return Meeting::none;
        return Meeting::touches;
    }

    Rational3 end = rational(end_);
    if (infinite_) {  // far enough along the direction to have passed every corner
        Rational reach = 1;
        for (const Rational3& c : corner)
            for (const std::size_t k : {i, j})
                if (end[k] != 0) reach = std::max(reach, CGAL::abs(Rational((c[k] - start[k]) / end[k])) + 1);
        for (std::size_t k = 0; k < 3; ++k) end[k] = start[k] + reach * end[k];
    }
    // Is there a line between the segment and the triangle, on which the end may lie?
    const int a = side(start, end, corner[0]), b = side(start, end, corner[1]), c = side(start, end, corner[2]);
    if ((a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0)) return Meeting::none;
    for (std::size_t e = 0; e < 3; ++e) {
        const Rational3 &p = corner[e], &q = corner[(e + 1) % 3];
        if (inside * side(p, q, start) < 0 && inside * side(p, q, end) <= 0) return Meeting::none;
    }
    return Meeting::touches;
}

Segment::Meeting Segment::meeting(vec3 x, vec3 y, vec3 z) const {
    // Most lines pass the triangle by, and doubles see it. Asked first, since a neighbour in the plane of the point's
    // own triangle (a floor of two triangles) would otherwise cost rationals at every point.
    const Filtered<int> q0 = quick_edge_side(x, y), q1 = quick_edge_side(y, z), q2 = quick_edge_side(z, x);
    const bool surely_left = q0 == 1 || q1 == 1 || q2 == 1, surely_right = q0 == -1 || q1 == -1 || q2 == -1;
    if (surely_left && surely_right) return Meeting::none;

    // Triangles in or behind the plane of the point's own are not counted. A copy of that triangle, or a neighbour in
    // its plane, would cost rationals at every point: doubles cannot place the point, but the corners are floats.
    const Filtered<int> quick = start_.quick_side(x, y, z);
    if (!quick && !rises(x, y, z)) return Meeting::none;
    const int end = end_side(x, y, z), start = quick ? *quick : start_.exact_side(x, y, z);
    if (start == 0) return meeting_from_plane(x, y, z, end == 0);
    // A segment that ends on the triangle's plane does not pass through it: nothing lies on both of its sides.
    if (end == 0 || start == end) return Meeting::none;
    const int e0         = q0 ? *q0 : edge_side(x, y);
    const int e1         = q1 ? *q1 : edge_side(y, z);
    const int e2         = q2 ? *q2 : edge_side(z, x);
    const bool some_left = e0 > 0 || e1 > 0 || e2 > 0, some_right = e0 < 0 || e1 < 0 || e2 < 0;
    if (some_left && some_right) return Meeting::none;
    return e0 != 0 && e1 != 0 && e2 != 0 ? Meeting::crosses : Meeting::touches;
}

}  // namespace umbra::exact_visibility
