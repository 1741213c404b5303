// Ray-traced shadows: a ray from the surface point to the light asks whether anything lies between; an area light is
// asked at many of its points.
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
// Robert Cook, Thomas Porter, Loren Carpenter. Distributed Ray Tracing. 1984
// Carsten Waechter, Nikolaus Binder. A Fast and Robust Method for Avoiding Self-Intersection. 2019
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/rays/near_light.h"
#include "umbra/shadows/rays/starts.h"
#include "umbra/shadows/rays/target.h"

namespace umbra {
namespace {

using namespace rays;

struct Options {
    OffsetPolicy offset = OffsetPolicy::skip_triangle;
    double epsilon      = 1e-4;
    int samples         = 16;
    Sampler sampler     = Sampler::sobol;
    int seed            = 0;
    Measure measure     = Measure::area;
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
};

/// Whether any of `count` points asks for S_j, by their facing.
bool any_asks(const Facing* facing, std::size_t count) {
    return std::any_of(facing, facing + count, [](Facing f) { return f >= Facing::partly; });
}

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

    void build(const Scene& scene, const SceneFacts&) override {
        scene_    = &scene;
        diagonal_ = bounds(scene).diagonal();
        rays_.emplace(scene, Met::blocking);
    }

    void aim(LightId light) override {
        target_     = make_target(scene_->lights[light], rays_->space());
        near_light_ = NearLight(*scene_, *rays_, light);
        set_.emplace(options.sampler, is_area(target_.kind) ? options.samples : 1,
                     static_cast<std::uint32_t>(options.seed) + 0x9e3779b9u * light);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override;

    /// What the ray to the light meets first; of an area light, the first ray that meets anything. Samples are
    /// keyed by the point's index in the batch, so that these rays differ from those of visibility, and are as good.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override;

    [[nodiscard]] std::size_t memory_bytes() const override {
        return (rays_ ? rays_->memory_bytes() : 0) + (set_ ? set_->memory_bytes() : 0) + near_light_.memory_bytes();
    }

private:
    [[nodiscard]] StartPlaces start_places() const {
        return {*scene_, rays_->space(), options.offset, static_cast<float>(options.epsilon) * diagonal_};
    }
    std::size_t hard_light_rays(const Starts& starts, const Facing* facing, std::size_t count, ShadowRay* rays) const;
    void trace_hard_light(const PointBatch& points, LightId light, const PointTile& tile, std::span<float> s) const;
    template <class Body>
    bool for_each_packet(const Starts& starts, int lane, PointKey key, const Body& body) const;
    [[nodiscard]] float visible_irradiance(const Starts& starts, int lane, PointKey key) const;
    [[nodiscard]] float visible_fraction(const Starts& starts, int lane, PointKey key) const;
    void trace_area_light(const PointBatch& points, LightId light, const PointTile& tile, std::span<float> s) const;
    [[nodiscard]] TriangleId first_blocker(const Starts& starts, int lane, Facing facing, std::size_t point) const;

    const Scene* scene_ = nullptr;
    float diagonal_     = 0;  ///< of the scene
    std::optional<RayScene> rays_;
    Target target_;
    std::optional<SampleSet> set_;
    NearLight near_light_;
};

/// Writes one ray for each of the `count` points that faces the light, from `rays` on. Returns how many.
std::size_t RayTraced::hard_light_rays(const Starts& starts, const Facing* facing, std::size_t count,
                                       ShadowRay* rays) const {
    const bool parallel  = target_.kind == LightKind::directional;
    const float per_unit = parallel ? 0 : target_.per_unit;
    float dx[8], dy[8], dz[8], tnear[8];
    for (int k = 0; k < 8; ++k) {
        dx[k]            = target_.centre.x - per_unit * starts.x[k];
        dy[k]            = target_.centre.y - per_unit * starts.y[k];
        dz[k]            = target_.centre.z - per_unit * starts.z[k];
        const float rise = starts.nx[k] * dx[k] + starts.ny[k] * dy[k] + starts.nz[k] * dz[k];
        tnear[k]         = starts.height[k] / std::max(rise, 1e-30f);
    }
    const float tfar    = parallel ? kInfinity : target_.reach;
    std::size_t written = 0;
    for (std::size_t k = 0; k < count; ++k) {
        if (facing[k] < Facing::partly) continue;
        rays[written++] = {starts.x[k], starts.y[k], starts.z[k], tnear[k], dx[k],        dy[k],
                           dz[k],       0,           tfar,        ~0u,      starts.id[k], 0};
    }
    return written;
}

/// Calls body(packet) for each eight samples of the light, with their rays ready, until it returns false. Lanes are
/// valid where there is a sample and it lies in front of the point's plane. False where the point lies within the
/// light.
template <class Body>
bool RayTraced::for_each_packet(const Starts& starts, int lane, PointKey key, const Body& body) const {
    const vec3 o(starts.x[lane], starts.y[lane], starts.z[lane]), n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
    vec3 to_centre = target_.centre - o * target_.per_unit, axis_u = target_.axis_u, axis_v = target_.axis_v;
    if (target_.kind == LightKind::sphere) {
        TangentDisk disk;
        if (!tangent_disk(dvec3(o), target_.sphere, target_.radius, disk)) return false;
        const double per_unit = 1 / target_.unit;
        to_centre             = vec3((disk.centre - dvec3(o)) * per_unit);
        axis_u                = vec3(disk.axis_u * per_unit);
        axis_v                = vec3(disk.axis_v * per_unit);
    }
    ShadowPacket packet;
    for (int k = 0; k < 8; ++k) {
        packet.org_x[k] = o.x, packet.org_y[k] = o.y, packet.org_z[k] = o.z;
        packet.id[k] = starts.id[lane];
    }
    for (int first = 0; first < options.samples; first += 8) {
        Samples8 samples;
        set_->eight(key, first, samples);
        if (target_.kind == LightKind::rectangle)
            for (int k = 0; k < 8; ++k) samples.x[k] = 2 * samples.x[k] - 1, samples.y[k] = 2 * samples.y[k] - 1;
        else
            map_to_disk(samples);
        for (int k = 0; k < 8; ++k) {
            const float dx   = to_centre.x + samples.x[k] * axis_u.x + samples.y[k] * axis_v.x;
            const float dy   = to_centre.y + samples.x[k] * axis_u.y + samples.y[k] * axis_v.y;
            const float dz   = to_centre.z + samples.x[k] * axis_u.z + samples.y[k] * axis_v.z;
            const float rise = n.x * dx + n.y * dy + n.z * dz;
            packet.dir_x[k] = dx, packet.dir_y[k] = dy, packet.dir_z[k] = dz;
            packet.tnear[k] = starts.height[lane] / std::max(rise, 1e-30f);
            packet.tfar[k]  = target_.reach;
            packet.valid[k] = rise > 0 && first + k < options.samples ? -1 : 0;
        }
        if (!body(packet)) return true;
    }
    return true;
}

/// Stands for S_j where the point's plane leaves so little of the light that no sample is in front of it: there is no
/// irradiance to take a fraction of.
constexpr float kNoSample = -1;

/// The fraction of the light's irradiance that arrives at the point. Towards a flat light the cosine at the light is
/// the same height over the distance for all samples, so that one of direction d counts n.d / |d|^4; the disk that a
/// point sees of a sphere spans the directions that the sphere does.
float RayTraced::visible_irradiance(const Starts& starts, int lane, PointKey key) const {
    const vec3 n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
    double seen = 0, all = 0;
    const bool outside = for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
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
    if (options.measure == Measure::irradiance) return visible_irradiance(starts, lane, key);
    int seen           = 0;
    const bool outside = for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
        rays_->occluded(packet);
        for (int k = 0; k < 8; ++k) seen += packet.valid[k] != 0 && packet.tfar[k] >= 0;
        return true;
    });
    return outside ? static_cast<float>(seen) / static_cast<float>(options.samples) : 1;
}

