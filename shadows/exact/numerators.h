// Points in the numerators of light space (light_space.h), in either arithmetic, and what is computed of them.
#pragma once

#include "umbra/shadows/geometry/exact_point.h"

namespace umbra::exact_visibility {

/// A point in numerators: (X, Y, W) times a positive number, the same for all points.
template <class T>
struct Numerators {
    T x, y, w;
    double error = 0;  ///< of each; 0 in rationals
};

/// Sign of the determinant of three points.
inline Filtered<int> sign_of(const Numerators<double>& a, const Numerators<double>& b, const Numerators<double>& c) {
    return sign_of_determinant(Entries{dvec3(a.x, a.y, a.w), a.error}, Entries{dvec3(b.x, b.y, b.w), b.error},
                               Entries{dvec3(c.x, c.y, c.w), c.error});
}
inline Filtered<int> sign_of(const Numerators<Rational>& a, const Numerators<Rational>& b,
                             const Numerators<Rational>& c) {
    return sign_of_determinant(Rational3{a.x, a.y, a.w}, Rational3{b.x, b.y, b.w}, Rational3{c.x, c.y, c.w});
}

/// The sign that the determinant of a point of the light, (x, y, 1) with |x|, |y| <= 1, and of b and c has for all such
/// points; kUnsure where it has more than one. The bound is that of sign_of_determinant.
inline Filtered<int> sign_over_light(const Numerators<double>& b, const Numerators<double>& c) {
    const dvec3 normal(b.y * c.w - b.w * c.y, b.w * c.x - b.x * c.w, b.x * c.y - b.y * c.x);
    const double q = largest(dvec3(b.x, b.y, b.w)), r = largest(dvec3(c.x, c.y, c.w));
    const double from_entries = b.error * (r + c.error) + q * c.error;
    const double bound        = 6.01 * (from_entries + 8 * kUnit * (q + b.error) * (r + c.error));
    const double least        = std::abs(normal.z) - std::abs(normal.x) - std::abs(normal.y);
    if (least > bound && bound > 1e-290) return normal.z > 0 ? 1 : -1;
    return kUnsure;
}

inline Numerators<double> operator-(const Numerators<double>& a, const Numerators<double>& b) {
    const Numerators<double> d{a.x - b.x, a.y - b.y, a.w - b.w, 0};
    return {d.x, d.y, d.w, a.error + b.error + kUnit * largest(dvec3(d.x, d.y, d.w))};
}
inline Numerators<Rational> operator-(const Numerators<Rational>& a, const Numerators<Rational>& b) {
    return {a.x - b.x, a.y - b.y, a.w - b.w, 0};
}

/// a + t (b - a), 0 <= t <= 1.
template <class T>
Numerators<T> between(const Numerators<T>& a, const Numerators<T>& b, const T& t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.w + t * (b.w - a.w), std::max(a.error, b.error)};
}

/// Where the segment from a to b meets the light's plane, W = height; one end lies before it, the other in or beyond
/// it. kUnsure where the rise from a to b is lost in its error.
inline Filtered<Numerators<double>> at_plane(const Numerators<double>& a, const Numerators<double>& b, double height) {
    const double rise = b.w - a.w, error = std::max(a.error, b.error);
    if (!(std::abs(rise) > 8 * error)) return kUnsure;
    Numerators<double> cut = between(a, b, std::clamp((height - a.w) / rise, 0.0, 1.0));
    cut.w                  = height;
    // An error of the heights moves the cut along the segment.
    const double length = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
    cut.error           = 2 * error + 4 * error * length / std::abs(rise) + 8 * kUnit * length;
    return cut;
}
inline Filtered<Numerators<Rational>> at_plane(const Numerators<Rational>& a, const Numerators<Rational>& b,
                                               const Rational& height) {
    return between(a, b, Rational((height - a.w) / (b.w - a.w)));
}

}  // namespace umbra::exact_visibility
