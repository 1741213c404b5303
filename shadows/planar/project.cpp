#include "umbra/shadows/planar/project.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/base/rounding.h"
#include "umbra/core/render/light_points.h"
#include "umbra/core/render/sampling.h"
#include "umbra/shadows/geometry/point_tree.h"

namespace umbra::planar {
namespace {

constexpr std::size_t kRun = 4096;  ///< triangles
constexpr double kUlp      = 0x1p-53;

}  // namespace

// ---- receivers and sources ------------------------------------------------------------------------------------------

Receiver make_receiver(const Scene& scene, const PlanarReceiver& plane, std::uint32_t index, int side) {
    const Axes axes = axes_across(plane.normal);
    const dvec3 corner(scene.vertex(plane.triangles[0], 0));
    Receiver r;
    r.plane  = index;
    r.e1     = axes.u;
    r.e2     = static_cast<double>(side) * axes.v;  // the other side is turned up about e1
    r.normal = static_cast<double>(side) * plane.normal;
    r.origin = corner - plane.normal * (glm::dot(plane.normal, corner) - plane.offset);
    for (const TriangleId t : plane.triangles)
        for (int k = 0; k < 3; ++k) {
            const dvec3 x = r.local(dvec3(scene.vertex(t, k)));
            r.low         = glm::min(r.low, dvec2(x));
            r.high        = glm::max(r.high, dvec2(x));
            r.tolerance   = std::max(r.tolerance, std::abs(x.z));
        }
    return r;
}

Source centre_of(const Light& light) {
    if (light.kind == LightKind::directional) return {true, -light.direction};
    return {false, light.position};
}

/// A sphere is seen as a disk from everywhere: points of the ball with density 1 / sqrt(1 - r^2) fill that disk evenly
/// in every direction, and they are what points spread evenly over the unit sphere of four dimensions are, less their
/// fourth coordinate.
std::vector<Source> sources_of(const Light& light, int samples) {
    if (!is_area(light.kind) || samples == 1) return {centre_of(light)};

    std::vector<Source> sources;
    const DiskAxes disk = light.kind == LightKind::disk ? disk_axes(light) : DiskAxes{};
    const SampleSet set(Sampler::sobol, samples, 0);
    for (int first = 0; first < samples; first += 8) {
        Samples8 eight;
        set.eight(set.key(0), first, eight);
        if (light.kind == LightKind::disk) map_to_disk(eight);
        for (int i = 0; i < std::min(8, samples - first); ++i) {
            const double x = static_cast<double>(eight.x[i]), y = static_cast<double>(eight.y[i]);
            dvec3 offset{0};
            if (light.kind == LightKind::rectangle)
                offset = (x - 0.5) * dvec3(light.edge_u) + (y - 0.5) * dvec3(light.edge_v);
            else if (light.kind == LightKind::disk)
                offset = -(x * disk.u + y * disk.v);
            else {
                const double angle = 2 * kPi * ((first + i + 0.5) / samples), r = std::sqrt(x), q = std::sqrt(1 - x);
                offset = static_cast<double>(light.radius) *
                         dvec3(r * std::cos(2 * kPi * y), r * std::sin(2 * kPi * y), q * std::cos(angle));
            }
            sources.push_back({false, vec3(dvec3(light.position) + offset)});
        }
    }
    return sources;
}

// ---- clipping and projecting ----------------------------------------------------------------------------------------

namespace {

/// The part of a triangle at and above a height over the plane, a convex polygon.
/// [Ivan Sutherland, Gary Hodgman, Reentrant Polygon Clipping, 1974]
std::vector<dvec3> clip_below(const Triangle& triangle, double height) {
    std::vector<dvec3> kept;
    for (std::size_t k = 0; k < 3; ++k) {
        dvec3 a = triangle[k], b = triangle[(k + 1) % 3];
        if (a.z >= height) kept.push_back(a);
        if ((a.z < height && b.z > height) || (a.z > height && b.z < height)) {
            if (comes_before(b, a)) std::swap(a, b);
            const dvec3 cut = a + (b - a) * ((a.z - height) / (a.z - b.z));
            kept.emplace_back(cut.x, cut.y, height);
        }
    }
    return kept;
}

}  // namespace

Reach reach_of(const Receiver& receiver, const LocalSource& source) {
    const double span  = source.at_infinity ? glm::length(source.at)
                                            : glm::length(source.at - dvec3(receiver.low, 0)) +
                                                 glm::length(receiver.high - receiver.low);
    const double slope = span / std::max(source.at.z - (source.at_infinity ? 0 : receiver.tolerance), 1e-300);
    const dvec2 slack(receiver.tolerance * slope);
    return {receiver.low - slack, receiver.high + slack};
}

namespace {

/// Bounds of the shadow of a triangle over the plane.
Reach bounds_of_shadow(const LocalSource& source, const Triangle& triangle) {
    Reach bounds;
    for (const dvec3 x : triangle) {
        if (!source.at_infinity && x.z >= source.at.z)  // the shadow runs off to infinity
            return {dvec2(-kInfinity), dvec2(+kInfinity)};
        const dvec2 q = source.project(x);
        // Far above the rounding of q, which grows as the ray to it flattens.
        const double height = source.at_infinity ? source.at.z : source.at.z - x.z;
        const double length = glm::length(source.at_infinity ? source.at : source.at - x);
        const dvec2 e       = 1e-14 * (1 + length / height) * (glm::abs(dvec2(x)) + glm::abs(q));
        bounds.low          = glm::min(bounds.low, q - e);
        bounds.high         = glm::max(bounds.high, q + e);
    }
    return bounds;
}

/// Adds the shadow of a triangle over the plane, unless it misses `reach`. The part of the triangle above the source is
/// not cut away: rays from the source to it do not come down to the plane. A piece's corners may be off by `slack`, its
/// shadow by `margin`.
void add_shadow(Shadows& run, const Reach& reach, const LocalSource& source, const Triangle& triangle, Shadow shadow,
                double slack, double margin) {
    Reach bounds = bounds_of_shadow(source, triangle);
    bounds.low   = glm::max(bounds.low - margin, reach.low);
    bounds.high  = glm::min(bounds.high + margin, reach.high);
    if (bounds.low.x > bounds.high.x || bounds.low.y > bounds.high.y) return;
    shadow.low  = {float_below(bounds.low.x), float_below(bounds.low.y)};
    shadow.high = {float_above(bounds.high.x), float_above(bounds.high.y)};
    if (shadow.is_piece) {
        run.piece_of.push_back(shadow.triangle);
        shadow.triangle = static_cast<std::uint32_t>(run.pieces.size());
        run.pieces.push_back(triangle);
        run.slack.push_back(slack);
    }
    run.shadows.push_back(shadow);
}

/// Adds the shadow of triangle t, cut at the plane where it crosses it. One that is not between plane and source has
/// none, and neither has one that the source sees edge-on: that shadow is a line, all boundary.
void project_triangle(Shadows& run, const Scene& scene, TriangleId t, const Receiver& receiver, const Reach& reach,
                      const Source& from, const LocalSource& source) {
    const Triangle x = local_triangle(scene, t, receiver);
    const double low = std::min({x[0].z, x[1].z, x[2].z}), high = std::max({x[0].z, x[1].z, x[2].z});
    const double size  = std::max({sum_of_magnitudes(x[0]), sum_of_magnitudes(x[1]), sum_of_magnitudes(x[2])});
    const double doubt = receiver.doubt_of_height(size);
    if (high + doubt <= 0 || (!source.at_infinity && low - doubt >= source.at.z)) return;

    const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
    const int facing = from.at_infinity ? side_of_direction(a, b, c, from.at) : side_of_plane(a, b, c, from.at);
    if (facing == 0) return;

    Shadow shadow;
    shadow.triangle    = t;
    shadow.from_behind = facing < 0;
    if (low - doubt >= 0) {
        add_shadow(run, reach, source, x, shadow, 0, 0);
        return;
    }
    shadow.is_piece = true;
    // A height that is off moves the cut along the triangle, and its shadow along the ray.
    const double length = sum_of_magnitudes(source.at), along = source.at_infinity ? 0 : 2 * size;
    const double above   = source.at.z - (source.at_infinity ? 0 : std::max(0.0, high));
    const double slope   = above > 0 ? 2 + (length + along) / above : kInfinity;
    const auto add_above = [&](double height, double slack, double margin) {
        const auto polygon = clip_below(x, height);
        for (std::size_t k = 2; k < polygon.size(); ++k)
            add_shadow(run, reach, source, {polygon[0], polygon[k - 1], polygon[k]}, shadow, slack, margin);
    };
    if (high <= 2 * doubt) {
        // It is below the plane but for what is as near to it as heights are known: so are the sides of a box beside
        // one of them. If there is a shadow, it is of that part.
        shadow.may_be_none = true;
        add_above(-2 * doubt, 16 * kUlp * size + 4 * doubt, 4 * doubt * slope);
        return;
    }
    const double slack = 16 * kUlp * size + 4 * doubt * (1 + 2 * size / (high - low));
    add_above(0, slack, slack * slope);
}

}  // namespace

std::vector<Shadows> project(const Occluders& occluders, std::span<const TriangleId> triangles,
                             const Receiver& receiver, const Source& from) {
    const LocalSource source(receiver, from);
    if (!source.is_above()) return {};
    const Reach reach   = reach_of(receiver, source);
    const std::size_t n = triangles.size();
    std::vector<Shadows> runs((n + kRun - 1) / kRun);
    parallel_ranges(runs.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r) {
            for (const TriangleId t : triangles.subspan(r * kRun, std::min(kRun, n - r * kRun)))
                if (occluders.plane_of[t] != receiver.plane)
                    project_triangle(runs[r], *occluders.scene, t, receiver, reach, from, source);
            runs[r].shadows.shrink_to_fit();
            runs[r].pieces.shrink_to_fit();
            runs[r].slack.shrink_to_fit();
            runs[r].piece_of.shrink_to_fit();
        }
    });
    return runs;
}

