// With the receiver's corners a, b, c, its sides p = b - a and q = c - a, its normal n = p x q:
//
// A point light is at l, g = l - a. The line from it through x = l + d meets the plane where a + u p + v q = l + s d:
//     u = d . (q x g) / w,   v = d . (g x p) / w,   w = -d . n,   height(x) = n . g - w.
// A directional light is in direction l, d = x - a. The line x - s l meets the plane where
//     u = d . (q x l) / w,   v = d . (l x p) / w,   w = n . l,    height(x) = d . n.
// All of them change their sign where n . g or n . l is negative, so that height is positive towards the light.
#include "umbra/shadows/atherton/receiver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "umbra/core/base/predicates.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/geometry/exact_point.h"

namespace umbra::atherton {

using exact_visibility::kUnit;
using exact_visibility::largest;

namespace {

Exact3 exact(vec3 v) { return {Exact(double(v.x)), Exact(double(v.y)), Exact(double(v.z))}; }
Exact3 operator-(const Exact3& a, const Exact3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Exact dot(const Exact3& a, const Exact3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Exact3 cross(const Exact3& a, const Exact3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Exact3 turned(const Exact3& a, bool turn) { return turn ? Exact3{-a[0], -a[1], -a[2]} : a; }

/// As `clip`, in double: the part of a segment, from 0 to 1, in which no linear function is surely negative, or not above
/// 0 at either end.
struct MayBeKept {
    double first = 0, last = 1;

    /// What it is at most at both ends.
    void keep(double at_a, double at_b) {
        if (at_a <= 0 && at_b <= 0) last = -1;
        // The rounding of the quotient is relative, since the two have different signs.
        if (at_a < 0) first = std::max(first, at_a / (at_a - at_b));
        if (at_b < 0) last = std::min(last, at_a / (at_a - at_b));
    }
    [[nodiscard]] bool empty() const { return first > last + 0x1p-48; }
};

}  // namespace

Receiver::Receiver(const Scene& scene, TriangleId t, const Light& light)
    : a_(scene.vertex(t, 0)),
      b_(scene.vertex(t, 1)),
      c_(scene.vertex(t, 2)),
      infinite_(light.kind == LightKind::directional) {
    light_    = infinite_ ? -light.direction : light.position;
    from_     = infinite_ ? a_ : light_;
    mirrored_ = side_of_light(light, a_, b_, c_) < 0;

    const dvec3 p = dvec3(b_) - dvec3(a_), q = dvec3(c_) - dvec3(a_), l(light_), g = infinite_ ? l : l - dvec3(a_);
    const double turn = mirrored_ ? -1 : 1, P = largest(p), Q = largest(q), G = largest(g);
    // A component of a cross product: two products of rounded differences, and their difference. An offset: three
    // products of such components with g.
    const dvec3 n             = turn * glm::cross(p, q);
    const double light_height = glm::dot(n, g), slip = 48 * kUnit * P * Q * G;
    u_      = {turn * glm::cross(q, g), 0, 12 * kUnit * Q * G, 0};
    v_      = {turn * glm::cross(g, p), 0, 12 * kUnit * G * P, 0};
    height_ = {n, infinite_ ? 0 : light_height, 12 * kUnit * P * Q, slip};
    rest_   = {-(u_.normal + v_.normal), infinite_ ? light_height : 0, u_.error + v_.error, slip};
    if (!infinite_) {
        rest_.normal -= n;
        rest_.error += height_.error;
    }
    rest_.error += kUnit * largest(rest_.normal) * 4;
}

const Receiver::ExactForms& Receiver::exact_forms() const {
    if (exact_) return *exact_;
    const Exact3 p = exact(b_) - exact(a_), q = exact(c_) - exact(a_),
                 g = infinite_ ? exact(light_) : exact(light_) - exact(a_), n = turned(cross(p, q), mirrored_);
    return exact_.emplace(
        ExactForms{exact(from_), turned(cross(q, g), mirrored_), turned(cross(g, p), mirrored_), n, dot(n, g)});
}

int Receiver::side(vec3 q) const {
    const int s = side_of_plane(a_, b_, c_, q);
    return mirrored_ ? -s : s;
}

Projected Receiver::project(vec3 q) const {
    const ExactForms& forms = exact_forms();
    const Exact3 d          = exact(q) - forms.from;
    const Exact n           = dot(forms.normal, d);
    if (infinite_) return {dot(forms.u, d), dot(forms.v, d), forms.light_height, n};
    return {dot(forms.u, d), dot(forms.v, d), -n, forms.light_height + n};
}

std::pair<double, double> Receiver::Form::at(dvec3 d) const {
    const double D = largest(d);
    // The components' errors, and three products and sums of numbers that are each rounded once.
    return {glm::dot(normal, d) + offset,
            3 * error * D + 24 * kUnit * largest(normal) * D + slip + 4 * kUnit * std::abs(offset)};
}

bool Receiver::may_cover(vec3 a, vec3 b) const {
    const dvec3 da = dvec3(a) - dvec3(from_), db = dvec3(b) - dvec3(from_);
    MayBeKept part;
    for (const Form* form : {&u_, &v_, &rest_, &height_}) part.keep(form->most(da), form->most(db));
    return !part.empty();
}

// A corner of the receiver lies on two of its borders: a where u = v = 0, b where v = rest = 0, c where u = rest = 0.
bool Receiver::may_meet(const std::array<vec3, 3>& position, const std::array<int, 3>& corner) const {
    const std::array<std::pair<const Form*, int>, 3> borders{{{&u_, 1}, {&v_, 2}, {&rest_, 0}}};
    return std::ranges::none_of(borders, [&](const auto& border) {
        const auto& [form, opposite] = border;
        for (std::size_t k = 0; k < 3; ++k) {
            const bool on_it = corner[k] >= 0 && corner[k] != opposite;
            if (!on_it && !(form->most(dvec3(position[k]) - dvec3(from_)) < 0)) return false;
        }
        return true;
    });
}

/// The border that is opposite to a corner, at a passage: at most this, and infinite where that is not known.
double Receiver::most(const Form& border, int opposite, const Passage& passage) const {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    if (passage.corner >= 0) return passage.corner == opposite ? kInfinite : 0;
    const dvec3 p = dvec3(passage.above) - dvec3(from_), q = dvec3(passage.below) - dvec3(from_);
    if (passage.below_in_plane) return border.most(q);
    const auto [high, high_off] = height_.at(p);
    const auto [low, low_off]   = height_.at(q);
    const auto [at_p, at_p_off] = border.at(p);
    const auto [at_q, at_q_off] = border.at(q);
    const double fall = high - low, off = high_off + low_off;
    if (!(fall > 4 * off)) return kInfinite;
    return at_p + high / fall * (at_q - at_p) +
           2 * (at_p_off + at_q_off + std::abs(at_q - at_p) * (2 * off / fall + 8 * kUnit));
}

bool Receiver::may_cut(const Passage& a, const Passage& b) const {
    MayBeKept part;
    part.keep(most(u_, 1, a), most(u_, 1, b));
    part.keep(most(v_, 2, a), most(v_, 2, b));
    part.keep(most(rest_, 0, a), most(rest_, 0, b));
    return !part.empty();
}

/// The plane with a normal of length 1, which its tilt refers to; a plane of which nothing is known holds everything.
BoxTree::Region::Plane Receiver::Form::plane(double& tilt) const {
    const double length = glm::length(normal);
    if (!(error < 1e-3 * length)) return {dvec3(0), 0};
    tilt = std::max(tilt, error / length + 4 * kUnit);
    return {normal / length, (offset + slip) / length + 1e-14 * std::abs(offset) / length};
}

BoxTree::Region Receiver::region(const Form& last) const {
    BoxTree::Region region;
    region.from   = dvec3(from_);
    region.planes = {u_.plane(region.tilt), v_.plane(region.tilt), rest_.plane(region.tilt), height_.plane(region.tilt),
                     last.plane(region.tilt)};
    return region;
}

BoxTree::Region Receiver::towards_light() const { return region({}); }

BoxTree::Region Receiver::itself() const {
    Form below = height_;
    below.normal *= -1.0;
    below.offset *= -1;
    return region(below);
}

Projected between(const Projected& a, const Projected& b, const Exact& t) {
    return {a.u + t * (b.u - a.u), a.v + t * (b.v - a.v), a.w + t * (b.w - a.w), a.height + t * (b.height - a.height)};
}

std::optional<std::pair<Projected, Projected>> clip(const Projected& a, const Projected& b, bool in_plane) {
    Exact first = 0, last = 1;
    const auto keep = [&](const Exact& at_a, const Exact& at_b) {
        if (at_a <= 0 && at_b <= 0) return false;
        if (at_a < 0) first = std::max(first, Exact(at_a / (at_a - at_b)));
        if (at_b < 0) last = std::min(last, Exact(at_a / (at_a - at_b)));
        return first < last;
    };
    if (!keep(a.u, b.u) || !keep(a.v, b.v) || !keep(a.w - a.u - a.v, b.w - b.u - b.v)) return std::nullopt;
    if (!in_plane && !keep(a.height, b.height)) return std::nullopt;
    return std::pair{first > 0 ? between(a, b, first) : a, last < 1 ? between(a, b, last) : b};
}

}  // namespace umbra::atherton
