// Cascaded shadow maps: the view of the camera is split by depth, and each part has a shadow map of its own, so that
// texels are small where pixels are.
//
//   build       the casters (BuiltCasters)
//   aim         the casters as the light sees them, and the window that holds them; other lights than directional ones:
//               one map or a cube, drawn (LightViews)
//   look        the camera; where visible depths are split and the points have no picture, one is traced (SeenPicture)
//   visibility  splits the depths that the camera sees, fits a window to each part, draws the maps that some point
//               needs, and compares each point with the map of its part
// No map of a camera is kept from one call to the next: a camera that moves draws all maps again, and the times say so.
//
// This work is based on the papers in cascades.h, and on:
// Lance Williams. Casting Curved Shadows on Curved Surfaces. 1978
#include "umbra/shadows/cascades/cascaded_maps.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/maps/answers.h"

namespace umbra {
namespace {

using Options = CascadedMapsOptions;

const std::vector<Parameter> kCascadeParameters{
    parameter<&Options::cascades, Options>(
        "cascades", "Parts that the view of a directional light's points is split into; each has a map.",
        {.unit = "maps", .phase = Phase::aim, .min = 1, .max = 8}),  // aim counts their memory
    resolution_parameter<Options>("Texels along each side of a map; of other lights, too: a cube has six.",
                                  "256|512|1024|2048|4096"),
    parameter<&Options::splits, Options>(
        "splits",
        "Depths at which parts meet. uniform: of equal depth; logarithmic: each part ends at the same "
        "multiple of its beginning; practical: between the two.",
        {.choices = "uniform|logarithmic|practical"}),
    parameter<&Options::lambda, Options>(
        "lambda", "splits=practical: the logarithmic depth's weight; the rest is the uniform one's.",
        {.min = 0, .max = 1}),
    parameter<&Options::depth_range>(
        "depth_range",
        "Depths that are split. scene: of all geometry within the view, seen or hidden; visible: of the "
        "points that the picture shows, to which the windows are fitted, too. Without a picture, "
        "visible traces one.",
        {.phase = Phase::look, .choices = "scene|visible"}),
    parameter<&Options::window, Options>(
        "window",
        "What a map covers. frustum: the part of the view, as far as something casts there; receivers: what "
        "lies in that part, and depths are split of what may be shaded alone. Not of stable windows.",
        {.choices = "receivers|frustum"}),
    parameter<&Options::stable, Options>(
        "stable",
        "A map covers the sphere around its part of the view and moves in whole texels, so that shadow edges "
        "stand still while the camera moves."),
    parameter<&Options::blend, Options>("blend",
                                        "How much of a part's end fades into the next part; 0: each point has one map.",
                                        {.unit = "depths of the part", .min = 0, .max = 1}),
    parameter<&Options::filter>("filter", "nearest: one comparison; pcf: the mean of several around the point.",
                                {.phase = Phase::aim, .choices = "nearest|pcf", .sweep = "nearest|pcf"}),
    radius_parameter<Options>("pcf: compares (2 radius + 1)^2 texels, which are wider in farther parts.", 16),
    bilinear_parameter<Options>(),
    bias_parameter<Options>(),
    constant_parameter<Options>(),
    slope_parameter<Options>(),
    normal_offset_parameter<Options>(),
};

bool is_sun(const Light& light) { return light.kind == LightKind::directional; }

/// The result of `aim` for a directional light; for others it is LightViews.
struct Sun final : Aimed {
    /// `bytes` are those of the cascades' maps, which `visibility` holds while it runs.
    Sun(const Built& from, LightId at, std::size_t bytes)
        : Aimed(from, at), casters(as<BuiltCasters>(from).casters, source()), maps_bytes(bytes) {
        if (casters.box().empty()) return;
        window = looking_along(dvec3(casters.box().centre()), dvec3(source().direction), false);
        fit_to_scene(*window, casters, kInfinity);
    }
    [[nodiscard]] std::size_t memory_bytes() const override { return window ? maps_bytes : 0; }

