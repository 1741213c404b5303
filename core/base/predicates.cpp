// CGAL's filtered kernel: static bounds first, then intervals, then exact numbers. Measured over 10^6 random calls, a
// filter written for floats alone was 1.1 to 1.4 times as fast; where the answer is 0, CGAL is mostly 7 to 130 times as
// fast as that filter with rationals behind it.
#include "umbra/core/base/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>

#include <cmath>

namespace umbra {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point  = Kernel::Point_3;

Point point(vec3 p) { return {p.x, p.y, p.z}; }
Point point(dvec3 p) { return {p.x, p.y, p.z}; }

/// Whether `difference`, computed as b - a, was not rounded: then both ways back are exact too. [Theodorus Dekker, A
/// Floating-Point Technique for Extending the Available Precision, 1971]
bool is_exact(dvec3 difference, dvec3 b, dvec3 a) { return b - difference == a && difference + a == b; }

}  // namespace

int side_of_plane(vec3 a, vec3 b, vec3 c, vec3 q) { return CGAL::orientation(point(a), point(b), point(c), point(q)); }

int side_of_direction(vec3 a, vec3 b, vec3 c, vec3 d) { return side_of_direction(a, b, c, dvec3(d)); }

int side_of_direction(vec3 a, vec3 b, vec3 c, dvec3 d) {
    const dvec3 p = dvec3(b) - dvec3(a), q = dvec3(c) - dvec3(a);
    // CGAL has static bounds for four points, not for three points and a direction: the sides can replace points
    // where they are exact, as almost all differences of floats are in double.
    if (is_exact(p, b, a) && is_exact(q, c, a))
        return CGAL::orientation(Point(CGAL::ORIGIN), point(p), point(q), point(d));
    return CGAL::compare_signed_distance_to_plane(point(a), point(b), point(c), point(d), Point(CGAL::ORIGIN));
}

bool lies_in_sphere(vec3 a, vec3 b, vec3 c, float u, float v, vec3 centre, float radius) {
    using Rational = CGAL::Gmpq;
    // A coordinate of `to` has at most 3 times the magnitude of `reach`, and an error of at most 6 roundings of that:
    // 18 of `reach`. Its square then has one of at most 2 * 3 * 18 of the square of `reach`, and the sum 4 more of 9.
    const dvec3 x(a), y(b), z(c), from(centre);
    const double U = u, V = v, r = radius;
    const dvec3 to       = x - from + U * (y - x) + V * (z - x);
    const dvec3 reach    = glm::abs(x) + glm::abs(y) + glm::abs(z) + glm::abs(from);
    const double largest = reach.x + reach.y + reach.z + r;
    const double excess  = glm::dot(to, to) - r * r;
    if (const double error = 256 * 0x1p-53 * largest * largest; std::abs(excess) > error && error > 1e-290)
        return excess < 0;
    Rational square = 0;
    for (int k = 0; k < 3; ++k) {
        const Rational p = x[k], q = y[k], s = z[k];
        const Rational d = p - Rational(from[k]) + Rational(U) * (q - p) + Rational(V) * (s - p);
        square += d * d;
    }
    return square <= Rational(r) * Rational(r);
}

}  // namespace umbra
