#include "umbra/core/base/heights.h"

#include <CGAL/Gmpq.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace umbra {
namespace {

using Rational = CGAL::Gmpq;

struct Rational3 {
    Rational x, y, z;
};
Rational3 rational(dvec3 v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }
Rational3 operator-(const Rational3& p, const Rational3& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
Rational dot(const Rational3& p, const Rational3& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
Rational3 cross(const Rational3& p, const Rational3& q) {
    return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
Rational3 exact_normal(vec3 a, vec3 b, vec3 c) {
    const Rational3 origin = rational(a);
    return cross(rational(b) - origin, rational(c) - origin);
}

double largest(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// The triangle in double. A component of the normal is a difference of two products of rounded differences: its error
/// is at most 8 units of `size`, which is the product of the largest components of the two sides. A height of something
/// as far away as `reach` is a sum of three products with it; its error is less than 100 units of size times reach, and
/// that of a disk's rim a few roundings more.
class Plane {
public:
    Plane(vec3 a, vec3 b, vec3 c) : a_(a) {
        const dvec3 ab = dvec3(b) - a_, ac = dvec3(c) - a_;
        normal_ = glm::cross(ab, ac);
        size_   = largest(ab) * largest(ac);
    }
    [[nodiscard]] const dvec3& normal() const { return normal_; }
    [[nodiscard]] double over(dvec3 q) const { return glm::dot(normal_, q - a_); }
    [[nodiscard]] double distance(dvec3 q) const { return largest(q - a_); }

    /// The signs of two heights, where rounding cannot have turned them; `reach`: of all that they were computed from.
    [[nodiscard]] std::optional<HeightSigns> signs(double low, double high, double reach) const {
        const double error = 256 * 0x1p-53 * size_ * reach;
        if (!(error > 1e-290)) return std::nullopt;  // products that underflow have lost digits
        if (!(std::abs(low) > error && std::abs(high) > error)) return std::nullopt;
        return HeightSigns{low > 0 ? 1 : -1, high > 0 ? 1 : -1};
    }

private:
    dvec3 a_, normal_;
    double size_;
};

int sign(const Rational& x) { return static_cast<int>(CGAL::sign(x)); }

/// Sign of h - e, e >= 0, given the square of e.
int sign_of_difference(const Rational& h, const Rational& square) {
    if (h < 0) return -1;
    return sign(h * h - square);
}

/// The signs of a figure that reaches equally far to both sides of its centre, which is at the height h; `square`: of
/// this distance.
HeightSigns around(const Rational& h, const Rational& square) {
    return {sign_of_difference(h, square), -sign_of_difference(-h, square)};
}

}  // namespace

HeightSigns heights_of_rectangle(vec3 a, vec3 b, vec3 c, vec3 centre, vec3 edge_u, vec3 edge_v) {
    const Plane plane(a, b, c);
    const dvec3 u = 0.5 * dvec3(edge_u), v = 0.5 * dvec3(edge_v);
    const double h    = plane.over(centre),
                 rise = std::abs(glm::dot(plane.normal(), u)) + std::abs(glm::dot(plane.normal(), v));
    if (const auto s = plane.signs(h - rise, h + rise, plane.distance(centre) + largest(u) + largest(v))) return *s;
    const Rational3 n         = exact_normal(a, b, c);
    const Rational exact_h    = dot(n, rational(centre) - rational(a));
    const Rational exact_rise = CGAL::abs(dot(n, rational(u))) + CGAL::abs(dot(n, rational(v)));
    return {sign(exact_h - exact_rise), sign(exact_h + exact_rise)};
}

HeightSigns heights_of_disk(vec3 a, vec3 b, vec3 c, vec3 centre, vec3 axis, float radius) {
    const Plane plane(a, b, c);
    const double r = radius, h = plane.over(centre);
    const double rise = r * glm::length(glm::cross(plane.normal(), glm::normalize(dvec3(axis))));
    if (const auto s = plane.signs(h - rise, h + rise, plane.distance(centre) + r)) return *s;
    const Rational3 n = exact_normal(a, b, c), d = rational(axis), slant = cross(n, d);
    return around(dot(n, rational(centre) - rational(a)), Rational(r) * Rational(r) * dot(slant, slant) / dot(d, d));
}

HeightSigns heights_of_sphere(vec3 a, vec3 b, vec3 c, vec3 centre, float radius) {
    const Plane plane(a, b, c);
    const double r = radius, h = plane.over(centre), rise = r * glm::length(plane.normal());
    if (const auto s = plane.signs(h - rise, h + rise, plane.distance(centre) + r)) return *s;
    const Rational3 n = exact_normal(a, b, c);
    return around(dot(n, rational(centre) - rational(a)), Rational(r) * Rational(r) * dot(n, n));
}

dvec3 unit_normal(vec3 a, vec3 b, vec3 c) {
    const Rational3 n      = exact_normal(a, b, c);
    const Rational longest = std::max({CGAL::abs(n.x), CGAL::abs(n.y), CGAL::abs(n.z)});
    if (longest == 0) return dvec3(0);
    const auto part = [&](const Rational& x) { return CGAL::to_double(Rational(x / longest)); };
    return glm::normalize(dvec3(part(n.x), part(n.y), part(n.z)));
}

}  // namespace umbra