/// Hard lights: all rays of a tile are one list, since neighbours meet the same triangles.
void RayTraced::trace_hard_light(const PointBatch& points, LightId light, const PointTile& tile,
                                 std::span<float> s) const {
    const FlushDenormals flush;
    const StartPlaces places = start_places();
    const Facing* facing     = points.facing[light].data();
    Starts starts;
    ShadowRay rays[PointTile::kPoints];
    std::size_t traced = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        if (!any_asks(facing + first, count)) return;
        places.load(points, first, count, starts);
        traced += hard_light_rays(starts, facing + first, count, rays + traced);
    });
    if (traced == 0) return;
    rays_->occluded(std::span(rays, traced));
    std::size_t next = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) {
            if (!points.asks(light, i)) continue;
            const bool blocked = rays[next++].tfar < 0 || near_light_.blocker(points, i) != kNoTriangle;
            s[i]               = blocked ? 0.0f : 1.0f;
        }
    });
}

/// Area lights: eight rays of one point are a packet.
void RayTraced::trace_area_light(const PointBatch& points, LightId light, const PointTile& tile,
                                 std::span<float> s) const {
    const FlushDenormals flush;
    const StartPlaces places = start_places();
    const Facing* facing     = points.facing[light].data();
    Starts starts;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        if (!any_asks(facing + first, count)) return;
        places.load(points, first, count, starts);
        for (std::size_t k = 0; k < count; ++k)
            if (points.asks(light, first + k))
                s[first + k] = visible_fraction(starts, static_cast<int>(k), set_->key(first + k));
    });
}

