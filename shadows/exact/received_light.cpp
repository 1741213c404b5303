#include "umbra/shadows/exact/received_light.h"

#include <boost/math/quadrature/gauss.hpp>

namespace umbra::exact_visibility {
namespace {

double squared(double x) { return x * x; }

/// The least distance of the origin from c + t e, -1 <= t <= 1.
double least_on_line(dvec3 c, dvec3 e) {
    const double ee = glm::dot(e, e), t = ee > 0 ? std::clamp(-glm::dot(c, e) / ee, -1.0, 1.0) : 0;
    return glm::length(c + t * e);
}

}  // namespace

ReceivedLight::ReceivedLight(const Sight& sight, const Horizon<double>& horizon) {
    const Entries centre = sight.viewpoint.point().to(sight.plane.centre_from_corner);
    const double size    = std::max({largest(centre.value), largest(sight.plane.u), largest(sight.plane.v)});
    centre_              = centre.value / size;
    u_                   = sight.plane.u / size;
    v_                   = sight.plane.v / size;
    const double tallest = std::abs(horizon.lx) + std::abs(horizon.ly) + std::abs(horizon.l);
    horizon_             = {horizon.lx / tallest, horizon.ly / tallest, horizon.l / tallest, 0, 0};

    // Each component of d is off by the centre's error, by that of a rounded plane, and by five roundings; |d|^-4 by
    // four times what |d| is off, in relation to it. Twice that, since this is of first order.
    const double axis     = std::max(glm::length(u_), glm::length(v_));
    const double off      = std::sqrt(3.0) * (centre.error / size + 10 * kUnit) + 2 * sight.plane.rounding * axis;
    const double distance = least_distance(sight.light.round());
    weight_error_         = distance > 0 ? 8 * off / distance + 32 * kUnit : double(kInfinity);
    // Heights have the error of the horizon's, and the plane's rounding times the length of the normal.
    const double height =
        horizon.error / tallest + 10 * kUnit + 2 * sight.plane.rounding * axis * size * horizon.normal / tallest;
    const double densest = (1 + 2 * kUsable) / squared(squared(distance));
    most_                = densest * std::max(0.0, horizon_.l + std::abs(horizon_.lx) + std::abs(horizon_.ly) + height);
    height_error_        = height * densest;
}

/// The distance of p from the light; of a disk from its circle, since its axes are perpendicular and equal.
double ReceivedLight::least_distance(bool round) const {
    const double uu = glm::dot(u_, u_), uv = glm::dot(u_, v_), vv = glm::dot(v_, v_);
    const double uc = -glm::dot(u_, centre_), vc = -glm::dot(v_, centre_), det = uu * vv - uv * uv;
    dvec2 foot = det > 0 ? dvec2(vv * uc - uv * vc, uu * vc - uv * uc) / det : dvec2(2);
    if (round)
        return glm::length(to(foot.x / std::max(1.0, glm::length(foot)), foot.y / std::max(1.0, glm::length(foot))));
    double least = std::min({least_on_line(centre_ - u_, v_), least_on_line(centre_ + u_, v_),
                             least_on_line(centre_ - v_, u_), least_on_line(centre_ + v_, u_)});
    if (std::abs(foot.x) <= 1 && std::abs(foot.y) <= 1) least = std::min(least, glm::length(to(foot.x, foot.y)));
    return least;
}

template <int kPoints>
double ReceivedLight::gauss(const Trapezoid& t) const {
    // Boost states the nodes of [0, 1]; each except 0 also represents its negative.
    const auto& nodes   = boost::math::quadrature::gauss<double, kPoints>::abscissa();
    const auto& weights = boost::math::quadrature::gauss<double, kPoints>::weights();
    const auto each     = [&](const auto& body) {
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            body(0.5 + 0.5 * nodes[k], 0.5 * weights[k]);
            if (nodes[k] > 0) body(0.5 - 0.5 * nodes[k], 0.5 * weights[k]);
        }
    };
    double sum = 0;
    each([&](double row, double row_weight) {
        const double y = t.low + row * (t.high - t.low), left = t.low_left + row * (t.high_left - t.low_left);
        const double width = std::max(0.0, t.low_right + row * (t.high_right - t.low_right) - left);
        double in_row      = 0;
        each([&](double across, double weight) {
            const double x = left + across * width;
            const dvec3 d  = to(x, y);
            in_row += weight * height(x, y) / squared(glm::dot(d, d));
        });
        sum += row_weight * width * in_row;
    });
    return sum * (t.high - t.low);
}

