// Ray-traced shadows: a ray from the surface point to the light asks whether anything lies between; an area light is
// asked at many of its points.
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
// Robert Cook, Thomas Porter, Loren Carpenter. Distributed Ray Tracing. 1984
// Carsten Waechter, Nikolaus Binder. A Fast and Robust Method for Avoiding Self-Intersection. 2019
#include <fmt/format.h>

#include <optional>

#include "umbra/core/render/tiles.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/rays/light_shafts.h"
#include "umbra/shadows/shared/light_rays.h"

namespace umbra {
namespace {

using namespace rays;

/// Which rays are not traced.
enum class Cull : std::uint8_t { none, shafts };

struct Options {
    OffsetPolicy offset = OffsetPolicy::skip_triangle;
    double epsilon      = 1e-4;
    int samples         = 16;
    Sampler sampler     = Sampler::sobol;
    int seed            = 0;
    Measure measure     = Measure::area;
    Cull cull           = Cull::shafts;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::offset>({.name    = "offset",
                                 .doc     = "How a ray keeps from hitting the surface that it starts on.",
                                 .phase   = Phase::visibility,
                                 .choices = "skip_triangle|integer_offset|epsilon"}),
    parameter<&Options::epsilon>({.name  = "epsilon",
                                  .doc   = "offset=epsilon: distance along the normal at which a ray starts.",
                                  .unit  = "scene diagonals",
                                  .phase = Phase::visibility,
                                  .min   = 0,
                                  .max   = 1}),
    parameter<&Options::samples>({.name        = "samples",
                                  .doc         = "Rays from a point to an area light; other lights take one.",
                                  .unit        = "rays a point",
                                  .phase       = Phase::aim,
                                  .min         = 1,
                                  .max         = 65536,
                                  .sweep       = "1|4|16|64|256",
                                  .area_lights = true}),
    parameter<&Options::sampler>({.name    = "sampler",
                                  .doc     = "How the samples of an area light are spread; sobol is Owen-scrambled.",
                                  .phase   = Phase::aim,
                                  .choices = kSamplers,
                                  .sweep   = "random|stratified|sobol",
                                  .area_lights = true}),
    parameter<&Options::seed>({.name        = "seed",
                               .doc         = "Picks the samples; equal seeds give equal bits.",
                               .phase       = Phase::aim,
                               .min         = 0,
                               .max         = 2147483647,
                               .area_lights = true}),
    parameter<&Options::measure>({.name = "measure",
                                  .doc  = "Which fraction of an area light S_j is. area: of its area; irradiance: each "
                                          "sample counts by the irradiance it sends, as in most renderers.",
                                  .phase       = Phase::visibility,
                                  .choices     = "area|irradiance",
                                  .area_lights = true}),
    parameter<&Options::cull>({.name = "cull",
                               .doc  = "Which rays to an area light are not traced: none, or those that a shaft from a "
                                       "tile of points to the light decides. S_j is the same, bit for bit.",
                               .phase       = Phase::build,
                               .choices     = "none|shafts",
                               .area_lights = true}),
};

class RayTraced final : public MethodWith<Options> {
public:
    [[nodiscard]] Measure measures() const override { return options.measure; }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::approximately, fmt::format("area lights are sampled, {} rays a point", options.samples)};
        if (options.offset != OffsetPolicy::skip_triangle)
            return {How::approximately, "rays start off the surface, so that contact shadows move"};
        // Compared with `exact`, one point in a hundred thousand is wrong where two bodies pass through each other: its
        // ray starts, in float, on the wrong side of the other surface.
        return {How::approximately,
                "one ray in float arithmetic decides each point: correct except for rounding at creases"};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        scene_    = &scene;
        diagonal_ = bounds(scene).diagonal();
        rays_.emplace(scene, Met::blocking);
        shafts_.reset();
        if (options.cull == Cull::shafts && !facts.hard_lights_only)
            shafts_.emplace(scene, rays_->space(), options.samples);
    }

    void aim(LightId light) override {
        const LightKind kind = scene_->lights[light].kind;
        light_.emplace(*scene_, *rays_, light, samples_of(light, kind, options.sampler, options.samples, options.seed));
        if (shafts_) shafts_->aim(light_->target());
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override;

    /// Its rays differ from those of visibility, and are as good.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        light_->blame(start_places(), points, light, blockers);
    }