    const SelectedCasters casters;
    std::optional<LightFrame> window;  ///< of all casters, where there are some
    const std::size_t maps_bytes;
};

}  // namespace

CascadedMaps::CascadedMaps(const Settings& settings)
    : MethodWith(settings),
      bias_{options.bias, options.constant, options.slope, options.normal_offset},
      filter_(options.filter == CascadeFilter::nearest ? Filter{} : Filter{options.radius, options.bilinear}),
      room_(margins("cascaded_maps", options, filter_.radius, filter_.radius)),
      view_options_{.method     = "cascaded_maps",
                    .resolution = options.resolution,
                    .border     = room_.border,
                    .headroom   = room_.headroom} {
    const double map = 4.0 * options.resolution * options.resolution;
    if ((options.cascades + 1) * map > LightViews::half_of_memory())
        throw UsageError(
            fmt::format("cascaded_maps: cascades={} and resolution={} take more than half of the machine's "
                        "memory ({:.0f} MiB a map), expected fewer or smaller ones",
                        options.cascades, options.resolution, map / (1 << 20)));
}

Service CascadedMaps::serves(const SceneFacts& facts) const {
    const auto suns  = std::ranges::count(facts.lights, LightKind::directional, &LightFacts::kind);
    const bool other = suns < std::ssize(facts.lights);
    std::string why  = "any triangles, through maps that sample depth";
    if (suns > 0)
        why += other ? "; directional lights by cascades, others by one map or a cube" : ", one each part of the view";
    else
        why += "; no light is directional: there are no cascades, but one map or a cube, as shadow_zbuffer has them";
    if (!facts.hard_lights_only) why += "; area lights are taken as their centres, so that penumbrae are missing";
    return {How::approximately, why + "."};
}

std::unique_ptr<const Aimed> CascadedMaps::aim(const Built& built, LightId light) const {
    if (is_sun(built.scene.lights[light]))
        return std::make_unique<Sun>(
            built, light, sizeof(std::uint32_t) * options.cascades * options.resolution * options.resolution);
    return std::make_unique<LightViews>(built, light, view_options_);
}

std::unique_ptr<const Looked> CascadedMaps::look(const Built& built, const PointBatch& points) const {
    // The points may be any, and answers must not depend on which are asked together: the picture's own decide.
    const bool traced = options.depth_range == DepthRange::visible && std::ranges::any_of(built.scene.lights, is_sun);
    return std::make_unique<SeenPicture>(built.scene, points, traced);
}

std::optional<Cascades> CascadedMaps::fit(const Aimed& aimed, const Looked& looked) const {
    const auto& window = as<Sun>(aimed).window;
    if (!window) return {};
    const auto& seen   = as<SeenPicture>(looked);
    const Scene& scene = aimed.scene();
    const View view(seen.camera);
    std::vector<dvec4> planes;
    if (options.window == CascadeWindow::receivers) {
        const auto sides = window_sides(*window, view);
        planes.assign(sides.begin(), sides.end());
    }
    // Where the eye is too far away for rays, the scene in view stands for the visible points.
    const PointBatch* const shown = options.depth_range == DepthRange::visible ? seen.shown() : nullptr;
    const auto receivers          = shown != nullptr ? receivers_of(scene, *shown, aimed.light, view, planes)
                                                     : receivers_in_view(scene, view, planes);
    return fit_cascades({options, options.resolution, room_}, *window, view, *receivers);
}

/// Maps of one light, and which of them answer a point.
struct CascadedMaps::Lookups {
    std::span<const MapView> views{};             ///< of other lights than directional ones
    std::optional<Cascades> cascades{};           ///< of directional ones
    std::vector<std::optional<MapView>> drawn{};  ///< the maps of `cascades`, the whole's last: those that are asked

