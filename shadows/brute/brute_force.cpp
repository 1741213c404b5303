// Brute force: every surface point against every triangle, in points times triangles steps. Short enough to be copied
// as the start of a new method. Points where rounding may have made the sign of a number are decided by the exact
// segment (geometry/exact_sight.h), which a method that claims to_rounding can ask wherever it is in doubt.
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// Herbert Edelsbrunner, Ernst Muecke. Simulation of Simplicity. 1990
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/rounding.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/light_points.h"
#include "umbra/shadows/geometry/exact_sight.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

struct Options {
    int samples       = 16;
    int max_triangles = 20000;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::samples>(
        "samples", "Segments from a point to an area light; other lights take one.",
        {.unit = "segments a point", .min = 1, .max = 4096, .sweep = "4|16|64", .area_lights = true}),
    parameter<&Options::max_triangles>("max_triangles",
                                       "Scenes of more triangles are not served: a picture would take hours.",
                                       {.phase = Phase::build, .min = 1, .max = 50000000}),
};

/// A sign, -1 or 1; open where rounding may have made it.
struct Sign {
    int sign;
    bool is_open;
};

/// Sign of a product of factors that are known up to some roundings of `size`; `magnitude`: that of the product without
/// one of the factors, which is `size` at most.
Sign sign_of(double value, double magnitude, double size) {
    return {value > 0 ? 1 : -1, !(std::abs(value) > 0x1p-46 * size * magnitude)};
}

/// On which side the ray p + t d passes the edge from a to b. Both triangles of a shared edge compute the same number.
/// Where that is 0, the side is that of a ray turned by a little, the same for all edges: a ray through an edge inside
/// a surface meets one of its triangles, not none or two.
Sign side_of_edge(dvec3 p, dvec3 d, dvec3 a, dvec3 b, double size) {
    const bool swapped = comes_before(b, a);
    if (swapped) std::swap(a, b);
    const dvec3 across = glm::cross(a - p, b - a);
    double side        = glm::dot(across, d);
    Sign found = sign_of(side, sum_of_magnitudes(b - a) * (sum_of_magnitudes(a - p) + sum_of_magnitudes(d)), size);
    for (int k = 0; k < 3 && side == 0; ++k) side = across[k];
    found.sign = (side > 0) == swapped ? -1 : 1;
    return found;
}

struct Crossing {
    bool crosses;
    bool is_open;  ///< rounding may have made it one, or none
};

/// Whether the segment p + t d, 0 < t < 1, or the ray to infinity crosses the inside of the triangle. No number is
/// larger than `size`.
Crossing crossing(dvec3 p, dvec3 d, bool infinite, dvec3 a, dvec3 b, dvec3 c, double size) {
    const dvec3 n     = glm::cross(b - a, c - a);
    const double area = sum_of_magnitudes(b - a) * sum_of_magnitudes(c - a);
    const double from = glm::dot(n, p - a), to = infinite ? glm::dot(n, d) : glm::dot(n, p - a + d);
    const Sign begins = sign_of(from, area, size), ends = sign_of(to, area, infinite ? sum_of_magnitudes(d) : size);
    if (!begins.is_open && !ends.is_open && begins.sign == ends.sign) return {false, false};
    const Sign ab = side_of_edge(p, d, a, b, size), bc = side_of_edge(p, d, b, c, size),
               ca       = side_of_edge(p, d, c, a, size);
    const auto opposite = [](Sign x, Sign y) { return !x.is_open && !y.is_open && x.sign != y.sign; };
    if (opposite(ab, bc) || opposite(bc, ca) || opposite(ca, ab)) return {false, false};
    return {((from > 0 && to < 0) || (from < 0 && to > 0)) && ab.sign == bc.sign && bc.sign == ca.sign,
            begins.is_open || ends.is_open || ab.is_open || bc.is_open || ca.is_open};
}

/// Triangles that take any of the light that meets them.
struct Occluders final : Built {
    Occluders(const Scene& of, const SceneFacts& its_facts) : Built(of, its_facts), sight(of) {
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (scene.lets_through(t) != vec3(1)) triangles.push_back(t);
    }
    [[nodiscard]] std::size_t memory_bytes() const override {
        return triangles.size() * sizeof(TriangleId) + sight.memory_bytes();
    }
    std::vector<TriangleId> triangles;
    const ExactSight sight;  ///< for points that rounding leaves open
};

