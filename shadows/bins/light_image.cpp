#include "umbra/shadows/bins/light_image.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/lanes.h"
#include "umbra/shadows/geometry/clipped_polygon.h"

namespace umbra::bins {
namespace {

/// More than places and corners may be off by rounding, in parts of a face; far less than a point's distance from its
/// neighbour.
constexpr double kMargin = 1e-9;

constexpr double kRounding = 0x1p-53;

/// From the middle of one face to that of the next: a face reaches from -1 to 1, and a little farther.
constexpr double kApart = 4;
dvec2 middle(int face) { return {kApart * face, 0}; }

/// Roundings of the largest coordinate of a triangle's corners that one of a point's coordinates is off by, at most.
constexpr double kRoundings = 8;

/// Triangles nearer to the light than this fraction of their size, as seen from it, are not cut: corners of the outline
/// have errors of a few roundings of that size, which must stay far below kMargin of their distance.
constexpr double kNearTriangle = 1e-5;

double size(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Whether the origin is about as near to a triangle as `limit`, or nearer: 2 limit is near, 4 limit is not. `limit` is
/// far above roundings of the corners.
bool is_near(const std::array<dvec3, 3>& c, double limit) {
    for (int k = 0; k < 3; ++k)  // most are far away along some axis
        if (std::min({c[0][k], c[1][k], c[2][k]}) > 2 * limit || std::max({c[0][k], c[1][k], c[2][k]}) < -2 * limit)
            return false;
    for (std::size_t k = 0; k < 3; ++k)
        if (distance_to_segment(dvec3(0), c[k], c[(k + 1) % 3]) <= 2 * limit) return true;
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

std::optional<Extent> LightImage::extent(int face, const std::array<dvec3, 3>& corners) const {
    std::array<dvec3, 3> q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = in_cube_face(face, corners[k] - origin_);
    if (q[0].z <= 0 && q[1].z <= 0 && q[2].z <= 0) return std::nullopt;  // signs of differences of floats are exact
    ClippedPolygon<dvec3, 8> outline{.corners = {q[0], q[1], q[2]}, .count = 3};
    const bool is_within =
        std::ranges::all_of(q, [](dvec3 c) { return c.z > 0 && std::abs(c.x) <= c.z && std::abs(c.y) <= c.z; });
    if (!is_within && is_near(q, kNearTriangle * std::max({size(q[0]), size(q[1]), size(q[2])})))
        return Extent{middle(face) - dvec2(kApart / 2), middle(face) + dvec2(kApart / 2), 0};
    if (!is_within)  // wider than the face by the margin, for points on its border
        for (const dvec3 g :
             {dvec3(1, 0, 1 + kMargin), dvec3(-1, 0, 1 + kMargin), dvec3(0, 1, 1 + kMargin), dvec3(0, -1, 1 + kMargin)})
            outline.cut<CutFrom::first>([g](dvec3 p) { return glm::dot(g, p); });
    if (outline.count == 0) return std::nullopt;
    dvec2 low(2), high(-2);
    double depth = outline.corners[0].z;
    for (std::size_t k = 0; k < outline.count; ++k) {
        const dvec3 c  = outline.corners[k];
        const dvec2 at = dvec2(c) / c.z;
        low            = glm::min(low, at);
        high           = glm::max(high, at);
        depth          = std::min(depth, c.z);
    }
    return Extent{middle(face) + low - 4 * kMargin, middle(face) + high + 4 * kMargin, depth * (1 - 4 * kMargin)};
}

namespace {

/// The face that a direction from the light points to, by its largest coordinate; without branches.
struct FaceOf {
    bool is_x, is_y, is_negative;

    FaceOf(double x, double y, double z) {
        const double along_x = std::abs(x), along_y = std::abs(y), along_z = std::abs(z);
        is_x        = (along_x >= along_y) & (along_x >= along_z);
        is_y        = !is_x & (along_y >= along_z);
        is_negative = depth(x, y, z) < 0;
    }
    /// The coordinates of any direction: along the face's axis, not turned, and across.
    [[nodiscard]] double depth(double x, double y, double z) const { return is_x ? x : is_y ? y : z; }
    [[nodiscard]] double u(double x, double y, double z) const { return is_x ? y : is_y ? z : x; }
    [[nodiscard]] double v(double x, double y, double z) const { return is_x ? z : is_y ? x : y; }
    [[nodiscard]] double number() const { return (is_x ? 0.0 : is_y ? 2.0 : 4.0) + (is_negative ? 1.0 : 0.0); }
};

}  // namespace

// Compiled so that loops over lanes become vector code: shadows/CMakeLists.txt.
UMBRA_FOR_EACH_PROCESSOR void LightImage::places(const Corners& corners, const float (&u)[kLanes],
                                                 const float (&v)[kLanes], Places& to) const {
    const auto position = [&](std::size_t axis, double* at) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double a = corners[0][axis][i], b = corners[1][axis][i], c = corners[2][axis][i];
            at[i]             = a + static_cast<double>(u[i]) * (b - a) + static_cast<double>(v[i]) * (c - a);
            const double ab   = std::abs(a) > std::abs(b) ? std::abs(a) : std::abs(b);
            to.slack[axis][i] = kRoundings * kRounding * (ab > std::abs(c) ? ab : std::abs(c));
        }
    };
    position(0, to.x), position(1, to.y), position(2, to.z);
    if (infinite_) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double x = to.x[i] - origin_.x, y = to.y[i] - origin_.y, z = to.z[i] - origin_.z;
            to.u[i]     = static_cast<float>(x * axes_[0].x + y * axes_[0].y + z * axes_[0].z);
            to.v[i]     = static_cast<float>(x * axes_[1].x + y * axes_[1].y + z * axes_[1].z);
            to.depth[i] = static_cast<float>(x * axes_[2].x + y * axes_[2].y + z * axes_[2].z);
            to.face[i]  = 0;
        }
        return;
    }
    const double at_origin = kRoundings * kRounding * size(origin_);
    for (std::size_t i = 0; i < kLanes; ++i) {
        const double x = to.x[i] - origin_.x, y = to.y[i] - origin_.y, z = to.z[i] - origin_.z;
        const FaceOf of(x, y, z);
        const double farthest = std::abs(of.depth(x, y, z));
        const double sx = to.slack[0][i], sy = to.slack[1][i], sz = to.slack[2][i];
        const double xy = sx > sy ? sx : sy, xyz = xy > sz ? xy : sz, slack = xyz > at_origin ? xyz : at_origin;
        const double face = of.number(), per_w = 1 / farthest;
        to.u[i]     = static_cast<float>(kApart * face + of.u(x, y, z) * per_w);
        to.v[i]     = static_cast<float>(of.v(x, y, z) * per_w);
        to.depth[i] = static_cast<float>(farthest);
        // Nearer to the light a place is off by more than kMargin / 4.
        to.face[i] = farthest > 4 / kMargin * slack ? static_cast<std::int32_t>(face) : -1;
    }
}

