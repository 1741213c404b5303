// Ray-traced shadows: a ray from the surface point to the light asks whether anything lies between; an area light is
// asked at many of its points.
//
//     build        the tree of triangles that rays are traced in, and where some light has an area that of shafts
//     aim          the light as rays see it, its samples, its box for shafts
//     look         nothing
//     visibility   tile by tile: shafts decide where they can, rays elsewhere
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
// Robert Cook, Thomas Porter, Loren Carpenter. Distributed Ray Tracing. 1984
// Jarek Rossignac, Paul Borrel. Multi-Resolution 3D Approximations for Rendering Complex Scenes. 1993
// Carsten Waechter, Nikolaus Binder. A Fast and Robust Method for Avoiding Self-Intersection. 2019
#include <fmt/format.h>

#include <optional>

#include "umbra/core/base/lanes.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/geometry/coarse.h"
#include "umbra/shadows/light_rays/light_rays.h"
#include "umbra/shadows/light_rays/light_shafts.h"
#include "umbra/shadows/light_rays/sample_options.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

using namespace rays;

/// Which rays are not traced.
enum class Cull : std::uint8_t { none, shafts };

struct Options : SampleOptions {
    OffsetPolicy offset = OffsetPolicy::skip_triangle;
    double epsilon      = 1e-4;
    Measure measure     = Measure::area;
    Cull cull           = Cull::shafts;
    double coarseness   = 0;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::offset>("offset", "How a ray keeps from hitting the surface that it starts on.",
                                {.choices = "skip_triangle|integer_offset|epsilon"}),
    parameter<&Options::epsilon>("epsilon", "offset=epsilon: distance along the normal at which a ray starts.",
                                 {.unit = "scene diagonals", .min = 0, .max = 1}),
    samples_parameter<Options>("Rays from a point to an area light; other lights take one.", "rays a point",
                               "1|4|16|64|256"),
    sampler_parameter<Options>(),
    seed_parameter<Options>(),
    parameter<&Options::measure>(
        "measure",
        "Which fraction of an area light S_j is. area: of its area; irradiance: each sample counts by the "
        "irradiance it sends, as in most renderers.",
        {.choices = "area|irradiance", .area_lights = true}),
    parameter<&Options::cull>(
        "cull",
        "Which rays to an area light are not traced: none, or those that a shaft from a tile of points to the "
        "light decides. S_j is the same, bit for bit.",
        {.phase = Phase::build, .choices = "none|shafts", .area_lights = true}),
    parameter<&Options::coarseness>(
        "coarseness",
        "Level of detail: width of the cells in which an occluder's vertices are joined, 0: none are. Rays then start "
        "half of it above their surface.",
        {.unit = "scene diagonals", .phase = Phase::build, .min = 0, .max = 0.25, .sweep = "0|0.0005|0.002|0.008"}),
};

/// Triangles have their numbers in the scene, also where they are coarser.
RayScene tree_of_occluders(const Scene& scene, double cell) {
    if (!(cell > 0)) return RayScene(scene, Met::blocking);
    Scene coarse     = scene;
    coarse.triangles = coarse_triangles(scene, cell);
    return RayScene(coarse, Met::blocking);
}

/// The triangles that block light, as rays and shafts look for them.
struct Occluders final : Built {
    Occluders(const Scene& of, const SceneFacts& its_facts, const Options& options)
        : Built(of, its_facts),
          diagonal(bounds(of).diagonal()),
          rays(tree_of_occluders(of, options.coarseness * double(diagonal))) {
        if (options.cull == Cull::shafts && options.coarseness == 0 && !its_facts.hard_lights_only)
            shaft_tree.emplace(of, rays.space());
    }
    [[nodiscard]] std::size_t memory_bytes() const override {
        return rays.memory_bytes() + (shaft_tree ? shaft_tree->memory_bytes() : 0);
    }

    const float diagonal;  ///< of the scene
    const RayScene rays;
    std::optional<ShaftTree> shaft_tree;  ///< none: all rays are traced
};

