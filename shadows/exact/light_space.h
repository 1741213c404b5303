// A rectangle or disk light seen from one surface point, in coordinates in which the light is fixed: a point q is
// q - p = X u + Y v + W (c - p), with c the light's centre and u, v its half axes. Seen from p, q lies over the point
// (X/W, Y/W) of the light; the light is |x|, |y| <= 1 or the unit disk, and points before it have 0 < W < 1.
//
// X, Y and W are quotients of determinants over one denominator, det(u, v, c - p) squared apart: x, y and signs need
// the numerators alone.
//
// In double each numerator comes with a bound on its error; in rationals there is none.
#pragma once

#include "umbra/shadows/exact/light_plane.h"
#include "umbra/shadows/geometry/box_tree.h"
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

class FloatSpace {
public:
    using Number = double;

    FloatSpace(const ExactPoint& p, const LightPlane& frame) : p_(p), moves_(!frame.exact_axes) {
        const dvec3 &u = frame.u, &v = frame.v;
        const Entries r   = p.to(frame.centre_from_corner);
        const double side = std::max(largest(u), largest(v));
        gx_               = glm::cross(v, r.value);
        gy_               = glm::cross(r.value, u);
        gw_               = glm::cross(u, v);
        // A component is a difference of two products: off by twice the entry's error, and by three roundings.
        // Where the axes are off, by twice that, too.
        const double axis_error = 2.01 * frame.axis_error;
        g_error_                = side * (2 * r.error + 6 * kUnit * std::max(largest(r.value), side)) +
                   axis_error * (largest(r.value) + r.error + 2 * side);
        g_size_              = std::max({largest(gx_), largest(gy_), largest(gw_)});
        const double gw_size = largest(gw_), gw_error = 6 * kUnit * side * side + 2 * axis_error * side;
        height_ = glm::dot(gw_, r.value);
        height_error_ =
            3 * (gw_size * r.error + gw_error * (largest(r.value) + r.error)) + 12 * kUnit * gw_size * largest(r.value);
        // Products that underflow where scenes are tiny make the bound no bound.
        if (std::abs(height_) > height_error_ && height_error_ > 1e-290) orientation_ = height_ > 0 ? 1 : -1;
        if (orientation_ == -1) gx_ = -gx_, gy_ = -gy_, gw_ = -gw_, height_ = -height_;
        to_centre_ = r;
    }

    /// +1 where (u, v, c - p) is right-handed, so that orientations in the light's plane are those of the world seen
    /// from p; -1 where it is not.
    [[nodiscard]] Filtered<int> orientation() const { return orientation_; }
    /// W's numerator on the light's plane.
    [[nodiscard]] double height() const { return height_; }

    [[nodiscard]] Numerators<double> project(vec3 q) const {
        const Entries d   = p_.to(q);
        const double size = largest(d.value);
        // The error of a sum of three products: the entries' errors, and five roundings.
        return {glm::dot(d.value, gx_), glm::dot(d.value, gy_), glm::dot(d.value, gw_),
                3 * (size * g_error_ + d.error * (g_size_ + g_error_)) + 15 * kUnit * size * g_size_};
    }

    /// Whether q is in or beyond the light's plane, not before it.
    [[nodiscard]] Filtered<bool> beyond(const Numerators<double>& q) const {
        const double over = q.w - height_, error = q.error + height_error_;
        // The plane of a sphere's disk is rounded itself: area_in_doubt() holds what either answer may change.
        if (moves_) return over >= 0;
        if (!(std::abs(over) > error)) return kUnsure;
        return over > 0;
    }
    /// The point (x, y) of the light itself.
    [[nodiscard]] Numerators<double> on_light(double x, double y) const {
        return {x * height_, y * height_, height_, height_error_ + 2 * kUnit * height_};
    }