std::size_t Shadows::memory_bytes() const {
    return sizeof(Shadows) + shadows.size() * sizeof(Shadow) +
           pieces.size() * (sizeof(Triangle) + sizeof(TriangleId) + sizeof(double));
}

// ---- what a shadow holds --------------------------------------------------------------------------------------------

/// Only differences of near points meet the large ones of a far source.
EdgeFunction side_of_edge(const LocalSource& source, dvec3 from, dvec3 to, double sign) {
    if (comes_before(to, from)) {
        std::swap(from, to);
        sign = -sign;
    }
    const dvec3 n = sign * glm::cross(source.at_infinity ? -source.at : from - source.at, to - from);
    return {n.x, n.y, -glm::dot(n, from)};
}

double farthest(const Reach& reach) {
    const dvec2 far = glm::max(glm::abs(reach.low), glm::abs(reach.high));
    return 2 * (far.x + far.y);
}

/// It is dot(n, p - from) with n = cross(f, t), f from the source to `from`, t from there to `to`. Coordinates are sums
/// of three products, so that both ends and the source are off by up to 4 roundings of their magnitudes; that moves n
/// by 4 roundings of (|from| + |s|) |t| + (|from| + |to|) |f|, and each step of the arithmetic by one of |f| |t|, 14 in
/// all. Ends that are off by more move n by slack (|t| + 2 |f|), and p - from by slack.
double doubt_of_side(const LocalSource& source, dvec3 from, dvec3 to, double far, double slack) {
    const double s    = sum_of_magnitudes(source.at);
    const double ends = sum_of_magnitudes(from) + sum_of_magnitudes(to) + 2 * slack;
    const double f    = (source.at_infinity ? s : sum_of_magnitudes(from - source.at)) + slack,
                 t    = sum_of_magnitudes(to - from) + 2 * slack;
    const double n    = f * t + (ends + s) * t + ends * f;
    return (16 * kUlp * n + slack * (t + 2 * f)) * (far + ends) + slack * f * t;
}

