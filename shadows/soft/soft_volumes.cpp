// Soft shadow volumes: which samples of an area light a point sees is found from silhouette edges; one ray in all says
// whether the samples with the fewest triangles before them have any.
//
// Of an area light each surface point has the samples that ray_traced has. Silhouette edges between the point and the
// light are projected onto it (light_view.h), and each changes the number of layers of the samples on one side of it
// (sample_layers.h). A sample so close to an edge that rounding, here or in Embree, could put it on the other side is
// traced, with the ray that ray_traced would trace; so answers are the same, bit for bit.
//
//     build        the trees of triangles that rays are traced in and shafts look in, and all edges
//     aim          the light's samples, and the tree of the edges that can be silhouette edges before it
//     look         nothing
//     visibility   tile by tile: what shafts prove lit or in the umbra, then edges for eight points together, layers
//                  point by point, and the rays of the tile
//
// This work is based on:
// Samuli Laine, Timo Aila, Ulf Assarsson, Jaakko Lehtinen, Tomas Akenine-Moeller. Soft Shadow Volumes for Ray Tracing.
// 2005
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "umbra/core/base/lanes.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/light_rays/light_rays.h"
#include "umbra/shadows/light_rays/light_shafts.h"
#include "umbra/shadows/light_rays/sample_options.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/soft/sample_layers.h"

namespace umbra {
namespace {

using namespace rays;
using namespace soft;

enum class Doubtful : std::uint8_t { trace, count };

struct Options : SampleOptions {
    Options() { samples = 256; }
    Doubtful doubtful = Doubtful::trace;
};

const std::vector<Parameter> kParameters{
    samples_parameter<Options>("Samples of an area light, those of ray_traced.", "samples a point", "16|64|256|1024"),
    sampler_parameter<Options>(),
    seed_parameter<Options>(),
    parameter<&Options::doubtful>(
        "doubtful",
        "What becomes of a sample that rounding may put on either side of an edge. trace: a ray decides; "
        "count: it stays where floats put it.",
        {.choices = "trace|count", .area_lights = true}),
};

/// The triangles that block light, and their edges.
struct Occluders final : Built {
    Occluders(const Scene& of, const SceneFacts& its_facts)
        : Built(of, its_facts),
          rays(of, Met::blocking),
          places(of, rays.space(), OffsetPolicy::skip_triangle, 0),
          mesh(of, rays.space()),
          shaft_tree(of, rays.space()) {}
    [[nodiscard]] std::size_t memory_bytes() const override {
        return rays.memory_bytes() + mesh.memory_bytes() + shaft_tree.memory_bytes();
    }

    const RayScene rays;
    const StartPlaces places;
    const RayMesh mesh;
    const ShaftTree shaft_tree;
};

/// One light, and the edges before it.
class SoftLight final : public Aimed {
public:
    SoftLight(const Occluders& from, LightId at, const Options& options)
        : Aimed(from, at), occluders_(from), rays_(from.scene, from.rays, at, options) {
        if (!is_area(rays_.target().kind)) return;
        edges_.emplace(from.mesh, rays_.target());
        shafts_.emplace(from.scene, from.rays.space(), from.shaft_tree, rays_.target());
    }
    [[nodiscard]] std::size_t memory_bytes() const override {
        return rays_.memory_bytes() + (edges_ ? edges_->memory_bytes() : 0);
    }
    [[nodiscard]] const Occluders& occluders() const { return occluders_; }
    [[nodiscard]] const LightRays& rays() const { return rays_; }

    /// S_j of the points of a tile, for an area light. With `doubts` false no sample is ever in doubt.
    void see_tile(const PointBatch& points, const PointTile& tile, bool doubts, std::span<float> s) const;

private:
    struct Scratch;
    void see_run(const PointBatch& points, std::size_t first, std::size_t count, const Starts& starts, Scratch& scratch,
                 std::span<float> s) const;
    [[nodiscard]] bool may_end_near_light(const LightView& view, TriangleId own) const;
    [[nodiscard]] bool count_layers(const LightView& view, const SeenLight& seen, const Starts& starts, int lane,
                                    std::size_t point, PointKey key, Scratch& scratch) const;
    [[nodiscard]] int count_doubtful(const SeenLight& seen, const Starts& starts, int lane,
                                     const SampleLayers& layers) const;

