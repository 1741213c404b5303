// Soft shadow volumes: which samples of an area light a point sees is found from silhouette edges; one ray in all says
// whether the samples with the fewest triangles before them have any.
//
// Of an area light each surface point has the samples that ray_traced has. Silhouette edges between the point and the
// light are projected onto it (light_view.h), and each changes the number of layers of the samples on one side of it
// (sample_layers.h). A sample so close to an edge that rounding, here or in Embree, could put it on the other side is
// traced, with the ray that ray_traced would trace; so answers are the same, bit for bit.
//
// This work is based on:
// Samuli Laine, Timo Aila, Ulf Assarsson, Jaakko Lehtinen, Tomas Akenine-Moeller. Soft Shadow Volumes for Ray Tracing.
// 2005
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "umbra/core/render/tiles.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/light_rays.h"
#include "umbra/shadows/soft/sample_layers.h"

namespace umbra {
namespace {

using namespace rays;
using namespace soft;

enum class Doubtful : std::uint8_t { trace, count };

struct Options {
    int samples       = 256;
    Sampler sampler   = Sampler::sobol;
    int seed          = 0;
    Doubtful doubtful = Doubtful::trace;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::samples>({.name        = "samples",
                                  .doc         = "Samples of an area light, those of ray_traced.",
                                  .unit        = "samples a point",
                                  .phase       = Phase::aim,
                                  .min         = 1,
                                  .max         = 65536,
                                  .sweep       = "16|64|256|1024",
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
    parameter<&Options::doubtful>(
        {.name    = "doubtful",
         .doc     = "What becomes of a sample that rounding may put on either side of an edge. trace: a ray decides; "
                    "count: it stays where floats put it.",
         .phase   = Phase::visibility,
         .choices = "trace|count",
         .area_lights = true}),
};

class SoftVolumes final : public MethodWith<Options> {
public:
    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (facts.hard_lights_only)
            return {How::not_at_all, "no light has an area: one ray a point, which is what ray_traced does"};
        return {How::approximately,
                fmt::format("area lights are sampled at {} points, seen or hidden by silhouette edges; a light without "
                            "an area takes one ray",
                            options.samples)};
    }

    void build(const Scene& scene, const SceneFacts&) override {
        scene_ = &scene;
        light_.reset();
        edges_.reset();
        rays_.emplace(scene, Met::blocking);
        occluders_.emplace(scene, rays_->space());
    }

    void aim(LightId light) override {
        const LightKind kind = scene_->lights[light].kind;
        light_.emplace(*scene_, *rays_, light, samples_of(light, kind, options.sampler, options.samples, options.seed));
        if (is_area(kind))
            edges_.emplace(*occluders_, light_->target());
        else
            edges_.reset();
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override;

    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        light_->blame(start_places(), points, light, blockers);
    }

    [[nodiscard]] std::size_t memory_bytes() const override {
        return (rays_ ? rays_->memory_bytes() : 0) + (occluders_ ? occluders_->memory_bytes() : 0) +
               (light_ ? light_->memory_bytes() : 0) + (edges_ ? edges_->memory_bytes() : 0);
    }

private:
    [[nodiscard]] StartPlaces start_places() const { return {*scene_, rays_->space(), OffsetPolicy::skip_triangle, 0}; }
    struct Scratch;
    void see_run(const PointBatch& points, LightId light, std::size_t first, std::size_t count, const Starts& starts,
                 Scratch& scratch, std::span<float> s) const;
    [[nodiscard]] bool may_end_near_light(const LightView& view, TriangleId own) const;
    [[nodiscard]] bool count_layers(const LightView& view, const SeenLight& seen, const Starts& starts, int lane,
                                    std::size_t point, Scratch& scratch) const;
    [[nodiscard]] int count_doubtful(const SeenLight& seen, const Starts& starts, int lane,
                                     const SampleLayers& layers) const;

    const Scene* scene_ = nullptr;
    std::optional<RayScene> rays_;
    std::optional<OccluderEdges> occluders_;
    std::optional<LightRays> light_;
    std::optional<LightEdges> edges_;
};

/// What a thread reuses from tile to tile, and what the points of a tile wait for.
struct SoftVolumes::Scratch {
    /// A point whose samples with the fewest layers are seen if the ray to one of them meets nothing.
    struct Waiting {
        std::size_t point;
        int fewest;    ///< how many samples these are
        int doubtful;  ///< samples that are seen besides
    };
    SampleLayers layers;
    std::vector<ShaftEdge> edges{};                ///< in the shafts of a run of points
    std::vector<std::pair<FlatEdge, int>> flat{};  ///< of one point, with LightEdges::change_at
    std::vector<Waiting> waiting{};
    std::vector<ShadowRay> rays{};  ///< of the waiting points
};

/// Whether some ray may end within a triangle: the edges of its part before that end are not all there.
bool SoftVolumes::may_end_near_light(const LightView& view, TriangleId own) const {
    return std::ranges::any_of(edges_->near_light(), [&](TriangleId t) {
        return t != own &&
               view.may_end_within(occluders_->corner(t, 0), occluders_->corner(t, 1), occluders_->corner(t, 2));
    });
}

/// How many samples in doubt are seen, by the rays of ray_traced.
int SoftVolumes::count_doubtful(const SeenLight& seen, const Starts& starts, int lane,
                                const SampleLayers& layers) const {
    const FlushDenormals flush;
    int visible = 0, filled = 0;
    Samples8 samples{};
    const auto trace = [&] {
        ShadowPacket packet = LightRays::packet_from(starts, lane);
        light_->direct(seen, samples, starts, lane, filled, packet);
        rays_->occluded(packet);
        for (int k = 0; k < filled; ++k) visible += packet.valid[k] != 0 && packet.tfar[k] >= 0;
        filled = 0;
    };
    layers.for_each_doubtful([&](vec2 sample) {
        samples.x[filled] = sample.x, samples.y[filled] = sample.y;
        if (++filled == 8) trace();
    });
    if (filled > 0) trace();
    return visible;
}

/// Lets the point wait for one ray. False where edges do not tell.
bool SoftVolumes::count_layers(const LightView& view, const SeenLight& seen, const Starts& starts, int lane,
                               std::size_t point, Scratch& scratch) const {
    const vec3 o(starts.x[lane], starts.y[lane], starts.z[lane]);
    const PointKey key   = light_->samples().key(point);
    SampleLayers& layers = scratch.layers;
    bool cut             = false;  // the light, by an edge
    scratch.flat.clear();
    for (const ShaftEdge& found : scratch.edges) {
        if ((found.lanes >> lane & 1u) == 0) continue;
        const LightEdge& edge              = edges_->edge(found.edge);
        const std::optional<FlatEdge> flat = view.flatten(edge);
        if (flat && !flat->is_there && flat->entry == 0) continue;
        const int change = (found.plus >> lane & 1u) != 0    ? 2
                           : (found.minus >> lane & 1u) != 0 ? -2
                                                             : edges_->change_at(edge, o, starts.id[lane]);
        if (change == 0) continue;
        if (!flat) return false;
        scratch.flat.emplace_back(*flat, change);
        cut = cut || flat->cuts(light_->target().kind);
    }
    Scratch::Waiting waiting{point, options.samples, 0};
    Samples8 samples;
    if (!cut && view.all_in_front()) {
        light_->eight(key, 0, samples);
    } else {
        layers.take(*light_, key);
        if (cut)
            for (const auto& [edge, change] : scratch.flat) layers.add(edge, change);
        if (!view.all_in_front()) layers.leave_out_behind(*light_, seen, starts, lane, view.latest_start());
        const SampleLayers::Fewest fewest = layers.fewest();
        waiting.fewest                    = fewest.count;
        waiting.doubtful                  = count_doubtful(seen, starts, lane, layers);
        samples.x[0] = fewest.sample.x, samples.y[0] = fewest.sample.y;
    }
    ShadowPacket packet = LightRays::packet_from(starts, lane);
    light_->direct(seen, samples, starts, lane, 1, packet);
    scratch.waiting.push_back(waiting);
    scratch.rays.push_back({packet.org_x[0], packet.org_y[0], packet.org_z[0], packet.tnear[0], packet.dir_x[0],
                            packet.dir_y[0], packet.dir_z[0], 0, packet.tfar[0], ~0u, packet.id[0], 0});
    return true;
}

/// S_j of the points first .. first + count - 1, at most eight, or what it waits for.
void SoftVolumes::see_run(const PointBatch& points, LightId light, std::size_t first, std::size_t count,
                          const Starts& starts, Scratch& scratch, std::span<float> s) const {
    std::optional<SeenLight> seen[8];
    std::optional<LightView> view[8];
    Shafts shafts;
    for (std::size_t k = 0; k < count; ++k) {
        if (!points.asks(light, first + k)) continue;
        seen[k] = light_->seen_from({starts.x[k], starts.y[k], starts.z[k]});
        if (!seen[k]) continue;
        view[k].emplace(starts, static_cast<int>(k), *seen[k], light_->target());
        // A neighbour of the point's own triangle may begin where rays do, before them or after.
        if (!view[k]->is_usable() || may_end_near_light(*view[k], starts.id[k]) ||
            occluders_->is_next_to_edge(starts.id[k], points.u[first + k], points.v[first + k], view[k]->start_reach()))
            view[k].reset();
        else
            view[k]->set_shaft(shafts, k);
    }
    edges_->gather(shafts, scratch.edges);
    for (std::size_t k = 0; k < count; ++k) {
        const int lane = static_cast<int>(k);
        if (!points.asks(light, first + k)) continue;
        if (view[k] && count_layers(*view[k], *seen[k], starts, lane, first + k, scratch)) continue;
        const FlushDenormals flush;
        s[first + k] = light_->visible_fraction(starts, lane, light_->samples().key(first + k));
    }
}

void SoftVolumes::visibility(const PointBatch& points, LightId light, Visibility out) const {
    const StartPlaces places = start_places();
    for_each_tile(points, [&](const PointTile& tile) {
        if (!is_area(light_->target().kind)) {
            light_->trace_hard_light(places, points, light, tile, out.s);
            return;
        }
        const Facing* facing = points.facing[light].data();
        Scratch scratch{SampleLayers(options.samples, options.doubtful == Doubtful::trace)};
        Starts starts;
        tile.for_each_run([&](std::size_t first, std::size_t count) {
            if (!any_asks(facing + first, count)) return;
            places.load(points, first, count, starts);
            see_run(points, light, first, count, starts, scratch, out.s);
        });
        const FlushDenormals flush;
        rays_->occluded(scratch.rays);
        for (std::size_t w = 0; w < scratch.waiting.size(); ++w) {
            const Scratch::Waiting& waiting = scratch.waiting[w];
            const int seen                  = waiting.doubtful + (scratch.rays[w].tfar < 0 ? 0 : waiting.fewest);
            out.s[waiting.point]            = static_cast<float>(seen) / static_cast<float>(options.samples);
        }
    });
}

}  // namespace

extern const MethodInfo soft_volumes;
const MethodInfo soft_volumes{
    .name  = "soft_volumes",
    .title = "Soft shadow volumes",
    .paper =
        "Samuli Laine, Timo Aila, Ulf Assarsson, Jaakko Lehtinen, Tomas Akenine-Moeller, Soft Shadow Volumes for "
        "Ray Tracing, 2005",
    .summary =
        "Finds from silhouette edges which samples of an area light have the fewest triangles before them, and traces "
        "one ray to say whether that is none. Sees the samples that ray_traced sees, bit by bit, in less time where "
        "samples are many and silhouette edges few.",
    .parameters = kParameters,
    .presets    = {{"textbook", "samples=200,sampler=stratified,doubtful=count",
                    "Laine and others 2005: 200 samples; floats alone say on which side of an edge they are."},
                   {"fast", "samples=64", "64 samples of an area light."},
                   {"best", "samples=1024", "1024 samples of an area light."}},
    .by_default = false,
    .shown_on   = {"umbra_penumbra"},
    .seed       = "seed",
    .create     = create<SoftVolumes>};

}  // namespace umbra
