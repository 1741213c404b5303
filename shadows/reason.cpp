#include "umbra/shadows/reason.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/light_points.h"

namespace umbra {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kLightPoints = 256;  ///< of an area light, tried in turn until the blocker hides one

struct Corners {
    dvec3 a, b, c;
};

Corners corners(const Scene& scene, TriangleId t) {
    return {dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))};
}

/// The least distance of two segments. [Christer Ericson, Real-Time Collision Detection, 2005, section 5.1.9]
double distance_of_segments(dvec3 p1, dvec3 q1, dvec3 p2, dvec3 q2) {
    const dvec3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
    const double a = glm::dot(d1, d1), e = glm::dot(d2, d2), f = glm::dot(d2, r), c = glm::dot(d1, r),
                 b = glm::dot(d1, d2);
    if (e == 0) return distance_to_segment(p2, p1, q1);
    const double det = a * e - b * b;
    double s         = det > 0 ? std::clamp((b * f - c * e) / det, 0.0, 1.0) : 0;
    double t         = (b * s + f) / e;
    if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0;
    }
    return glm::length(p1 + s * d1 - p2 - t * d2);
}

double distance_from_segment(const Corners& t, dvec3 p, dvec3 q) {
    return std::min({distance_of_segments(p, q, t.a, t.b), distance_of_segments(p, q, t.b, t.c),
                     distance_of_segments(p, q, t.c, t.a), distance_to_triangle(p, t.a, t.b, t.c),
                     distance_to_triangle(q, t.a, t.b, t.c)});
}

bool touch(const Scene& scene, TriangleId a, TriangleId b) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (scene.vertex(a, i) == scene.vertex(b, j)) return true;
    return false;
}

/// The least distance of the segment from triangles that block and do not touch `own`; infinite where there are none.
double clearance(const Scene& scene, TriangleId own, dvec3 p, dvec3 q) {
    double least = kInfinite;
    std::mutex mutex;
    parallel_ranges(scene.triangles.size(), 16384, [&](std::size_t begin, std::size_t end) {
        double mine = kInfinite;
        for (auto t = static_cast<TriangleId>(begin); t < end; ++t) {
            const Corners k    = corners(scene, t);
            const dvec3 centre = (k.a + k.b + k.c) / 3.0;
            const double radius =
                std::sqrt(std::max({glm::dot(k.a - centre, k.a - centre), glm::dot(k.b - centre, k.b - centre),
                                    glm::dot(k.c - centre, k.c - centre)}));
            if (distance_to_segment(centre, p, q) - radius >= mine) continue;
            if (t == own || !scene.blocks(t) || touch(scene, own, t)) continue;
            mine = std::min(mine, distance_from_segment(k, p, q));
        }
        const std::lock_guard lock(mutex);
        least = std::min(least, mine);
    });
    return least;
}

}  // namespace

std::string_view to_string(PointVerdict verdict) {
    constexpr std::string_view kNames[]{"lit", "penumbra", "umbra", "on_boundary", "undefined"};
    return kNames[static_cast<std::size_t>(verdict)];
}

PointVerdict verdict_of(Given given) {
    if (given.answer == Answer::undefined) return PointVerdict::undefined;
    if (given.answer == Answer::on_boundary) return PointVerdict::on_boundary;
    return given.s >= 1 ? PointVerdict::lit : given.s <= 0 ? PointVerdict::umbra : PointVerdict::penumbra;
}

dvec3 segment_end(const Scene& scene, const Light& light, dvec3 p) {
    if (light.kind != LightKind::directional) return dvec3(light.position);
    const Box box   = bounds(scene);
    const dvec3 d   = -glm::normalize(dvec3(light.direction));
    const dvec3 low = dvec3(box.min) - p, high = dvec3(box.max) - p;
    double leaves = kInfinite;
    for (int k = 0; k < 3; ++k)
        if (d[k] != 0) leaves = std::min(leaves, std::max(low[k] / d[k], high[k] / d[k]));
    return p + std::max(leaves, 1e-6 * glm::length(dvec3(box.max - box.min))) * d;
}

std::optional<double> crossing(const Scene& scene, TriangleId t, dvec3 p, dvec3 q) {
    const auto [a, b, c] = corners(scene, t);
    const dvec3 d = q - p, n = glm::cross(b - a, c - a);
    const double slope = glm::dot(n, d);
    if (slope == 0) return std::nullopt;
    const double at = glm::dot(n, a - p) / slope;
    const dvec3 x   = p + at * d;
    const double u = glm::dot(n, glm::cross(b - a, x - a)), v = glm::dot(n, glm::cross(c - b, x - b)),
                 w = glm::dot(n, glm::cross(a - c, x - c));
    if (!(at > 0 && at < 1) || std::min({u, v, w}) < 0) return std::nullopt;
    return at;
}

Reason reason_by_geometry(const Scene& scene, const PointBatch& points, std::size_t i, LightId light, Given given,
                          TriangleId blocker) {
    const Light& source = scene.lights[light];
    const dvec3 p       = exact_position(scene, points, i);
    Reason reason{verdict_of(given), blocker};
    reason.towards = segment_end(scene, source, p);
    reason.margin  = static_cast<double>(given.s) - 0.5;
    reason.unit    = "of the light";
    if (blocker != kNoTriangle) {
        reason.at = crossing(scene, blocker, p, reason.towards);
        for (int k = 0; k < kLightPoints && !reason.at && is_area(source.kind); ++k) {
            const dvec3 sample = light_point(source, p, k);
            reason.at          = crossing(scene, blocker, p, sample);
            if (reason.at) reason.towards = sample;
        }
    }
    if (is_area(source.kind) || given.answer != Answer::given) return reason;
    if (given.s >= 1) {
        const double room = clearance(scene, points.triangle[i], p, reason.towards);
        if (room > 0 && room < kInfinite) reason.margin = room, reason.unit = "world";
    } else if (reason.at) {
        const auto [a, b, c] = corners(scene, blocker);
        const dvec3 x        = p + *reason.at * (reason.towards - p);
        const double inside =
            std::min({distance_to_segment(x, a, b), distance_to_segment(x, b, c), distance_to_segment(x, c, a)});
        if (inside > 0) reason.margin = -inside, reason.unit = "world";
    }
    return reason;
}

void add_samples(Reason& reason, int samples, Given given) {
    if (reason.verdict == PointVerdict::undefined) return;
    const double seen = std::round(static_cast<double>(given.s) * samples);
    reason.margin     = seen - 0.5 * samples;
    reason.unit       = "samples";
    reason.evidence.push_back({"samples", static_cast<double>(samples), "samples"});
    reason.evidence.push_back({"samples seen", seen, "samples"});
}

}  // namespace umbra