    [[nodiscard]] const Entries& to_centre() const { return to_centre_; }
    [[nodiscard]] dvec3 gx() const { return gx_; }
    [[nodiscard]] dvec3 gy() const { return gy_; }
    [[nodiscard]] dvec3 gw() const { return gw_; }
    [[nodiscard]] double g_error() const { return g_error_; }
    [[nodiscard]] double height_error() const { return height_error_; }

private:
    const ExactPoint& p_;
    bool moves_;  ///< the plane differs from point to point
    Entries to_centre_;
    dvec3 gx_{0}, gy_{0}, gw_{0};
    double g_error_ = 0, g_size_ = 0, height_ = 0, height_error_ = 0;
    Filtered<int> orientation_;
};

/// The region between p and the light, and around it as far as the light scaled by `reach`: `p` is the point of
/// `space`, whose orientation is known.
[[nodiscard]] inline BoxTree::Region shaft(const ExactPoint& p, const FloatSpace& space, double reach) {
    BoxTree::Region region;
    const dvec3 gx = space.gx(), gy = space.gy(), gw = space.gw() * reach;
    region.planes = {
        {{gw + gx, 0}, {gw - gx, 0}, {gw + gy, 0}, {gw - gy, 0}, {-space.gw(), space.height() + space.height_error()}}};
    region.from  = p.rounded();
    region.slack = 2 * p.slack();
    region.tilt  = 3 * space.g_error();
    return region;
}

/// The region between p and a ball, and that ball: nothing where p is in it or close to it.
[[nodiscard]] inline std::optional<BoxTree::Region> shaft_to_ball(const ExactPoint& p, const Entries& to_centre,
                                                                  double radius) {
    constexpr double kWidest = 0.9;  // sine of the angle between the axis and a plane
    const dvec3& w           = to_centre.value;
    const double distance = glm::length(w), sine = radius / distance;
    if (!(sine < kWidest)) return std::nullopt;
    const dvec3 axis = w / distance;
    const dvec3 across =
        glm::normalize(std::abs(axis.x) < 0.5 ? glm::cross(axis, dvec3(1, 0, 0)) : glm::cross(axis, dvec3(0, 1, 0)));
    const dvec3 in = sine * axis, a = std::sqrt(1 - sine * sine) * across,
                b = std::sqrt(1 - sine * sine) * glm::cross(axis, across);
    BoxTree::Region region;
    region.planes = {{{in + a, 0}, {in - a, 0}, {in + b, 0}, {in - b, 0}, {-axis, distance + radius}}};
    region.from   = p.rounded();
    region.slack  = 2 * p.slack() + to_centre.error + 16 * kUnit * (distance + radius);
    region.tilt   = 16 * kUnit;
    return region;
}

class RationalSpace {
public:
    using Number = Rational;

    RationalSpace(const ExactPoint& p, const LightPlane& frame) : p_(p.exact()) {
        const auto [u, v, c] = in_rationals(frame, p);
        const Rational3 r    = c - p_;
        gx_                  = cross(v, r);
        gy_                  = cross(r, u);
        gw_                  = cross(u, v);
        height_              = dot(gw_, r);
        orientation_         = static_cast<int>(CGAL::sign(height_));
        if (orientation_ == -1) {
            for (Rational3* g : {&gx_, &gy_, &gw_})
                for (Rational& x : *g) x = -x;
            height_ = -height_;
        }
    }

    [[nodiscard]] Filtered<int> orientation() const { return orientation_; }  ///< 0 where p lies in the light's plane
    [[nodiscard]] const Rational& height() const { return height_; }
    [[nodiscard]] Numerators<Rational> project(vec3 q) const {
        const Rational3 d = rational(q) - p_;
        return {dot(d, gx_), dot(d, gy_), dot(d, gw_), 0};
    }
    [[nodiscard]] Filtered<bool> beyond(const Numerators<Rational>& q) const { return q.w >= height_; }
    [[nodiscard]] Numerators<Rational> on_light(double x, double y) const {
        return {Rational(x) * height_, Rational(y) * height_, height_, 0};
    }

private:
    Rational3 p_, gx_, gy_, gw_;
    Rational height_;
    int orientation_ = 0;
};

}  // namespace umbra::exact_visibility
