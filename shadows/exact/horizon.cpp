#include "umbra/shadows/exact/horizon.h"

namespace umbra::exact_visibility {

template <>
Horizon<double> horizon_of(const Sight& sight) {
    const Scene& scene   = sight.viewpoint.scene();
    const TriangleId own = sight.viewpoint.own();
    const dvec3 a(scene.vertex(own, 0)), ab = dvec3(scene.vertex(own, 1)) - a, ac = dvec3(scene.vertex(own, 2)) - a;
    const dvec3 m = glm::cross(ab, ac) * static_cast<double>(sight.turn);
    const dvec3 u = sight.plane.u, v = sight.plane.v;
    const Entries& centre = sight.plane.centre_from_corner;
    // m's components are off by their products' entries and roundings; a height is a sum of nine products with m.
    const double m_size = largest(m), m_error = 10 * kUnit * largest(ab) * largest(ac);
    const double reach = largest(u) + largest(v) + largest(centre.value);
    const double error =
        3 * (m_error * reach + m_size * (centre.error + 2 * sight.plane.axis_error)) + 15 * kUnit * m_size * reach;
    return {glm::dot(m, u), glm::dot(m, v), glm::dot(m, centre.value), error, glm::length(m)};
}

template <>
Horizon<Rational> horizon_of(const Sight& sight) {
    const Scene& scene   = sight.viewpoint.scene();
    const TriangleId own = sight.viewpoint.own();
    const Rational3 a    = rational(scene.vertex(own, 0));
    const Rational3 m    = cross(rational(scene.vertex(own, 1)) - a, rational(scene.vertex(own, 2)) - a);
    const Rational turn(sight.turn);
    const auto [u, v, centre] = in_rationals(sight.plane, sight.viewpoint.point());
    const double length       = glm::length(dvec3(CGAL::to_double(m[0]), CGAL::to_double(m[1]), CGAL::to_double(m[2])));
    return {turn * dot(m, u), turn * dot(m, v), turn * dot(m, centre - a), 0, length};
}

}  // namespace umbra::exact_visibility