/// One light, as rays and shafts reach it.
struct TracedLight final : Aimed {
    TracedLight(const Occluders& from, LightId at, const Options& options)
        : Aimed(from, at), occluders(from), rays(from.scene, from.rays, at, options) {
        if (from.shaft_tree) shafts.emplace(from.scene, from.rays.space(), *from.shaft_tree, rays.target());
    }
    [[nodiscard]] std::size_t memory_bytes() const override { return rays.memory_bytes(); }

    const Occluders& occluders;
    const LightRays rays;
    std::optional<LightShafts> shafts;
};

class RayTraced final : public MethodWith<Options, Occluders, TracedLight> {
public:
    explicit RayTraced(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Measure measures() const override { return options.measure; }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (options.coarseness > 0)
            return {How::approximately,
                    fmt::format("occluders are coarser by cells of {:g} scene diagonals", options.coarseness)};
        if (!facts.hard_lights_only)
            return {How::approximately, fmt::format("area lights are sampled, {} rays a point", options.samples)};
        if (options.offset != OffsetPolicy::skip_triangle)
            return {How::approximately, "rays start off the surface, so that contact shadows move"};
        // Compared with `exact`, one point in a hundred thousand is wrong where two bodies pass through each other: its
        // ray starts, in float, on the wrong side of the other surface.
        return {How::approximately,
                "one ray in float arithmetic decides each point: correct except for rounding at creases"};
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& traced       = as<TracedLight>(aimed);
        const PointBatch& points = looked.points;
        const StartPlaces places = start_places(traced.occluders);
        for_each_tile(points, [&](const PointTile& tile) {
            if (is_area(traced.rays.target().kind))
                trace_area_light(traced, places, points, tile, out.s);
            else
                traced.rays.trace_hard_light(places, points, tile, out.s);
        });
        if (options.measure == Measure::area) return;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (out.s[i] == kNoSample) out.s[i] = 0, out.answer[i] = Answer::undefined;
    }

    /// Its rays differ from those of visibility, and are as good.
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const auto& traced = as<TracedLight>(aimed);
        traced.rays.blame(start_places(traced.occluders), looked.points, blockers);
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason      = Method::explain(aimed, looked, i, given);
        const auto& traced = as<TracedLight>(aimed);
        Starts starts;
        start_places(traced.occluders).load(looked.points, i, 1, starts);
        if (is_area(aimed.source().kind)) {
            if (options.measure == Measure::area) add_samples(reason, options.samples, given);
            reason.samples = samples_of(traced, starts, looked.points, i);
            return reason;
        }
        reason.evidence.push_back(
            {"start of the ray above its triangle", static_cast<double>(starts.height[0]), "world"});
        return reason;
    }