    const Occluders& occluders_;
    const LightRays rays_;
    std::optional<LightEdges> edges_;    ///< none before a light without an area
    std::optional<LightShafts> shafts_;  ///< nor these
};

/// The memory that the points of a tile reuse, and the rays that they wait for.
struct SoftLight::Scratch {
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

void SoftLight::see_tile(const PointBatch& points, const PointTile& tile, bool doubts, std::span<float> s) const {
    const int samples = rays_.samples().count();
    std::optional<Scratch> scratch;  // where some run needs it
    see_known(&*shafts_, occluders_.places, points, light, tile, s,
              [&](std::size_t first, std::size_t count, const Starts& starts) {
                  if (!scratch) scratch.emplace(Scratch{SampleLayers(samples, doubts)});
                  see_run(points, first, count, starts, *scratch, s);
              });
    if (!scratch) return;
    const FlushDenormals flush;
    occluders_.rays.occluded(scratch->rays);
    for (std::size_t w = 0; w < scratch->waiting.size(); ++w) {
        const Scratch::Waiting& waiting = scratch->waiting[w];
        const int seen                  = waiting.doubtful + (scratch->rays[w].tfar < 0 ? 0 : waiting.fewest);
        s[waiting.point]                = static_cast<float>(seen) / static_cast<float>(samples);
    }
}

/// S_j of the points first .. first + count - 1, at most eight, or the ray that it waits for.
UMBRA_FOR_EACH_PROCESSOR void SoftLight::see_run(const PointBatch& points, std::size_t first, std::size_t count,
                                                 const Starts& starts, Scratch& scratch, std::span<float> s) const {
    std::optional<SeenLight> seen[8];
    std::optional<LightView> view[8];
    Shafts shafts;
    for (std::size_t k = 0; k < count; ++k) {
        if (!points.asks(light, first + k)) continue;
        seen[k] = rays_.seen_from({starts.x[k], starts.y[k], starts.z[k]});
        if (!seen[k]) continue;
        view[k].emplace(starts, static_cast<int>(k), *seen[k], rays_.target());
        // A neighbour of the point's own triangle may begin where rays do, before them or after.
        if (!view[k]->is_usable() || may_end_near_light(*view[k], starts.id[k]) ||
            occluders_.mesh.is_next_to_edge(starts.id[k], points.u[first + k], points.v[first + k],
                                            view[k]->start_reach()))
            view[k].reset();
        else
            view[k]->set_shaft(shafts, k);
    }
    edges_->gather(shafts, scratch.edges);
    for (std::size_t k = 0; k < count; ++k) {
        const int lane = static_cast<int>(k);
        if (!points.asks(light, first + k)) continue;
        const PointKey key = rays_.samples().key(points.number(first + k));
        if (view[k] && count_layers(*view[k], *seen[k], starts, lane, first + k, key, scratch)) continue;
        const FlushDenormals flush;
        s[first + k] = rays_.visible_fraction(starts, lane, key);
    }
}

/// Whether some ray may end within a triangle: the edges of its part before that end are not all there.
bool SoftLight::may_end_near_light(const LightView& view, TriangleId own) const {
    return std::ranges::any_of(edges_->near_light(), [&](TriangleId t) {
        const RayMesh& of = occluders_.mesh;
        return t != own && view.may_end_within(of.corner(t, 0), of.corner(t, 1), of.corner(t, 2));
    });
}

/// Lets the point wait for one ray. False where edges do not tell.
bool SoftLight::count_layers(const LightView& view, const SeenLight& seen, const Starts& starts, int lane,
                             std::size_t point, PointKey key, Scratch& scratch) const {
    const vec3 o(starts.x[lane], starts.y[lane], starts.z[lane]);
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
        cut = cut || flat->cuts(rays_.target().kind);
    }
    Scratch::Waiting waiting{point, rays_.samples().count(), 0};
    Samples8 samples;
    if (!cut && view.all_in_front()) {
        rays_.eight(key, 0, samples);
    } else {
        layers.take(rays_, key);
        if (cut)
            for (const auto& [edge, change] : scratch.flat) layers.add(edge, change);
        if (!view.all_in_front()) layers.leave_out_behind(rays_, seen, starts, lane, view.latest_start());
        const SampleLayers::Fewest fewest = layers.fewest();
        waiting.fewest                    = fewest.count;
        waiting.doubtful                  = count_doubtful(seen, starts, lane, layers);
        samples.x[0] = fewest.sample.x, samples.y[0] = fewest.sample.y;
    }
    ShadowPacket packet = LightRays::packet_from(starts, lane);
    rays_.direct(seen, samples, starts, lane, 1, packet);
    scratch.waiting.push_back(waiting);
    scratch.rays.push_back({packet.org_x[0], packet.org_y[0], packet.org_z[0], packet.tnear[0], packet.dir_x[0],
                            packet.dir_y[0], packet.dir_z[0], 0, packet.tfar[0], ~0u, packet.id[0], 0});
    return true;
}

/// How many samples in doubt are seen, by the rays of ray_traced.
int SoftLight::count_doubtful(const SeenLight& seen, const Starts& starts, int lane, const SampleLayers& layers) const {
    const FlushDenormals flush;
    int visible = 0, filled = 0;
    Samples8 samples{};
    const auto trace = [&] {
        ShadowPacket packet = LightRays::packet_from(starts, lane);
        rays_.direct(seen, samples, starts, lane, filled, packet);
        occluders_.rays.occluded(packet);
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

class SoftVolumes final : public MethodWith<Options, Occluders, SoftLight> {
public:
    explicit SoftVolumes(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (facts.hard_lights_only)
            return {How::not_at_all, "no light has an area: one ray a point, which is what ray_traced does"};
        return {How::approximately,
                fmt::format("area lights are sampled at {} points, seen or hidden by silhouette edges; a light without "
                            "an area takes one ray",
                            options.samples)};
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& light = as<SoftLight>(aimed);
        for_each_tile(looked.points, [&](const PointTile& tile) {
            if (is_area(light.rays().target().kind))
                light.see_tile(looked.points, tile, options.doubtful == Doubtful::trace, out.s);
            else
                light.rays().trace_hard_light(light.occluders().places, looked.points, tile, out.s);
        });
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const auto& light = as<SoftLight>(aimed);
        light.rays().blame(light.occluders().places, looked.points, blockers);
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason = Method::explain(aimed, looked, i, given);
        if (is_area(aimed.source().kind)) add_samples(reason, options.samples, given);
        return reason;
    }
};

}  // namespace

extern const MethodInfo soft_volumes{
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
    .shown      = true,
    .seed       = "seed",
    .create     = create<SoftVolumes>};

}  // namespace umbra
