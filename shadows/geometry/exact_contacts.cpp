#include "umbra/shadows/geometry/exact_contacts.h"

#include <algorithm>

namespace umbra::exact_visibility {
namespace {

int sign_of(const Rational& r) { return static_cast<int>(CGAL::sign(r)); }

std::array<Rational3, 3> exactly(const std::array<vec3, 3>& corner) {
    return {rational(corner[0]), rational(corner[1]), rational(corner[2])};
}

/// (b - a) x (c - a)
Rational3 normal_of(const std::array<Rational3, 3>& corner) {
    return cross(corner[1] - corner[0], corner[2] - corner[0]);
}

}  // namespace

Contacts::Contacts(const Segment& segment) : segment_(segment), direction_(segment.direction()) {
    while (direction_[axis_] == 0) ++axis_;
}

bool Contacts::same_direction(const Across& a, const Across& b) {
    return turn(a, b) == 0 && sign_of(a.x) == sign_of(b.x) && sign_of(a.y) == sign_of(b.y);
}

/// In the order of angles in [0, 2 pi).
bool Contacts::comes_before(const Across& a, const Across& b) {
    const auto is_below = [](const Across& d) { return d.y < 0 || (d.y == 0 && d.x < 0); };
    const bool a_below = is_below(a), b_below = is_below(b);
    return a_below != b_below ? b_below : turn(a, b) > 0;
}

/// Whether the directions just counterclockwise of the ray are in the wedge.
bool Contacts::goes_on_within(const Across& ray, const Wedge& wedge) {
    return same_direction(ray, wedge.from) || (turn(wedge.from, ray) > 0 && turn(ray, wedge.to) > 0);
}

/// The directions in both; none where these have no inside.
std::optional<Contacts::Wedge> Contacts::common(const Wedge& a, const Wedge& b) {
    const auto comes_within = [](const Across& ray, const Wedge& wedge) {
        return same_direction(ray, wedge.to) || (turn(wedge.from, ray) > 0 && turn(ray, wedge.to) > 0);
    };
    const bool begins_with_a = goes_on_within(a.from, b);
    if (!begins_with_a && !goes_on_within(b.from, a)) return std::nullopt;
    return Wedge{begins_with_a ? a.from : b.from, comes_within(a.to, b) ? a.to : b.to};
}

Contacts::Across Contacts::across(const Rational3& v) const {
    const std::size_t i = (axis_ + 1) % 3, j = (axis_ + 2) % 3;
    const Rational along = v[axis_] / direction_[axis_];
    return {v[i] - along * direction_[i], v[j] - along * direction_[j]};
}

/// The directions that lead from a position of a triangle into its inside. is_zero: which barycentric coordinates of
/// the position are 0. None where all directions do.
std::optional<Contacts::Wedge> Contacts::inside(const Corners& corner, std::array<bool, 3> is_zero) const {
    const auto zeros = std::ranges::count(is_zero, true);
    if (zeros == 0) return std::nullopt;
    const auto k              = static_cast<std::size_t>(std::ranges::find(is_zero, zeros == 1) - is_zero.begin());
    const Rational3 &opposite = corner[k], &p = corner[(k + 1) % 3], &q = corner[(k + 2) % 3];
    if (zeros == 1) {  // on the edge opposite of corner k
        const Across along = across(q - p);
        return turn(along, across(opposite - p)) > 0 ? left_of(along) : left_of({-along.x, -along.y});
    }
    const Across to_p = across(p - opposite), to_q = across(q - opposite);
    return turn(to_p, to_q) > 0 ? Wedge{to_p, to_q} : Wedge{to_q, to_p};
}

void Contacts::add(vec3 x, vec3 y, vec3 z, vec3 passes) {
    const Corners corner     = exactly({x, y, z});
    const Rational3 normal   = normal_of(corner);
    const Rational3& start   = segment_.start().exact();
    const bool runs_in_plane = dot(normal, direction_) == 0;
    if (dot(normal, start - corner[0]) == 0) {
        if (runs_in_plane)
            edge_on_ = true;
        else
            add_at_start(corner, normal, passes);
        return;
    }
    std::array<bool, 3> is_zero{};
    for (std::size_t k = 0; k < 3; ++k)
        is_zero[k] = sign_of_determinant(corner[(k + 1) % 3] - start, corner[(k + 2) % 3] - start, direction_) == 0;
    if (const auto wedge = inside(corner, is_zero)) between_.push_back({*wedge, passes});
}

/// A triangle on which the surface point lies. A position beside it, within the point's own triangle, sees the light
/// through the triangle where both are on different sides of its plane and the line between them meets its inside.
void Contacts::add_at_start(const Corners& corner, const Rational3& normal, vec3 passes) {
    begins_on_one_         = true;
    const Rational3& start = segment_.start().exact();
    std::array<bool, 3> is_zero{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Rational3& p = corner[(k + 1) % 3];
        is_zero[k]         = dot(normal, cross(corner[(k + 2) % 3] - p, start - p)) == 0;
    }
    const Corners own    = exactly(segment_.start().corners());
    const Across crease  = across(cross(normal_of(own), normal));
    const Rational3 edge = own[1] - own[0], other = own[2] - own[0];
    const Rational3& beside = turn(crease, across(edge)) != 0 ? edge : other;
    const bool beyond_left =
        (turn(crease, across(beside)) > 0) == (sign_of(dot(normal, beside)) == -sign_of(dot(normal, direction_)));
    const Wedge beyond = left_of(beyond_left ? crease : Across{-crease.x, -crease.y});
    const auto within  = inside(corner, is_zero);
    const auto covered = within ? common(*within, beyond) : beyond;
    if (covered) at_start_.push_back({*covered, passes});
}

/// Over the directions of a domain, all of them if it is none: those between two rays that follow one another have the
/// same covers.
Contacts::Together Contacts::around(std::span<const Cover> covers, const std::optional<Wedge>& domain) {
    if (covers.empty()) return {vec3(1), true};
    std::vector<Across> rays;
    for (const Cover& cover : covers) rays.insert(rays.end(), {cover.wedge.from, cover.wedge.to});
    if (domain) rays.insert(rays.end(), {domain->from, domain->to});
    std::ranges::sort(rays, comes_before);
    rays.erase(std::unique(rays.begin(), rays.end(), same_direction), rays.end());

    std::vector<int> blocked(rays.size() + 1, 0);  // changes from ray to ray
    std::vector<dvec3> passed(rays.size(), dvec3(1));
    for (const Cover& cover : covers) {
        const auto at = [&](const Across& ray) {
            return static_cast<std::size_t>(std::ranges::lower_bound(rays, ray, comes_before) - rays.begin());
        };
        const std::size_t from = at(cover.wedge.from), to = at(cover.wedge.to);
        if (cover.passes == vec3(0)) {
            ++blocked[from], --blocked[to];
            blocked[0] += to < from;
            continue;
        }
        for (std::size_t k = from; k != to; k = (k + 1) % rays.size()) passed[k] *= dvec3(cover.passes);
    }
    std::optional<Together> found;
    int blockers = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        blockers += blocked[k];
        if (domain && !goes_on_within(rays[k], *domain)) continue;
        const vec3 here = blockers > 0 ? vec3(0) : vec3(passed[k]);
        if (!found) found = Together{here, true};
        found->agreed = found->agreed && here == found->passed;
        found->passed = glm::max(found->passed, here);
    }
    return *found;
}

Contacts::Together Contacts::together() const {
    const ExactPoint& start = segment_.start();
    const Together between  = around(between_, std::nullopt);
    if (!begins_on_one_) {
        const bool seen_edge_on = edge_on_ && between.passed != vec3(0);
        return {between.passed, between.agreed && !seen_edge_on};
    }
    const Together from_start = around(at_start_, inside(exactly(start.corners()), start.is_zero()));
    const bool blocked        = between.agreed && between.passed == vec3(0);
    return {between.passed * from_start.passed, blocked};
}

}  // namespace umbra::exact_visibility
