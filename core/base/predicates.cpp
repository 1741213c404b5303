#include "umbra/core/base/predicates.h"

#include <CGAL/Gmpq.h>

#include <cmath>

namespace umbra {
namespace {

using Rational = CGAL::Gmpq;

int sign(double x) { return (x > 0) - (x < 0); }

/// Determinant of the rows p, q, r.
template <class T>
T determinant(const T (&p)[3], const T (&q)[3], const T (&r)[3]) {
    return p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
}

int exact_sign(vec3 a, vec3 b, vec3 c, vec3 d, bool d_is_direction) {
    Rational p[3], q[3], r[3];
    for (int k = 0; k < 3; ++k) {
        p[k] = Rational(static_cast<double>(b[k])) - Rational(static_cast<double>(a[k]));
        q[k] = Rational(static_cast<double>(c[k])) - Rational(static_cast<double>(a[k]));
        r[k] = Rational(static_cast<double>(d[k]));
        if (!d_is_direction) r[k] -= Rational(static_cast<double>(a[k]));
    }
    return static_cast<int>(CGAL::sign(determinant(p, q, r)));
}

/// The sign in double where it is certain, else in rationals.
///
/// Each entry is a difference of two floats, rounded once: relative error u = 2^-53. Each of the six products of three
/// entries carries at most (1+u)^3 from its entries and (1+u)^2 from two multiplications, the sums another (1+u)^3 at
/// most: below 9 u relative to the permanent (the same expression over magnitudes); 16 u leaves room for the rounding
/// of the permanent itself. Floats' products of three stay within 2^-447 .. 2^387, so that nothing underflows in
/// double.
int filtered_sign(vec3 a, vec3 b, vec3 c, vec3 d, bool d_is_direction) {
    const dvec3 p    = dvec3(b) - dvec3(a);
    const dvec3 q    = dvec3(c) - dvec3(a);
    const dvec3 r    = d_is_direction ? dvec3(d) : dvec3(d) - dvec3(a);
    const double det = p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) + p.z * (q.x * r.y - q.y * r.x);
    const dvec3 P = glm::abs(p), Q = glm::abs(q), R = glm::abs(r);
    const double permanent =
        P.x * (Q.y * R.z + Q.z * R.y) + P.y * (Q.z * R.x + Q.x * R.z) + P.z * (Q.x * R.y + Q.y * R.x);
    if (std::abs(det) > permanent * (16 * 0x1p-53)) return sign(det);
    if (permanent == 0) return 0;
    return exact_sign(a, b, c, d, d_is_direction);
}

}  // namespace

int side_of_plane(vec3 a, vec3 b, vec3 c, vec3 q) { return filtered_sign(a, b, c, q, false); }
int side_of_direction(vec3 a, vec3 b, vec3 c, vec3 d) { return filtered_sign(a, b, c, d, true); }

}  // namespace umbra
