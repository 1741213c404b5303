#include "umbra/shadows/shared/light_image.h"

#include <algorithm>
#include <cmath>

namespace umbra::binned_shadows_detail {
namespace {

/// More than places and corners may be off by rounding, in parts of a face; far less than a point's distance from its
/// neighbour.
constexpr double kMargin = 1e-9;

constexpr double kRounding = 0x1p-53;

/// Points that are nearer to the light than this share of their coordinates have places that are off by more than
/// kMargin / 4: positions are off by a few roundings of these coordinates.
constexpr double kNear = 2e-6;

/// Triangles that come nearer to the light than this share of their size, as seen from it, are not cut: corners of the
/// outline are off by a few roundings of that size, which must stay far below kMargin of their distance.
constexpr double kNearTriangle = 1e-5;

double size(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// The distance of the origin from a segment.
double distance(dvec3 a, dvec3 b) {
    const dvec3 ab      = b - a;
    const double square = glm::dot(ab, ab);
    const double t      = square > 0 ? std::clamp(-glm::dot(a, ab) / square, 0.0, 1.0) : 0;
    return glm::length(a + t * ab);
}

/// Whether the origin is about as near to a triangle as `limit`, or nearer: 2 limit is near, 4 limit is not. `limit` is
/// far above roundings of the corners.
bool is_near(const std::array<dvec3, 3>& c, double limit) {
    for (int k = 0; k < 3; ++k)  // most are far away along some axis
        if (std::min({c[0][k], c[1][k], c[2][k]}) > 2 * limit || std::max({c[0][k], c[1][k], c[2][k]}) < -2 * limit)
            return false;
    if (std::min({distance(c[0], c[1]), distance(c[1], c[2]), distance(c[2], c[0])}) <= 2 * limit) return true;
    const dvec3 normal  = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double length = glm::length(normal);
    if (!(length > 0) || std::abs(glm::dot(normal, c[0])) > 2 * limit * length) return false;
    // Above the plane, and not near an edge: it is on one side of all edges, or outside.
    bool positive = false, negative = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const double side                = glm::dot(normal, glm::cross(c[k], c[(k + 1) % 3]));
        (side > 0 ? positive : negative) = true;
    }
    return !(positive && negative);
}

/// A convex polygon in a face's (x, y, w), cut down to four half spaces.
class Outline {
public:
    explicit Outline(const std::array<dvec3, 3>& corners) : count_(3) {
        std::copy(corners.begin(), corners.end(), corners_.begin());
    }
    /// Keeps what has dot(g, corner) >= 0.
    void keep(dvec3 g) {
        std::array<dvec3, kMost> kept;
        std::size_t n = 0;
        for (std::size_t k = 0; k < count_; ++k) {
            const dvec3 a = corners_[k], b = corners_[(k + 1) % count_];
            const double at_a = glm::dot(g, a), at_b = glm::dot(g, b);
            if (at_a >= 0) kept[n++] = a;
            if ((at_a < 0) != (at_b < 0)) kept[n++] = a + at_a / (at_a - at_b) * (b - a);
        }
        corners_ = kept, count_ = n;
    }
    [[nodiscard]] std::size_t size() const { return count_; }
    [[nodiscard]] dvec3 operator[](std::size_t k) const { return corners_[k]; }

private:
    static constexpr std::size_t kMost = 8;  // each of four cuts adds one corner
    std::array<dvec3, kMost> corners_{};
    std::size_t count_;
};

}  // namespace

LightImage::LightImage(const Light& light, dvec3 centre, double reach)
    : infinite_(light.kind == LightKind::directional),
      reach_(reach),
      origin_(infinite_ ? centre : dvec3(light.position)) {
    if (!infinite_) return;
    const dvec3 d      = glm::normalize(dvec3(light.direction));
    const dvec3 across = glm::normalize(glm::cross(d, std::abs(d.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
    axes_              = {across, glm::cross(d, across), d};
}

dvec3 LightImage::in_face(int face, dvec3 p) const {
    const dvec3 d = p - origin_;
    if (infinite_) return {glm::dot(d, axes_[0]), glm::dot(d, axes_[1]), glm::dot(d, axes_[2])};
    const int k = face / 2;
    return {d[(k + 1) % 3], d[(k + 2) % 3], face % 2 == 0 ? d[k] : -d[k]};
}

std::optional<LightImage::Place> LightImage::place(dvec3 p) const {
    if (infinite_) {
        const dvec3 q = in_face(0, p);
        return Place{0, dvec2(q), q.z};
    }
    const dvec3 d = p - origin_, along = glm::abs(d);
    if (size(d) <= kNear * std::max(size(p), size(origin_))) return std::nullopt;
    const int k    = along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
    const int face = 2 * k + (d[k] < 0 ? 1 : 0);
    const dvec3 q  = in_face(face, p);
    if (!(q.z > 0)) return std::nullopt;
    return Place{face, dvec2(q) / q.z, q.z};
}

std::optional<Extent> LightImage::extent(int face, const std::array<dvec3, 3>& corners) const {
    std::array<dvec3, 3> q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = in_face(face, corners[k]);
    if (infinite_) {
        const dvec3 low = glm::min(q[0], glm::min(q[1], q[2])), high = glm::max(q[0], glm::max(q[1], q[2]));
        const dvec3 margin = kMargin * glm::max(glm::abs(low), glm::abs(high)) + 64 * kRounding * reach_;
        return Extent{dvec2(low - margin), dvec2(high + margin), low.z - margin.z};
    }
    if (q[0].z <= 0 && q[1].z <= 0 && q[2].z <= 0) return std::nullopt;  // signs of differences of floats are exact
    Outline outline(q);
    const bool is_within =
        std::ranges::all_of(q, [](dvec3 c) { return c.z > 0 && std::abs(c.x) <= c.z && std::abs(c.y) <= c.z; });
    if (!is_within && is_near(q, kNearTriangle * std::max({size(q[0]), size(q[1]), size(q[2])})))
        return Extent{dvec2(-2), dvec2(2), 0};
    if (!is_within)  // wider than the face by the margin, for points on its border
        for (const dvec3 g :
             {dvec3(1, 0, 1 + kMargin), dvec3(-1, 0, 1 + kMargin), dvec3(0, 1, 1 + kMargin), dvec3(0, -1, 1 + kMargin)})
            if (outline.size() > 0) outline.keep(g);
    if (outline.size() == 0) return std::nullopt;
    dvec2 low(2), high(-2);
    double depth = outline[0].z;
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const dvec3 c  = outline[k];
        const dvec2 at = dvec2(c) / c.z;
        low            = glm::min(low, at);
        high           = glm::max(high, at);
        depth          = std::min(depth, c.z);
    }
    return Extent{low - 4 * kMargin, high + 4 * kMargin, depth * (1 - 4 * kMargin)};
}

}  // namespace umbra::binned_shadows_detail
