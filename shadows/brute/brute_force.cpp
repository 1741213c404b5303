// Brute force: every surface point against every triangle. No tree, no map, no cleverness: the cost is points times
// triangles, which is what every other method saves. Short enough to be copied as the start of a new method.
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// Herbert Edelsbrunner, Ernst Muecke. Simulation of Simplicity. 1990
#include <fmt/format.h>

#include <tuple>
#include <utility>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/light_points.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

struct Options {
    int samples       = 16;
    int max_triangles = 20000;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::samples>({.name        = "samples",
                                  .doc         = "Segments from a point to an area light; other lights take one.",
                                  .unit        = "segments a point",
                                  .phase       = Phase::visibility,
                                  .min         = 1,
                                  .max         = 4096,
                                  .sweep       = "4|16|64",
                                  .area_lights = true}),
    parameter<&Options::max_triangles>({.name  = "max_triangles",
                                        .doc   = "Scenes of more triangles are not served: a picture would take hours.",
                                        .phase = Phase::build,
                                        .min   = 1,
                                        .max   = 50000000}),
};

/// On which side the ray p + t d passes the edge from a to b, -1 or 1. Both triangles of a shared edge compute the same
/// number. Where that is 0, the side is that of a ray turned by a little, the same for all edges: a ray through an edge
/// inside a surface meets one of its triangles, not none or two.
int side_of_edge(dvec3 p, dvec3 d, dvec3 a, dvec3 b) {
    const bool swapped = std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z);
    if (swapped) std::swap(a, b);
    const dvec3 across = glm::cross(a - p, b - a);
    double side        = glm::dot(across, d);
    for (int k = 0; k < 3 && side == 0; ++k) side = across[k];
    return (side > 0) == swapped ? -1 : 1;
}

/// Whether the open segment p + t d, 0 < t < end, passes through the triangle.
bool crosses(dvec3 p, dvec3 d, double end, dvec3 a, dvec3 b, dvec3 c) {
    const dvec3 n      = glm::cross(b - a, c - a);
    const double slope = glm::dot(n, d);
    if (slope == 0) return false;  // the segment runs along the triangle's plane
    const double t = glm::dot(n, a - p) / slope;
    if (!(t > 0 && t < end)) return false;
    const int side = side_of_edge(p, d, a, b);
    return side_of_edge(p, d, b, c) == side && side_of_edge(p, d, c, a) == side;
}

/// Triangles that take any of the light that meets them.
struct Occluders final : Built {
    using Built::Built;
    [[nodiscard]] std::size_t memory_bytes() const override { return triangles.size() * sizeof(TriangleId); }
    std::vector<TriangleId> triangles;
};

class BruteForce final : public MethodWith<Options> {
public:
    explicit BruteForce(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (facts.triangles > static_cast<std::uint64_t>(options.max_triangles))
            return {How::not_at_all, fmt::format("{} triangles, and each point would be tested against all of them; "
                                                 "max_triangles={}",
                                                 facts.triangles, options.max_triangles)};
        if (facts.hard_lights_only) return {How::to_rounding, "Every point against every triangle, in double."};
        return {How::approximately, fmt::format("Area lights are sampled at {} points.", options.samples)};
    }

