#include "umbra/bench/studies/light/formula_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace umbra {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// a t^2 + 2 b t + c <= 0. Up to two passages: where a < 0, before the first root and after the second. The root of
/// larger magnitude is computed first and gives the other.
Passages below_zero(double a, double b, double c) {
    if (a == 0) {
        if (b == 0) return c <= 0 ? Passages{{{{-kEndless, kEndless}}}, 1} : Passages{};
        const double root = -c / (2 * b);
        return {{{b > 0 ? Passage{-kEndless, root} : Passage{root, kEndless}}}, 1};
    }
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return a > 0 ? Passages{} : Passages{{{{-kEndless, kEndless}}}, 1};
    const double q         = -(b + std::copysign(std::sqrt(discriminant), b));
    const auto [near, far] = q == 0 ? std::pair(0.0, 0.0) : std::pair(std::min(q / a, c / q), std::max(q / a, c / q));
    if (a > 0) return {{{{near, far}}}, 1};
    return {{{{-kEndless, near}, {far, kEndless}}}, 2};
}

/// The part of those passages where |z| <= half; of two the longer one: of a double cone's halves one lies in the slab,
/// and the other touches it at most.
std::optional<Passage> within_slab(const Passages& passages, double origin, double direction, double half) {
    Passage slab{-kEndless, kEndless};
    if (direction != 0)
        slab = {std::min((-half - origin) / direction, (half - origin) / direction),
                std::max((-half - origin) / direction, (half - origin) / direction)};
    else if (std::abs(origin) > half)
        return std::nullopt;
    std::optional<Passage> longest;
    for (int k = 0; k < passages.count; ++k) {
        const Passage& passage = passages.list[static_cast<std::size_t>(k)];
        const Passage part{std::max(passage.enter, slab.enter), std::min(passage.leave, slab.leave)};
        if (part.enter <= part.leave && (!longest || part.leave - part.enter > longest->leave - longest->enter))
            longest = part;
    }
    return longest;
}

/// c[0] + c[1] t + ... + c[degree] t^degree.
struct AlongLine {
    std::array<double, 5> c{};
    std::size_t degree = 0;

    [[nodiscard]] double at(double t) const {
        double value = c[degree];
        for (std::size_t k = degree; k-- > 0;) value = value * t + c[k];
        return value;
    }
    [[nodiscard]] AlongLine derivative() const {
        AlongLine d{{}, degree - 1};
        for (std::size_t k = 1; k <= degree; ++k) d.c[k - 1] = static_cast<double>(k) * c[k];
        return d;
    }
};

/// Where the polynomial changes its sign, ascending.
struct SignChanges {
    std::array<double, 4> at{};
    std::size_t count = 0;
};
SignChanges sign_changes(const AlongLine& p, double low, double high) {
    const SignChanges turns = p.degree == 1 ? SignChanges{} : sign_changes(p.derivative(), low, high);
    SignChanges found;
    double from = low;
    for (std::size_t k = 0; k <= turns.count; ++k) {
        const double to = k < turns.count ? turns.at[k] : high;
        double a = from, b = to;
        from             = to;
        const bool rises = p.at(a) < 0;
        if (rises == (p.at(b) < 0)) continue;
        for (double middle = 0.5 * a + 0.5 * b; middle > a && middle < b; middle = 0.5 * a + 0.5 * b)
            (rises == (p.at(middle) < 0) ? a : b) = middle;
        found.at[found.count++] = b;
    }
    return found;
}

}  // namespace

std::optional<Passage> through_sphere(dvec3 origin, dvec3 direction, dvec3 centre, double radius) {
    const dvec3 from = origin - centre;
    const Passages inside =
        below_zero(glm::dot(direction, direction), glm::dot(from, direction), glm::dot(from, from) - radius * radius);
    return inside.count > 0 ? std::optional(inside.list[0]) : std::nullopt;
}

std::optional<Passage> through_box(dvec3 origin, dvec3 direction, dvec3 least, dvec3 greatest) {
    Passage passage{-kEndless, kEndless};
    for (int k = 0; k < 3; ++k) {
        if (direction[k] == 0) {
            if (origin[k] < least[k] || origin[k] > greatest[k]) return std::nullopt;
            continue;
        }
        const double one = (least[k] - origin[k]) / direction[k], other = (greatest[k] - origin[k]) / direction[k];
        passage.enter = std::max(passage.enter, std::min(one, other));
        passage.leave = std::min(passage.leave, std::max(one, other));
    }
    if (passage.enter > passage.leave) return std::nullopt;
    return passage;
}

std::optional<Passage> through_cylinder(dvec3 origin, dvec3 direction, double radius, double half) {
    const dvec2 o(origin), d(direction);
    return within_slab(below_zero(glm::dot(d, d), glm::dot(o, d), glm::dot(o, o) - radius * radius), origin.z,
                       direction.z, half);
}

std::optional<Passage> through_cone(dvec3 origin, dvec3 direction, double radius, double half) {
    // x^2 + y^2 <= (k (half - z))^2; the other half of the double cone is above the slab.
    const double k = radius / (2 * half), h = half - origin.z;
    const dvec2 o(origin), d(direction);
    return within_slab(below_zero(glm::dot(d, d) - k * k * direction.z * direction.z,
                                  glm::dot(o, d) + k * k * h * direction.z, glm::dot(o, o) - k * k * h * h),
                       origin.z, direction.z, half);
}

Passages through_torus(dvec3 origin, dvec3 direction, double major, double minor) {
    // From the place on the line that is nearest to the centre, along a unit direction: numbers of the torus' size.
    const double length = glm::length(direction), reach = major + minor;
    const dvec3 d       = direction / length;
    const double middle = -glm::dot(origin, d);
    const dvec3 o       = origin + middle * d;
    const double square = glm::dot(o, o), half_square = reach * reach - square;
    if (!(half_square > 0)) return {};
    // (t^2 + s)^2 - 4 major^2 (a t^2 + 2 b t + c), o.d = 0.
    const dvec2 o2(o), d2(d);
    const double s = square + major * major - minor * minor, by = 4 * major * major;
    const AlongLine p{{s * s - by * glm::dot(o2, o2), -2 * by * glm::dot(o2, d2), 2 * s - by * glm::dot(d2, d2), 0, 1},
                      4};
    const double end          = std::sqrt(half_square) * (1 + 1e-9) + 1e-9 * reach;
    const SignChanges changes = sign_changes(p, -end, end);
    Passages passages;
    for (std::size_t k = 0; k + 1 < changes.count; k += 2)
        passages.list[static_cast<std::size_t>(passages.count++)] = {(middle + changes.at[k]) / length,
                                                                     (middle + changes.at[k + 1]) / length};
    return passages;
}

std::optional<double> first_meeting(const std::optional<Passage>& passage, double least) {
    if (!passage) return std::nullopt;
    if (passage->enter > least) return passage->enter;
    if (passage->leave > least) return passage->leave;
    return std::nullopt;
}

}  // namespace umbra
