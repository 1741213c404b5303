#include "umbra/shadows/geometry/exact_point.h"

#include "umbra/core/base/predicates.h"

namespace umbra::exact_visibility {

Rational dot(const Rational3& a, const Rational3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Rational3 cross(const Rational3& a, const Rational3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

int sign_of_determinant(const Rational3& a, const Rational3& b, const Rational3& c) {
    return static_cast<int>(CGAL::sign(dot(a, cross(b, c))));
}

/// With P, Q, R the largest magnitudes and e, f, g the errors, each of the six products is off by at most
/// (P+e)(Q+f)(R+g) - PQR from its entries, and the evaluation by less than 8 roundings of it.
Filtered<int> sign_of_determinant(const Entries& p, const Entries& q, const Entries& r) {
    const dvec3 &a = p.value, &b = q.value, &c = r.value;
    const double det = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    const double P = largest(a), Q = largest(b), R = largest(c);
    const double spread       = (P + p.error) * (Q + q.error) * (R + r.error);
    const double from_entries = p.error * (Q + q.error) * (R + r.error) + P * (q.error * (R + r.error) + Q * r.error);
    const double bound        = 6.01 * (from_entries + 8 * kUnit * spread);
    // Entries may underflow where scenes are tiny: then the bound does not hold, and rationals decide.
    if (std::abs(det) > bound && bound > 1e-290) return det > 0 ? 1 : -1;
    return kUnsure;
}

const Rational3& ExactPoint::exact() const {
    if (!exact_) {
        const Rational u{double(u_)}, v{double(v_)};
        const Rational3 a = rational(a_), ab = rational(b_) - a, ac = rational(c_) - a;
        exact_.emplace(
            Rational3{a[0] + u * ab[0] + v * ac[0], a[1] + u * ab[1] + v * ac[1], a[2] + u * ab[2] + v * ac[2]});
    }
    return *exact_;
}

int ExactPoint::side_of_own(vec3 x) const { return side_of_plane(a_, b_, c_, x); }

int ExactPoint::side_of_own_direction(vec3 d) const { return side_of_direction(a_, b_, c_, d); }

int ExactPoint::exact_side(vec3 x, vec3 y, vec3 z) const {
    return sign_of_determinant(rational(x) - exact(), rational(y) - exact(), rational(z) - exact());
}

}  // namespace umbra::exact_visibility