UMBRA_FOR_EACH_PROCESSOR unsigned LightImage::extents(const Corners& corners, Extents& to) const {
    return infinite_ ? infinite_extents(corners, to) : cube_extents(corners, to);
}

UMBRA_FOR_EACH_PROCESSOR void LightImage::travel(const Corners& corners, Corners& to) const {
    for (std::size_t c = 0; c < 3; ++c)
        for (int axis = 0; axis < 3; ++axis)
            for (std::size_t i = 0; i < kLanes; ++i)
                to[c][axis][i] = infinite_ ? axes_[2][axis] : corners[c][axis][i] - origin_[axis];
}

// The sign of a determinant. Its factors are off by at most 4 roundings each (a direction is divided by its length),
// and 6 more happen to each of its 6 products.
UMBRA_FOR_EACH_PROCESSOR LightImage::Windings LightImage::windings(const Corners& corners) const {
    const double from_position = infinite_ ? 0 : 1;
    const dvec3 along = infinite_ ? axes_[2] : dvec3(0), origin = from_position * origin_;
    Windings w;
    double value[kLanes], bound[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) {
        const double ax = corners[0][0][i], ay = corners[0][1][i], az = corners[0][2][i];
        const double bx = corners[1][0][i] - ax, by = corners[1][1][i] - ay, bz = corners[1][2][i] - az;
        const double cx = corners[2][0][i] - ax, cy = corners[2][1][i] - ay, cz = corners[2][2][i] - az;
        const double tx = along.x + (from_position * ax - origin.x), ty = along.y + (from_position * ay - origin.y),
                     tz = along.z + (from_position * az - origin.z);
        const double yz = by * cz, zy = bz * cy, zx = bz * cx, xz = bx * cz, xy = bx * cy, yx = by * cx;
        value[i] = (yz - zy) * tx + (zx - xz) * ty + (xy - yx) * tz;
        bound[i] = 32 * kRounding *
                   ((std::abs(yz) + std::abs(zy)) * std::abs(tx) + (std::abs(zx) + std::abs(xz)) * std::abs(ty) +
                    (std::abs(xy) + std::abs(yx)) * std::abs(tz));
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
        w.towards |= static_cast<unsigned>(value[i] < -bound[i]) << i;
        w.away |= static_cast<unsigned>(value[i] > bound[i]) << i;
    }
    return w;
}