void RayTraced::visibility(const PointBatch& points, LightId light, Visibility out) const {
    for_each_tile(points, [&](const PointTile& tile) {
        if (is_area(target_.kind))
            trace_area_light(points, light, tile, out.s);
        else
            trace_hard_light(points, light, tile, out.s);
    });
    if (options.measure == Measure::area) return;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (out.s[i] == kNoSample) out.s[i] = 0, out.answer[i] = Answer::undefined;
}

TriangleId RayTraced::first_blocker(const Starts& starts, int lane, Facing facing, std::size_t point) const {
    if (!is_area(target_.kind)) {
        ShadowRay ray;
        hard_light_rays(lane_alone(starts, lane), &facing, 1, &ray);
        return rays_->first_hit(ray);
    }
    // Where little of the light is hidden one set of samples may miss it: sixteen are tried.
    TriangleId blocker = kNoTriangle;
    for (std::uint64_t attempt = 0; attempt < 16 && blocker == kNoTriangle; ++attempt)
        for_each_packet(starts, lane, set_->key(16 * point + attempt), [&](const ShadowPacket& packet) {
            for (int k = 0; k < 8 && blocker == kNoTriangle; ++k)
                if (packet.valid[k] != 0)
                    blocker = rays_->first_hit({packet.org_x[k], packet.org_y[k], packet.org_z[k], packet.tnear[k],
                                                packet.dir_x[k], packet.dir_y[k], packet.dir_z[k], 0, packet.tfar[k],
                                                ~0u, packet.id[k], 0});
            return blocker == kNoTriangle;
        });
    return blocker;
}

void RayTraced::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    const std::vector<Facing>& facing = points.facing[light];
    const StartPlaces places          = start_places();
    parallel_ranges((points.size() + 7) / 8, 8, [&](std::size_t begin, std::size_t end) {
        const FlushDenormals flush;
        Starts starts;
        for (std::size_t first = 8 * begin; first < std::min(8 * end, points.size()); first += 8) {
            const std::size_t count = std::min<std::size_t>(8, points.size() - first);
            places.load(points, first, count, starts);
            for (std::size_t k = 0; k < count; ++k) {
                TriangleId& blocker = blockers[first + k];
                blocker             = kNoTriangle;
                if (facing[first + k] < Facing::partly) continue;
                blocker = first_blocker(starts, static_cast<int>(k), facing[first + k], first + k);
                if (blocker == kNoTriangle) blocker = near_light_.blocker(points, first + k);
            }
        }
    });
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