class BruteForce final : public MethodWith<Options, Occluders> {
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

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const PointBatch& points = looked.points;
        const Light& light       = aimed.source();
        const int samples        = samples_of(light);
        const bool one_answer    = !is_area(light.kind) && aimed.scene().transparent != TransparentOccluders::multiply;
        for_each_asked(aimed, looked, 64, [&](std::size_t i) {
            vec3 sum(0);
            bool is_open = false;
            for (int k = 0; k < samples; ++k) {
                const Segment s = segment(aimed, points, i, k);
                if (!s.behind) sum += passed(aimed, s, is_open);
            }
            sum /= static_cast<float>(samples);
            if (is_open && one_answer)
                sum = vec3(as<Occluders>(aimed.built).sight.is_lit(points, i, light) ? 1.0f : 0.0f);
            out.s[i] = mean_of(sum);
            if (!out.colour.empty()) out.colour[i] = sum;
        });
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        blame_each(aimed, looked, blockers, [&](std::size_t i) {
            TriangleId blocker = kNoTriangle;
            for (int k = 0; k < samples_of(aimed.source()) && blocker == kNoTriangle; ++k)
                blocker = first_blocker(aimed, segment(aimed, looked.points, i, k));
            return blocker;
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
        for (const TriangleId t : as<Occluders>(aimed.built).triangles) crossed += meeting(aimed.scene(), t, s).crosses;
        reason.evidence.push_back({"triangles crossed", static_cast<double>(crossed)});
        return reason;
    }

private:
    /// The points p + t d, 0 < t < 1, or t > 0.
    struct Segment {
        dvec3 p, d;
        bool infinite;
        bool behind;     ///< runs behind the plane of the point's triangle: that part of the light is not seen
        TriangleId own;  ///< the point's triangle
        int side;        ///< of it, that sees: 1 where its winding faces, else -1
        double size;     ///< of all numbers that p and d were computed from
    };

    [[nodiscard]] int samples_of(const Light& light) const { return is_area(light.kind) ? options.samples : 1; }

    /// From point i to the light, or to its k-th sample.
    [[nodiscard]] static Segment segment(const Aimed& aimed, const PointBatch& points, std::size_t i, int k) {
        const Light& light = aimed.source();
        const TriangleId t = points.triangle[i];
        const dvec3 p      = exact_position(aimed.scene(), points, i);
        Segment s{p, -dvec3(light.direction), true, false, t, points.flipped[i] ? -1 : 1, size_of(aimed.scene(), t)};
        if (light.kind == LightKind::directional) return s;
        s.infinite = false;
        s.size += 2 * sum_of_magnitudes(dvec3(light.position));
        s.d      = (is_area(light.kind) ? light_point(light, p, k) : dvec3(light.position)) - p;
        s.behind = points.facing[aimed.light][i] == Facing::partly && glm::dot(dvec3(points.normal(i)), s.d) <= 0;
        return s;
    }

    /// With triangle t. A triangle in the plane of the point's own, a copy of it, say, hides nothing.
    [[nodiscard]] static Crossing meeting(const Scene& scene, TriangleId t, const Segment& s) {
        if (t == s.own) return {false, false};
        const Crossing found = crossing(s.p, s.d, s.infinite, dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)),
                                        dvec3(scene.vertex(t, 2)), s.size + size_of(scene, t));
        if ((found.crosses || found.is_open) && !rises_over(scene, t, s.own, s.side)) return {false, false};
        return found;
    }

    /// The fraction of the light that arrives, per channel: 1 where no triangle lies between, 0 where one blocks.
    /// `is_open`: whether another answer may be right, as far as rounding tells.
    [[nodiscard]] static vec3 passed(const Aimed& aimed, const Segment& s, bool& is_open) {
        vec3 fraction(1);
        for (const TriangleId t : as<Occluders>(aimed.built).triangles) {
            const Crossing found = meeting(aimed.scene(), t, s);
            is_open |= found.is_open;
            if (!found.crosses) continue;
            fraction *= aimed.scene().lets_through(t);
            if (fraction == vec3(0) && !found.is_open) {
                is_open = false;
                break;
            }
        }
        return fraction;
    }

    [[nodiscard]] static TriangleId first_blocker(const Aimed& aimed, const Segment& s) {
        for (const TriangleId t : as<Occluders>(aimed.built).triangles)
            if (meeting(aimed.scene(), t, s).crosses) return t;
        return kNoTriangle;
    }
};

}  // namespace

extern const MethodInfo brute_force{
    .name  = "brute_force",
    .title = "Brute force",
    .paper = "Arthur Appel, Some Techniques for Shading Machine Renderings of Solids, 1968",
    .summary =
        "Tests the segment from each point to the light against every triangle, in double. The baseline that "
        "every other method saves time against; what rounding leaves open is decided exactly. Errs by its samples in "
        "penumbrae. Limit: time grows with points times triangles.",
    .parameters = kParameters,
    .by_default = false,
    .create     = create<BruteForce>};

}  // namespace umbra