    [[nodiscard]] bool multiplies() const override { return true; }

    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        auto occluders = std::make_unique<Occluders>(scene, facts);
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (scene.lets_through(t) != vec3(1)) occluders->triangles.push_back(t);
        return occluders;
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const PointBatch& points = looked.points;
        const int samples        = samples_of(aimed.source());
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (!points.asks(aimed.light, i)) continue;
                vec3 sum(0);
                for (int k = 0; k < samples; ++k) {
                    const Segment s = segment(aimed, points, i, k);
                    if (!s.behind) sum += passed(aimed, s);
                }
                sum /= static_cast<float>(samples);
                out.s[i] = mean_of(sum);
                if (!out.colour.empty()) out.colour[i] = sum;
            }
        });
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const PointBatch& points = looked.points;
        const int samples        = samples_of(aimed.source());
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                blockers[i] = kNoTriangle;
                if (!points.asks(aimed.light, i)) continue;
                for (int k = 0; k < samples && blockers[i] == kNoTriangle; ++k)
                    blockers[i] = first_blocker(aimed, segment(aimed, points, i, k));
            }
        });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason = Method::explain(aimed, looked, i, given);
        if (is_area(aimed.source().kind)) {
            add_samples(reason, options.samples, given);
            return reason;
        }
        const Segment s     = segment(aimed, looked.points, i, 0);
        std::size_t crossed = 0;
        for (const TriangleId t : as<Occluders>(aimed.built).triangles) crossed += is_crossed(aimed.scene(), t, s);
        reason.evidence.push_back({"triangles crossed", static_cast<double>(crossed)});
        return reason;
    }

private:
    /// The points p + t d, 0 < t < end.
    struct Segment {
        dvec3 p, d;
        double end;
        bool behind;     ///< runs behind the plane of the point's triangle: that part of the light is not seen
        TriangleId own;  ///< the point's triangle
        int side;        ///< of it, that sees: 1 where its winding faces, else -1
    };

    [[nodiscard]] int samples_of(const Light& light) const { return is_area(light.kind) ? options.samples : 1; }

    /// From point i to the light, or to its k-th sample.
    [[nodiscard]] static Segment segment(const Aimed& aimed, const PointBatch& points, std::size_t i, int k) {
        const Light& light = aimed.source();
        const dvec3 p      = exact_position(aimed.scene(), points, i);
        Segment s{p, -dvec3(light.direction), double(kInfinity), false, points.triangle[i], points.flipped[i] ? -1 : 1};
        if (light.kind == LightKind::directional) return s;
        s.d      = (is_area(light.kind) ? light_point(light, p, k) : dvec3(light.position)) - p;
        s.end    = 1;
        s.behind = points.facing[aimed.light][i] == Facing::partly && glm::dot(dvec3(points.normal(i)), s.d) <= 0;
        return s;
    }

    /// By triangle t. What lies in the plane of the point's own triangle, a copy of it, say, hides nothing.
    [[nodiscard]] static bool is_crossed(const Scene& scene, TriangleId t, const Segment& s) {
        return t != s.own &&
               crosses(s.p, s.d, s.end, dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)),
                       dvec3(scene.vertex(t, 2))) &&
               rises_over(scene, t, s.own, s.side);
    }

    /// The fraction of the light that arrives, per channel: 1 where no triangle lies between, 0 where one blocks.
    [[nodiscard]] static vec3 passed(const Aimed& aimed, const Segment& s) {
        vec3 fraction(1);
        for (const TriangleId t : as<Occluders>(aimed.built).triangles) {
            if (!is_crossed(aimed.scene(), t, s)) continue;
            fraction *= aimed.scene().lets_through(t);
            if (fraction == vec3(0)) break;
        }
        return fraction;
    }

    [[nodiscard]] static TriangleId first_blocker(const Aimed& aimed, const Segment& s) {
        for (const TriangleId t : as<Occluders>(aimed.built).triangles)
            if (is_crossed(aimed.scene(), t, s)) return t;
        return kNoTriangle;
    }
};

}  // namespace

extern const MethodInfo brute_force;
const MethodInfo brute_force{
    .name  = "brute_force",
    .title = "Brute force",
    .paper = "Arthur Appel, Some Techniques for Shading Machine Renderings of Solids, 1968",
    .summary =
        "Tests the segment from each point to the light against every triangle, in double. The baseline that "
        "every other method saves time against. Errs by rounding at edges and where faces coincide, and by "
        "its samples in penumbrae. Limit: time grows with points times triangles.",
    .parameters = kParameters,
    .by_default = false,
    .create     = create<BruteForce>};

}  // namespace umbra