    using Asked = FoundReceiver;  ///< its view is an index of `views` or of `drawn`
    /// At most two maps, and the second one's weight in the answer. None: nothing shades the point.
    struct Answer {
        std::optional<Asked> first{}, second{};
        double share = 0;
    };
    [[nodiscard]] Answer at(const Facet& facet, dvec3 p, const Bias& bias, const Filter& filter) const {
        Answer answer;
        answer.first = receive(views, facet, p, bias, filter);
        if (!cascades) return answer;
        const Cascades::Choice choice = cascades->choose(p);
        const auto ask                = [&](std::size_t k) -> std::optional<Asked> {
            if (k == Cascades::kLit || !drawn[k]) return {};
            const auto receiver = receive(*drawn[k], facet, p, bias, filter);
            return receiver ? std::optional<Asked>({k, *receiver}) : std::nullopt;
        };
        answer.first  = ask(choice.first);
        answer.second = ask(choice.second);
        answer.share  = choice.share;
        return answer;
    }
    [[nodiscard]] const MapView& view(const Asked& asked) const {
        return views.empty() ? *drawn[asked.view] : views[asked.view];
    }
};

CascadedMaps::Lookups CascadedMaps::look_up(const Aimed& aimed, const Looked& looked,
                                            std::optional<std::size_t> alone) const {
    Lookups lookups;
    if (!is_sun(aimed.source())) {
        lookups.views = as<LightViews>(aimed).views();
        return lookups;
    }
    lookups.cascades = fit(aimed, looked);
    if (!lookups.cascades) return lookups;
    const Cascades& cascades = *lookups.cascades;
    const Scene& scene       = aimed.scene();
    const PointBatch& points = looked.points;
    std::atomic<std::uint32_t> asked{0};
    const auto note = [&](std::size_t k) {
        const std::uint32_t bit = k == Cascades::kLit ? 0 : 1u << k;
        if ((bit & ~asked.load(std::memory_order_relaxed)) != 0) asked |= bit;
    };
    const auto note_choice = [&](std::size_t, const Facet&, dvec3 p) {
        const Cascades::Choice choice = cascades.choose(p);
        note(choice.first);
        note(choice.second);
    };
    FacetOfPoint of{scene, points};
    const dvec3 p = alone ? of.go_to(*alone) : dvec3(0);
    if (alone)
        note_choice(*alone, of.facet, p);
    else
        for_each_facet(scene, points, aimed.light, note_choice);
    lookups.drawn.resize(cascades.parts.size() + 1);
    for (std::size_t k = 0; k <= cascades.parts.size(); ++k) {
        const Cascade& cascade = k < cascades.parts.size() ? cascades.parts[k] : cascades.whole;
        if ((asked >> k & 1) == 0 || !cascade.casts) continue;
        const dmat4 clip_from_world = cascade.frame.clip_from_world();
        const auto& casters         = as<Sun>(aimed).casters;
        const auto triangles        = casters.seen_by(clip_from_world);
        if (triangles.empty()) continue;
        MapView& view = lookups.drawn[k].emplace(
            MapView{cascade.frame, DepthMap(options.resolution, options.resolution, DepthFormat::float32)});
        if (!alone)
            view.map.draw(clip_from_world, scene.positions, triangles, Faces::all);
        else if (const auto at = receive(view, of.facet, p, bias_, filter_))
            draw_around(view, casters, Faces::all, texel_of(*at, view), filter_.radius + 1);
    }
    return lookups;
}

void CascadedMaps::visibility(const Aimed& aimed, const Looked& looked, Visibility out) const {
    const Scene& scene       = aimed.scene();
    const PointBatch& points = looked.points;
    const Lookups lookups    = look_up(aimed, looked);
    const auto lit           = [&](const std::optional<Lookups::Asked>& asked) {
        return asked ? lit_share(lookups.view(*asked), asked->receiver, bias_.mode, filter_) : 1.0f;
    };
    for_each_facet(scene, points, aimed.light, [&](std::size_t i, const Facet& facet, dvec3 p) {
        if (centre_is_behind(scene, points, aimed.light, i)) {
            out.s[i] = 0;
            return;
        }
        const Lookups::Answer answer = lookups.at(facet, p, bias_, filter_);
        const float first            = lit(answer.first);
        if (answer.share == 0) {
            out.s[i] = first;
            return;
        }
        const auto share = static_cast<float>(answer.share);
        out.s[i]         = std::clamp((1 - share) * first + share * lit(answer.second), 0.0f, 1.0f);
    });
}

/// The triangle whose depth the texel holds that blocks the point, the nearest of several. Draws the maps again.
void CascadedMaps::blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const {
    const Lookups lookups = look_up(aimed, looked);
    BlockingSamples samples(looked.points.size());
    for_each_facet(aimed.scene(), looked.points, aimed.light, [&](std::size_t i, const Facet& facet, dvec3 p) {
        const Lookups::Answer answer = lookups.at(facet, p, bias_, filter_);
        for (const auto& asked : {answer.first, answer.second})
            if (asked && samples.find(i, asked->view, lookups.view(*asked), asked->receiver, bias_.mode, filter_))
                return;
    });
    samples.name(blockers, [&](std::size_t v, std::span<const std::size_t> asked) {
        return is_sun(aimed.source()) ? owners(*lookups.drawn[v], as<Sun>(aimed).casters, Faces::all, asked)
                                      : as<LightViews>(aimed).owners(v, asked);
    });
}

Reason CascadedMaps::explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const {
    const Scene& scene       = aimed.scene();
    const PointBatch& points = looked.points;
    const Lookups lookups    = look_up(aimed, looked, i);
    FacetOfPoint at{scene, points};
    const dvec3 p                = at.go_to(i);
    const Lookups::Answer answer = lookups.at(at.facet, p, bias_, filter_);
    TriangleId blocker           = kNoTriangle;
    for (const auto& asked : {answer.first, answer.second}) {
        if (!asked || given.s >= 1 || blocker != kNoTriangle) continue;
        const MapView& view = lookups.view(*asked);
        if (const auto sample = blocked_sample(view, asked->receiver, bias_.mode, filter_))
            blocker = is_sun(aimed.source()) ? owner(view, as<Sun>(aimed).casters, Faces::all, *sample)
                                             : as<LightViews>(aimed).owner(asked->view, *sample);
    }
    Reason reason = reason_by_geometry(scene, points, i, aimed.light, given, blocker);
    if (answer.first)
        add_texel(reason, *answer.first, lookups.view(*answer.first), given);
    else
        reason.evidence.push_back({"map", "nothing casts onto the point's part of the view"});
    if (answer.share > 0) reason.evidence.push_back({"fraction of the next map", answer.share});
    return reason;
}

extern const MethodInfo cascaded_maps{
    .name  = "cascaded_maps",
    .title = "Cascaded shadow maps",
    .paper =
        "Fan Zhang, Hanqiu Sun, Leilei Xu, Lee Kit Lun, Parallel-Split Shadow Maps for Large-Scale Virtual "
        "Environments, 2006",
    .summary =
        "Splits the camera's view by depth and gives each part a shadow map of its own for every directional light, so "
        "that texels are small near the eye. A camera that moves has all cascades fitted and drawn again. Errs as a "
        "shadow z-buffer does, by the texels of a point's cascade; points outside of the view have one map of the "
        "whole "
        "scene. Other lights than directional ones have no cascades: they have one map or a cube. The memory includes "
        "the cascades' maps, which are held while S_j is computed.",
    .parameters = kCascadeParameters,
    .presets    = {{"textbook", "bias=manual,constant=4,window=frustum",
                    "Zhang 2006: practical splits, windows of the view's parts, and a constant bias of four texels."},
                   {"fast", "resolution=512", "Maps of 512 x 512 texels."},
                   {"stable", "stable=true,filter=pcf",
                    "Valient 2008: shadow edges that stand still while the camera moves."},
                   {"samples", "splits=logarithmic,depth_range=visible",
                    "Lauritzen 2011: cascades fitted to what the picture shows."},
                   {"best", "cascades=8,resolution=4096,filter=pcf,depth_range=visible",
                    "Eight maps of 4096 x 4096 texels, 3 x 3 comparisons."}},
    .by_default = false,
    .shown      = true,
    .create     = create<CascadedMaps>};

}  // namespace umbra
