// A surface point by its exact name, and the signs of volumes that it spans: in double with a bound on the error, in
// rationals where that cannot tell.
//
// This work is based on:
// Jonathan Shewchuk. Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates. 1997
#pragma once

#include <CGAL/Gmpq.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra::exact_visibility {

using Rational  = CGAL::Gmpq;
using Rational3 = std::array<Rational, 3>;

inline constexpr double kUnit = 0x1p-53;  ///< half an ulp of 1 in double

/// A value, or kUnsure: the one answer here for "this arithmetic cannot tell".
template <class T>
using Filtered                          = std::optional<T>;
inline constexpr std::nullopt_t kUnsure = std::nullopt;

inline Rational3 rational(vec3 v) { return {Rational(double(v.x)), Rational(double(v.y)), Rational(double(v.z))}; }
inline Rational3 rational(dvec3 v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }
inline Rational3 operator-(const Rational3& a, const Rational3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Rational3 operator+(const Rational3& a, const Rational3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
[[nodiscard]] Rational dot(const Rational3& a, const Rational3& b);
[[nodiscard]] Rational3 cross(const Rational3& a, const Rational3& b);
[[nodiscard]] int sign_of_determinant(const Rational3& a, const Rational3& b, const Rational3& c);

inline double largest(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// A vector in double, and how far each component may be off.
struct Entries {
    dvec3 value{0};
    double error = 0;
};

/// Sign of the determinant of three vectors: -1, 0 or 1.
[[nodiscard]] Filtered<int> sign_of_determinant(const Entries& p, const Entries& q, const Entries& r);

/// (1-u-v) a + u b + v c of a triangle's corners: as it is named, not as it is rounded.
class ExactPoint {
public:
    ExactPoint(const Scene& scene, TriangleId t, float u, float v)
        : a_(scene.vertex(t, 0)), b_(scene.vertex(t, 1)), c_(scene.vertex(t, 2)), u_(u), v_(v) {
        // From the corner a, so that nothing depends on how far away the world's origin is. The two differences, the
        // two products and the sum are rounded: at most 5 times, of numbers no larger than the sum of the sides.
        const dvec3 ab = dvec3(b_) - dvec3(a_), ac = dvec3(c_) - dvec3(a_);
        from_corner_       = static_cast<double>(u) * ab + static_cast<double>(v) * ac;
        from_corner_error_ = 5 * kUnit * (largest(ab) + largest(ac));
        rounded_           = dvec3(a_) + from_corner_;
    }

    ExactPoint(const Scene& scene, const PointBatch& points, std::size_t i)
        : ExactPoint(scene, points.triangle[i], points.u[i], points.v[i]) {}

    /// x - p.
    [[nodiscard]] Entries to(vec3 x) const {
        const dvec3 from_a = dvec3(x) - dvec3(a_), d = from_a - from_corner_;
        return {d, from_corner_error_ + kUnit * (largest(from_a) + largest(d))};
    }
    /// The same where x lies by `from_a` from the corner, which is rounded already.
    [[nodiscard]] Entries to(const Entries& from_a) const {
        const dvec3 d = from_a.value - from_corner_;
        return {d, from_a.error + from_corner_error_ + kUnit * largest(d)};
    }

    /// Sign of the volume that the point and (x, y, z) span, which is the sign of det(x - p, y - p, z - p); kUnsure
    /// where doubles cannot tell.
    [[nodiscard]] Filtered<int> quick_side(vec3 x, vec3 y, vec3 z) const {
        return sign_of_determinant(to(x), to(y), to(z));
    }
    /// The same in rationals.
    [[nodiscard]] int exact_side(vec3 x, vec3 y, vec3 z) const;

    /// On which side of the plane of the point's own triangle x is, and to which the direction d leads: +1 where its
    /// normal points to. Exact.
    [[nodiscard]] int side_of_own(vec3 x) const;
    [[nodiscard]] int side_of_own_direction(vec3 d) const;

    /// In rationals.
    [[nodiscard]] const Rational3& exact() const;

    [[nodiscard]] vec3 corner() const { return a_; }
    [[nodiscard]] std::array<vec3, 3> corners() const { return {a_, b_, c_}; }
    /// Which of the barycentric coordinates of these corners are 0. Exact.
    [[nodiscard]] std::array<bool, 3> is_zero() const {
        return {Rational(double(u_)) + Rational(double(v_)) == 1, u_ == 0, v_ == 0};
    }
    [[nodiscard]] Entries from_corner() const { return {from_corner_, from_corner_error_}; }
    /// In double, and how far each coordinate may be off.
    [[nodiscard]] dvec3 rounded() const { return rounded_; }
    [[nodiscard]] double slack() const { return from_corner_error_ + kUnit * largest(rounded_); }

private:
    vec3 a_, b_, c_;
    float u_, v_;
    dvec3 from_corner_{0}, rounded_{0};
    double from_corner_error_ = 0;
    mutable std::optional<Rational3> exact_;
};

}  // namespace umbra::exact_visibility