    [[nodiscard]] std::size_t memory_bytes() const override {
        return (rays_ ? rays_->memory_bytes() : 0) + (shafts_ ? shafts_->memory_bytes() : 0) +
               (light_ ? light_->memory_bytes() : 0);
    }

private:
    [[nodiscard]] StartPlaces start_places() const {
        return {*scene_, rays_->space(), options.offset, static_cast<float>(options.epsilon) * diagonal_};
    }
    [[nodiscard]] float visible_irradiance(const Starts& starts, int lane, PointKey key) const;
    [[nodiscard]] float visible_fraction(const Starts& starts, int lane, PointKey key) const;
    void trace_area_light(const PointBatch& points, LightId light, const PointTile& tile, std::span<float> s) const;

    const Scene* scene_ = nullptr;
    float diagonal_     = 0;  ///< of the scene
    std::optional<RayScene> rays_;
    std::optional<LightShafts> shafts_;
    std::optional<LightRays> light_;
};

/// Stands for S_j where the point's plane leaves so little of the light that no sample is in front of it: there is no
/// irradiance to take a fraction of.
constexpr float kNoSample = -1;

/// The fraction of the light's irradiance that arrives at the point. Towards a flat light the cosine at the light is
/// the same height over the distance for all samples, so that one of direction d counts n.d / |d|^4; the disk that a
/// point sees of a sphere spans the directions that the sphere does.
float RayTraced::visible_irradiance(const Starts& starts, int lane, PointKey key) const {
    const vec3 n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
    double seen = 0, all = 0;
    const bool outside = light_->for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
        double weight[8];
        for (int k = 0; k < 8; ++k) {
            const dvec3 d(packet.dir_x[k], packet.dir_y[k], packet.dir_z[k]);
            const double square = glm::dot(d, d);
            weight[k]           = packet.valid[k] != 0 ? glm::dot(dvec3(n), d) / (square * square) : 0;
        }
        rays_->occluded(packet);
        for (int k = 0; k < 8; ++k) {
            all += weight[k];
            if (packet.tfar[k] >= 0) seen += weight[k];
        }
        return true;
    });
    if (!outside) return 1;
    return all > 0 ? static_cast<float>(seen / all) : kNoSample;
}

/// The fraction of the light's samples that the point sees. What is behind the point's plane is not seen.
float RayTraced::visible_fraction(const Starts& starts, int lane, PointKey key) const {
    return options.measure == Measure::irradiance ? visible_irradiance(starts, lane, key)
                                                  : light_->visible_fraction(starts, lane, key);
}

/// Area lights: eight rays of one point are a packet.
void RayTraced::trace_area_light(const PointBatch& points, LightId light, const PointTile& tile,
                                 std::span<float> s) const {
    const FlushDenormals flush;
    const StartPlaces places = start_places();
    const Facing* facing     = points.facing[light].data();
    TileStarts starts;
    std::size_t run = 0;
    bool asks       = false;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        if (any_asks(facing + first, count)) places.load(points, first, count, starts[run]), asks = true;
        ++run;
    });
    if (!asks) return;
    // Shafts are for rays that start at their points.
    TileKnown known{};
    if (shafts_ && options.offset == OffsetPolicy::skip_triangle) known = shafts_->known(points, light, tile, starts);
    run = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        const Known here = known[run];
        for (std::size_t k = 0; k < count; ++k) {
            if (!points.asks(light, first + k)) continue;
            s[first + k] = here != Known::nothing
                               ? (here == Known::lit ? 1.0f : 0.0f)
                               : visible_fraction(starts[run], static_cast<int>(k), light_->samples().key(first + k));
        }
        ++run;
    });
}

void RayTraced::visibility(const PointBatch& points, LightId light, Visibility out) const {
    for_each_tile(points, [&](const PointTile& tile) {
        if (is_area(light_->target().kind))
            trace_area_light(points, light, tile, out.s);
        else
            light_->trace_hard_light(start_places(), points, light, tile, out.s);
    });
    if (options.measure == Measure::area) return;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (out.s[i] == kNoSample) out.s[i] = 0, out.answer[i] = Answer::undefined;
}

}  // namespace

extern const MethodInfo ray_traced;
const MethodInfo ray_traced{
    .name  = "ray_traced",
    .title = "Ray-traced shadows",
    .paper =
        "Arthur Appel, Some Techniques for Shading Machine Renderings of Solids, 1968; Turner Whitted, An Improved "
        "Illumination Model for Shaded Display, 1980; Robert Cook, Thomas Porter, Loren Carpenter, Distributed Ray "
        "Tracing, 1984",
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
    .stand_in   = "samples=256",
    .create     = create<RayTraced>};

}  // namespace umbra
