#include "umbra/shadows/soft/light_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/rounding.h"

namespace umbra::soft {
namespace {

constexpr double kUnit     = 0x1p-24;       ///< of rounding to float
constexpr double kReach    = 1 + 1.0 / 16;  ///< edges are cut at the square |x|, |y| <= kReach
constexpr double kDoubt    = 1.0 / 64;      ///< an edge over the light whose doubt is above this decides nothing
constexpr double kGrazing  = 0x1p-12;       ///< sine of the angle to the light's plane below which nothing is projected
constexpr double kNearest  = 0x1p-13;       ///< rays of samples that count have started at this distance, in ray space
constexpr double kRounded  = 0x1p-20;       ///< more than rounding moves a point in ray space
constexpr double kFar      = 0x1p60;        ///< of lights farther than this nothing is projected
constexpr double kEnd      = rays::kTraced;  ///< W where rays end
constexpr double kEndDoubt = 0x1p-18;        ///< of W where a ray meets a triangle: 64 roundings

/// A segment's part, from its beginning 0 to its end 1.
struct Stretch {
    double from = 0, to = 1;
    [[nodiscard]] bool empty() const { return !(from < to); }

    /// Leaves what is inside a half-space, where a linear function with values `a` and `b` at the ends is positive.
    void cut(double a, double b) {
        if (a > 0 && b > 0) return;
        if (!(a > 0) && !(b > 0))
            to = from;
        else if (!(a > 0))
            from = std::max(from, a / (a - b));
        else
            to = std::min(to, a / (a - b));
    }
};

}  // namespace

LightView::LightView(const rays::Starts& starts, int lane, const rays::SeenLight& seen, const rays::Target& light)
    : o_(starts.x[lane], starts.y[lane], starts.z[lane]),
      u_(dvec3(seen.axis_u) * light.unit),
      v_(dvec3(seen.axis_v) * light.unit) {
    const dvec3 c = dvec3(seen.to_centre) * light.unit, normal = glm::cross(u_, v_);
    const double height = glm::dot(normal, c), distance = glm::length(c);
    if (!(std::abs(height) > kGrazing * glm::length(normal) * distance) || light.unit > kFar) return;
    usable_      = true;
    gx_          = glm::cross(v_, c) / height;
    gy_          = glm::cross(c, u_) / height;
    gw_          = normal / height;
    orientation_ = height > 0 ? -1 : 1;  // u turns left to v for who looks against u x v
    span_        = distance + glm::length(u_) + glm::length(v_);
    stretch_     = glm::length(gx_) + glm::length(gy_) + 2 * kReach * glm::length(gw_);

    // A ray starts where it has risen by `lift` above the point's plane, at W = lift / rise.
    const dvec3 n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
    const double lift   = starts.height[lane];
    const double spread = std::abs(glm::dot(n, u_)) + std::abs(glm::dot(n, v_)) + 8 * kUnit * span_;
    const double rise   = glm::dot(n, c) - spread;
    const double latest = kNearest / std::max(span_, 8 * kNearest);  // W where rays of samples that count may start
    all_in_front_       = rise * latest > lift;
    nearest_            = 2 * (all_in_front_ ? lift / rise : latest);
    start_              = 0.5 * lift / std::max(glm::dot(n, c) + spread, 1e-30);
    start_reach_        = std::max(2 * nearest_ * span_, kRounded);
    latest_start_       = static_cast<float>(latest * light.unit);
}

void LightView::set_shaft(Shafts& shafts, std::size_t lane) const {
    constexpr double reach = kReach * (1 + 0x1p-10);
    const dvec3 wide       = reach * gw_;
    const dvec3 normals[]  = {wide + gx_, wide - gx_, wide + gy_, wide - gy_, -gw_};
    shafts.set_point(lane, vec3(o_));
    for (std::size_t k = 0; k < Shafts::kPlanes; ++k) shafts.set(lane, k, normals[k], o_, k == 4 ? 1 : 0);
}

std::optional<FlatEdge> LightView::flatten(const LightEdge& edge) const {
    const dvec3 a = place(edge.a), b = place(edge.b);
    FlatEdge flat;
    Stretch part;
    part.cut(a.z - start_, b.z - start_);
    part.cut(kEnd - a.z, kEnd - b.z);
    if (part.empty()) return flat;
    const Stretch before = part;  // the light
    const auto at        = [&](double t) {
        const dvec3 q = t == 0 ? a : t == 1 ? b : a + t * (b - a);
        return vec2(dvec2(q) * (1 / q.z));
    };
    part.cut(a.x + kReach * a.z, b.x + kReach * b.z);
    if (part.empty()) return flat;
    // Where it comes in from the left, what lies to its left lies above.
    if (part.from > before.from) flat.entry += orientation_, flat.entry_y = at(part.from).y;
    if (part.to < before.to) flat.entry -= orientation_, flat.entry_y = at(part.to).y;
    part.cut(kReach * a.z - a.x, kReach * b.z - b.x);
    part.cut(a.y + kReach * a.z, b.y + kReach * b.z);
    part.cut(kReach * a.z - a.y, kReach * b.z - b.y);
    if (part.empty()) return flat;
    const double least = std::min(a.z + part.from * (b.z - a.z), a.z + part.to * (b.z - a.z));
    const double most  = std::max(a.z + part.from * (b.z - a.z), a.z + part.to * (b.z - a.z));
    if (least < nearest_ || most > kEnd - kEndDoubt) return std::nullopt;

    // How far rounding moves a sample and an edge apart, in (x, y), with u = 2^-24. The factor below exceeds what each
    // term needs, times three, since a triangle seen edge-on may turn over and take an edge of its own width away.
    //   ends of rays, and ends of edges here, are rounded a few times: u of their length, u of kReach;
    //   Embree rounds corners less the ray's start, each by u of that, which moves what lies between them no more;
    //   of them it computes (e x s) . d for the edge e and the sum s of its ends. Each factor, product and sum is off
    //   by a few u of |e| |s| |d|, its own tolerance by u of the triangle's area.
    const dvec3 first = dvec3(edge.a) - o_, last = dvec3(edge.b) - o_, e = last - first, s = first + last;
    const dvec3 n      = glm::cross(e, s);
    const double slope = std::abs(glm::dot(n, u_)) + std::abs(glm::dot(n, v_));  // of (e x s) . d, at most its root 2
    const double far   = std::max(sum_of_magnitudes(first), sum_of_magnitudes(last));
    const double doubt = 16 * kUnit *
                         (kReach + span_ * stretch_ + far * stretch_ / least +
                          2 * sum_of_magnitudes(e) * (sum_of_magnitudes(s) + 2) * span_ / slope);
    if (!(doubt < kDoubt)) return std::nullopt;

    flat.is_there = true;
    flat.doubt    = static_cast<float>(doubt);
    flat.low      = at(part.from);
    flat.high     = at(part.to);
    flat.step     = -orientation_;
    if (flat.high.y < flat.low.y) std::swap(flat.low, flat.high), flat.step = -flat.step;
    return flat;
}

bool FlatEdge::cuts(LightKind kind) const {
    if (!is_there) return false;
    const float margin = 1 + 2 * doubt + 0x1p-16f;
    if (kind == LightKind::rectangle)
        return std::min(low.x, high.x) < margin && std::max(low.x, high.x) > -margin && low.y < margin &&
               high.y > -margin;
    const vec2 along    = high - low;
    const float nearest = glm::clamp(-glm::dot(low, along) / std::max(glm::dot(along, along), 1e-30f), 0.0f, 1.0f);
    const vec2 closest  = low + nearest * along;
    return glm::dot(closest, closest) < margin * margin;
}

bool LightView::may_end_within(vec3 a, vec3 b, vec3 c) const {
    const std::array<dvec3, 3> corner{place(a), place(b), place(c)};
    dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    const auto extend_by = [&](dvec3 q) {
        low  = glm::min(low, dvec2(q) / q.z);
        high = glm::max(high, dvec2(q) / q.z);
    };
    for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 &p = corner[k], &q = corner[(k + 1) % 3];
        Stretch part;
        part.cut(p.z - (kEnd - kEndDoubt), q.z - (kEnd - kEndDoubt));
        part.cut(kEnd + kEndDoubt - p.z, kEnd + kEndDoubt - q.z);
        if (part.empty()) continue;
        extend_by(p + part.from * (q - p));
        extend_by(p + part.to * (q - p));
    }
    return low.x <= kReach && low.y <= kReach && high.x >= -kReach && high.y >= -kReach;
}

}  // namespace umbra::soft