private:
    /// S_j of a point with no sample of the light in front of its plane: there is no irradiance to take a fraction of.
    static constexpr float kNoSample = -1;

    /// Coarser occluders lie about half a cell above and below the surface that they stand for, so that rays which start
    /// closer to it meet it at once.
    [[nodiscard]] StartPlaces start_places(const Occluders& from) const {
        const bool lifted   = options.offset == OffsetPolicy::epsilon || options.coarseness > 0;
        const double lift   = options.offset == OffsetPolicy::epsilon ? options.epsilon : 0;
        const double height = std::max(lift, 0.5 * options.coarseness);
        return {from.scene, from.rays.space(), lifted ? OffsetPolicy::epsilon : options.offset,
                static_cast<float>(height) * from.diagonal};
    }

    /// The rays of one point, once more: without those of samples behind its plane, which nobody traces.
    [[nodiscard]] static std::vector<LightSample> samples_of(const TracedLight& traced, const Starts& starts,
                                                             const PointBatch& points, std::size_t i) {
        const FlushDenormals flush;
        const RaySpace& space = traced.occluders.rays.space();
        std::vector<LightSample> samples;
        (void)traced.rays.for_each_packet(
            starts, 0, traced.rays.samples().key(points.number(i)), [&](const ShadowPacket& packet) {
                ShadowPacket rays = packet;
                traced.occluders.rays.occluded(rays);
                for (int k = 0; k < 8; ++k)
                    if (packet.valid[k] != 0) {
                        const dvec3 start(packet.org_x[k], packet.org_y[k], packet.org_z[k]);
                        const dvec3 way(packet.dir_x[k], packet.dir_y[k], packet.dir_z[k]);
                        samples.push_back(
                            {(start + way) / double(space.scale) + dvec3(space.centre), rays.tfar[k] >= 0});
                    }
                return true;
            });
        return samples;
    }

    /// Area lights: eight rays of one point are a packet.
    void trace_area_light(const TracedLight& traced, const StartPlaces& places, const PointBatch& points,
                          const PointTile& tile, std::span<float> s) const {
        const FlushDenormals flush;
        // Shafts are for rays that start at their points.
        const bool has_shafts = traced.shafts && options.offset == OffsetPolicy::skip_triangle;
        see_known(has_shafts ? &*traced.shafts : nullptr, places, points, traced.light, tile, s,
                  [&](std::size_t first, std::size_t count, const Starts& starts) {
                      for (std::size_t k = 0; k < count; ++k) {
                          if (!points.asks(traced.light, first + k)) continue;
                          const auto lane    = static_cast<int>(k);
                          const PointKey key = traced.rays.samples().key(points.number(first + k));
                          s[first + k]       = options.measure == Measure::irradiance
                                                   ? visible_irradiance(traced, starts, lane, key)
                                                   : traced.rays.visible_fraction(starts, lane, key);
                      }
                  });
    }

    /// The fraction of the light's irradiance that arrives at the point. Towards a flat light the cosine at the light
    /// is the same height over the distance for all samples, so that one of direction d counts n.d / |d|^4; the disk
    /// that a point sees of a sphere spans the directions that the sphere does.
    UMBRA_FOR_EACH_PROCESSOR [[nodiscard]] static float visible_irradiance(const TracedLight& traced,
                                                                           const Starts& starts, int lane,
                                                                           PointKey key) {
        const vec3 n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
        double seen = 0, all = 0;
        const bool outside = traced.rays.for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
            double weight[8];
            for (int k = 0; k < 8; ++k) {
                const dvec3 d(packet.dir_x[k], packet.dir_y[k], packet.dir_z[k]);
                const double square = glm::dot(d, d);
                weight[k]           = packet.valid[k] != 0 ? glm::dot(dvec3(n), d) / (square * square) : 0;
            }
            traced.occluders.rays.occluded(packet);
            for (int k = 0; k < 8; ++k) {
                all += weight[k];
                if (packet.tfar[k] >= 0) seen += weight[k];
            }
            return true;
        });
        if (!outside) return 1;
        return all > 0 ? static_cast<float>(seen / all) : kNoSample;
    }
};

}  // namespace

extern const MethodInfo ray_traced{
    .name  = "ray_traced",
    .title = "Ray-traced shadows",
    .paper =
        "Arthur Appel, Some Techniques for Shading Machine Renderings of Solids, 1968; Turner Whitted, An Improved "
        "Illumination Model for Shaded Display, 1980; Robert Cook, Thomas Porter, Loren Carpenter, Distributed Ray "
        "Tracing, 1984; Jarek Rossignac, Paul Borrel, Multi-Resolution 3D Approximations for Rendering Complex Scenes, "
        "1993",
    .summary =
        "A ray from each surface point to the light, or to many points of an area light, asks whether anything "
        "lies between. Errs by noise in penumbrae, and by the offset that keeps rays off their own surface. "
        "Limit: what is finer than a millionth of the scene, as gaps, slivers or relief under grazing light.",
    .parameters = kParameters,
    .presets    = {{"textbook", "offset=epsilon,sampler=random",
                    "Cook and others 1984: rays start off the surface by a fixed distance; independent samples."},
                   {"fast", "samples=4", "Four rays a point to an area light."},
                   {"best", "samples=256", "256 rays a point to an area light."}},
    .seed       = "seed",
    .create     = create<RayTraced>};

}  // namespace umbra