double ReceivedLight::split(const Trapezoid& t) const {
    const dvec3 corner[] = {to(t.low_left, t.low), to(t.low_right, t.low), to(t.high_left, t.high),
                            to(t.high_right, t.high)};
    const dvec3 middle   = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
    double reach         = 0;  // no line in the trapezoid is longer than twice that, nor its middle farther off
    for (const dvec3& c : corner) reach = std::max(reach, glm::length(c - middle));
    const double distance = glm::length(middle);
    if (distance >= 13 * reach) return gauss<7>(t);
    if (distance >= 5 * reach) return gauss<10>(t);
    if (splits_left_ == 0 || --splits_left_ == 0) return 0;
    const double wide       = std::max(glm::length(corner[1] - corner[0]), glm::length(corner[3] - corner[2]));
    const double tall       = glm::length(corner[2] + corner[3] - corner[0] - corner[1]) / 2;
    const double low_middle = (t.low_left + t.low_right) / 2, high_middle = (t.high_left + t.high_right) / 2;
    if (wide > tall)
        return split({t.low, t.high, t.low_left, low_middle, t.high_left, high_middle}) +
               split({t.low, t.high, low_middle, t.low_right, high_middle, t.high_right});
    const double y = (t.low + t.high) / 2, left = (t.low_left + t.high_left) / 2,
                 right = (t.low_right + t.high_right) / 2;
    return split({t.low, y, t.low_left, t.low_right, left, right}) +
           split({y, t.high, left, right, t.high_left, t.high_right});
}

/// The weight at the cap's centre of gravity times its area, and the bound of its error by second derivatives:
/// |w''| <= 8 |h'| / |d|^5 + 20 h / |d|^6. Of a cap that is not all visible, up to its most.
Bracket ReceivedLight::cap(int k, bool visible) const {
    constexpr double kHalf = kPi / DiskCaps::kChords;  // half the angle
    static const double from_centre =
        2 * std::sin(kHalf) * squared(std::sin(kHalf)) / (3 * (kHalf - std::sin(kHalf) * std::cos(kHalf)));
    static const double extent = 1.01 * std::sin(kHalf);  // no point of the cap is farther from the centre of gravity
    const double angle = 2 * kHalf * (k + 0.5), x = from_centre * std::cos(angle), y = from_centre * std::sin(angle);
    const double radius = glm::length(u_), away = extent * radius, middle = glm::length(to(x, y)), near = middle - away;
    const double slope = horizon_.slope() / radius, tall = height(x, y) + slope * away;
    const double most = near > 0 ? std::min(most_, tall / squared(squared(near))) : most_;
    if (!visible || !(near > 0)) return {0, DiskCaps::cap_area() * most};
    const double bend = (8 * slope / near + 20 * tall / squared(near)) / squared(squared(near));
    const double at = height(x, y) / squared(squared(middle)), doubt = bend * squared(away) / 2;
    return {DiskCaps::cap_area() * std::max(0.0, at - doubt), DiskCaps::cap_area() * std::min(at + doubt, most)};
}

Bracket ReceivedLight::of(const DiskCaps& caps) const {
    Bracket sum;
    for (int k = 0; k < DiskCaps::kChords; ++k) {
        if (!caps.is_open(k) && !caps.is_visible(k)) continue;
        const Bracket one = cap(k, caps.is_visible(k));
        sum.low += one.low;
        sum.high += one.high;
    }
    return sum;
}

Bracket fraction(const Bracket& visible, const Bracket& whole) {
    if (!(whole.low > 0)) return {0, 1};
    return {std::clamp(visible.low / whole.high, 0.0, 1.0), std::clamp(visible.high / whole.low, 0.0, 1.0)};
}

}  // namespace umbra::exact_visibility