unsigned LightImage::infinite_extents(const Corners& corners, Extents& to) const {
    for (std::size_t i = 0; i < kLanes; ++i) {
        double low[3], high[3];
        for (std::size_t k = 0; k < 3; ++k) {
            double at[3];
            for (std::size_t c = 0; c < 3; ++c)
                at[c] = (corners[c][0][i] - origin_.x) * axes_[k].x + (corners[c][1][i] - origin_.y) * axes_[k].y +
                        (corners[c][2][i] - origin_.z) * axes_[k].z;
            const double low2 = at[0] < at[1] ? at[0] : at[1], high2 = at[0] < at[1] ? at[1] : at[0];
            low[k] = low2 < at[2] ? low2 : at[2], high[k] = high2 > at[2] ? high2 : at[2];
            const double most   = std::abs(low[k]) > std::abs(high[k]) ? std::abs(low[k]) : std::abs(high[k]);
            const double margin = kMargin * most + 64 * kRounding * reach_;
            low[k] -= margin, high[k] += margin;
        }
        to.low_u[i] = static_cast<float>(low[0]), to.high_u[i] = static_cast<float>(high[0]);
        to.low_v[i] = static_cast<float>(low[1]), to.high_v[i] = static_cast<float>(high[1]);
        to.depth[i] = static_cast<float>(low[2]);
    }
    return 0xff;
}

unsigned LightImage::cube_extents(const Corners& corners, Extents& to) const {
    unsigned ones = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const dvec3 first(corners[0][0][i] - origin_.x, corners[0][1][i] - origin_.y, corners[0][2][i] - origin_.z);
        const FaceOf of(first.x, first.y, first.z);
        const double sign = of.is_negative ? -1.0 : 1.0;
        double low_u = 2, high_u = -2, low_v = 2, high_v = -2, depth = std::abs(of.depth(first.x, first.y, first.z));
        bool within = true;
        for (std::size_t c = 0; c < 3; ++c) {
            const double dx = corners[c][0][i] - origin_.x, dy = corners[c][1][i] - origin_.y,
                         dz = corners[c][2][i] - origin_.z;
            const double w = sign * of.depth(dx, dy, dz), qu = of.u(dx, dy, dz), qv = of.v(dx, dy, dz);
            const double most = w * (1 - 4 * kMargin), across = std::abs(qu), down = std::abs(qv);
            within         = within & (across < most) & (down < most);
            const double u = qu / w, v = qv / w;
            low_u = low_u < u ? low_u : u, high_u = high_u > u ? high_u : u;
            low_v = low_v < v ? low_v : v, high_v = high_v > v ? high_v : v;
            depth = depth < w ? depth : w;
        }
        const double middle_u = kApart * of.number();
        to.low_u[i]           = within ? static_cast<float>(middle_u + low_u - 4 * kMargin) : Extents::kFar;
        to.high_u[i]          = within ? static_cast<float>(middle_u + high_u + 4 * kMargin) : -Extents::kFar;
        to.low_v[i]           = within ? static_cast<float>(low_v - 4 * kMargin) : Extents::kFar;
        to.high_v[i]          = within ? static_cast<float>(high_v + 4 * kMargin) : -Extents::kFar;
        to.depth[i]           = within ? static_cast<float>(depth * (1 - 4 * kMargin)) : 0.0f;
    }
    for (std::size_t i = 0; i < kLanes; ++i) ones |= static_cast<unsigned>(!to.empty(i)) << i;
    return ones;
}

}  // namespace umbra::bins