std::array<ShadowSide, 3> sides_of(const Scene& scene, const Receiver& receiver, const LocalSource& source,
                                   const Shadows& run, const Shadow& shadow, double far) {
    const Triangle x = shadow.is_piece ? run.pieces[shadow.triangle] : local_triangle(scene, shadow.triangle, receiver);
    const double slack = shadow.is_piece ? run.slack[shadow.triangle] : 0;
    // Inside, det(a - source, b - a, p - a) has the sign of the triangle seen from behind.
    const double sign = shadow.from_behind ? 1 : -1;
    const auto side   = [&](dvec3 a, dvec3 b) {
        return ShadowSide{side_of_edge(source, a, b, sign), doubt_of_side(source, a, b, far, slack)};
    };
    return {side(x[0], x[1]), side(x[1], x[2]), side(x[2], x[0])};
}

TriangleId first_over(const Scene& scene, const Receiver& receiver, const LocalSource& source,
                      std::span<const Shadows> runs, dvec2 at) {
    const vec2 place(at);
    const double far  = farthest(reach_of(receiver, source));
    const auto in_box = [&](const Shadow& s) {
        return place.x >= s.low.x && place.x <= s.high.x && place.y >= s.low.y && place.y <= s.high.y;
    };
    for (const Shadows& run : runs)
        for (const Shadow& shadow : run.shadows) {
            if (!in_box(shadow)) continue;
            const std::array<ShadowSide, 3> sides = sides_of(scene, receiver, source, run, shadow, far);
            if (std::ranges::all_of(sides, [&](const ShadowSide& e) { return e.value.at(at.x, at.y) >= 0; }))
                return run.caster(shadow);
        }
    return kNoTriangle;
}

}  // namespace umbra::planar
