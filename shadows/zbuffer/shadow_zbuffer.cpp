// Shadow z-buffer: draw depth from the light, then compare every surface point with it.
//
// build finds what can block a light (shadows/maps/casters.h).
// aim fits frames to that as the light sees it, one map or six (light_views.h, light_frame.h), and rasterises its depth
// into each (depth_map.h).
// visibility takes each point to the view that covers it, projects it there, moves it towards the light by the bias,
// and compares its depth with those that the filter asks for (depth_lookup.h): S_j is the fraction that does not block.
//
// This work is based on:
// Lance Williams. Casting Curved Shadows on Curved Surfaces. 1978
// William Reeves, David Salesin, Robert Cook. Rendering Antialiased Shadows with Depth Maps. 1987 (PCF)
// Randima Fernando. Percentage-Closer Soft Shadows. 2005 (PCSS)
// Yulan Wang, Steven Molnar. Second-Depth Shadow Mapping. 1994 (faces=back)
// Christian Schueler. Eliminating Surface Acne with Gradient Shadow Mapping. 2005 (the receiver's plane as bias)
// Daniel Holbert. Saying Goodbye to Shadow Acne. 2011 (normal offset)
#include "umbra/shadows/zbuffer/shadow_zbuffer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/maps/facets.h"

namespace umbra {
namespace {

using Options = ZBufferOptions;

const std::vector<Parameter> kParameters{
    parameter<&Options::resolution>({.name  = "resolution",
                                     .doc   = "Texels along each side of a map; a cube has six maps.",
                                     .unit  = "texels",
                                     .phase = Phase::aim,
                                     .min   = 16,
                                     .max   = 16384,
                                     .sweep = "256|512|1024|2048|4096|8192"}),
    parameter<&Options::depth>({.name    = "depth",
                                .doc     = "Bits of a depth value; float stores reversed depth.",
                                .phase   = Phase::aim,
                                .choices = "16|24|32|float"}),
    parameter<&Options::bias>(
        {.name    = "bias",
         .doc     = "Reference depth of the comparison. manual: the depth of the point plus constant and slope bias. "
                    "receiver_plane: the receiver's plane at the texel, minus a rounding margin. auto: the smaller of the "
                    "two, minus a texel width and a quarter of the depth gradient, at most 16 texel widths in front of "
                    "the plane.",
         .phase   = Phase::visibility,
         .choices = "auto|receiver_plane|manual"}),
    parameter<&Options::constant>({.name  = "constant",
                                   .doc   = "Moves the point towards the light.",
                                   .unit  = "texel widths at the point's depth",
                                   .phase = Phase::aim,
                                   .min   = 0,
                                   .max   = 1e6}),
    parameter<&Options::slope>({.name  = "slope",
                                .doc   = "Moves the point towards the light.",
                                .unit  = "depth gradients of the receiver's plane a texel",
                                .phase = Phase::visibility,
                                .min   = 0,
                                .max   = 1e6}),
    parameter<&Options::normal_offset>({.name = "normal_offset",
                                        .doc = "Moves the point along its normal, times the sine of the light's angle.",
                                        .unit  = "texel widths",
                                        .phase = Phase::aim,
                                        .min   = 0,
                                        .max   = 64}),
    parameter<&Options::filter>({.name    = "filter",
                                 .doc     = "nearest: one comparison; pcf: the mean of several around the point; pcss: "
                                            "for area lights a search for blockers, and pcf as wide as the penumbra "
                                            "behind them, for other lights pcf.",
                                 .phase   = Phase::aim,
                                 .choices = "nearest|pcf|pcss",
                                 .sweep   = "nearest|pcf"}),
    parameter<&Options::radius>({.name  = "radius",
                                 .doc   = "pcf: compares (2 radius + 1)^2 texels.",
                                 .unit  = "texels",
                                 .phase = Phase::aim,
                                 .min   = 0,
                                 .max   = 16}),
    parameter<&Options::bilinear>(
        {.name  = "bilinear",
         .doc   = "pcf: bilinear weights, so that the kernel does not step from texel to texel.",
         .phase = Phase::visibility}),
    parameter<&Options::samples>({.name        = "samples",
                                  .doc         = "pcss: texels compared, in the search and again in the filter.",
                                  .unit        = "texels",
                                  .phase       = Phase::aim,
                                  .min         = 1,
                                  .max         = 1024,
                                  .area_lights = true}),
    parameter<&Options::search>({.name        = "search",
                                 .doc         = "pcss: how far from the point texels are compared, at most.",
                                 .unit        = "sides of the map",
                                 .phase       = Phase::aim,
                                 .min         = 0,
                                 .max         = 0.1,
                                 .area_lights = true}),
    parameter<&Options::faces>({.name  = "faces",
                                .doc   = "Which side of a triangle casts; back (second depth) and front expect closed "
                                         "occluders whose normals point outwards.",
                                .phase = Phase::aim,
                                .choices = "all|front|back"}),
    parameter<&Options::fit>({.name = "fit",
                              .doc = "What a map covers. scene: everything; casters: what can block the light, without "
                                     "planes that have everything else in front of them.",
                              .phase   = Phase::build,
                              .choices = "casters|scene"}),
    parameter<&Options::surround>({.name = "surround",
                                   .doc =
                                       "Spot lights: resolution of the maps outside the cone, relative to the cone's "
                                       "own map; 0: no such maps, points there are undefined.",
                                   .phase = Phase::aim,
                                   .min   = 0,
                                   .max   = 1}),
};

}  // namespace

void ShadowZBuffer::configure(const Settings& settings) {
    const Options o = settings.as<Options>();
    bias_           = {o.bias, o.constant, o.slope, o.normal_offset};
    filter_         = o.filter == FilterKind::nearest ? Filter{} : Filter{o.radius, o.bilinear};
    finds_blockers_ = o.filter == FilterKind::pcss;
    soft_           = {.samples = o.samples, .texels = o.search * o.resolution};
    map_options_    = {
           .method         = "shadow_zbuffer",
           .resolution     = o.resolution,
           .format         = o.depth,
           .faces          = o.faces,
           .fit_to_casters = o.fit == Fit::casters,
           .all_depths     = finds_blockers_,
           .surround       = o.surround,
           // What the filter and the offset may ask for, and a rounding.
           .border   = std::max<double>(filter_.radius, finds_blockers_ ? soft_.texels : 0) + bias_.normal_offset + 2,
           .headroom = std::max(64.0, kMostAutomatic * (4 * filter_.radius + 2)) + bias_.constant};
    if (views_) views_->set_options(map_options_);
    if (4 * map_options_.border > map_options_.resolution)
        throw UsageError(fmt::format(
            "shadow_zbuffer: radius={} and normal_offset={} reach over a quarter of resolution={}, expected a "
            "resolution "
            "of at least {}",
            filter_.radius, bias_.normal_offset, map_options_.resolution, std::ceil(4 * map_options_.border)));
}

Service ShadowZBuffer::serves(const SceneFacts& facts) const {
    std::string why = "any triangles and lights, through a map that samples depth";
    if (!facts.hard_lights_only)
        why += finds_blockers_ ? "; penumbrae are as wide as those behind one blocker that is parallel to the light"
                               : "; area lights are taken as their centres, so that penumbrae are missing";
    if (map_options_.faces != Faces::all && (facts.open_objects > 0 || facts.nonmanifold_objects > 0))
        why += "; open meshes cast with one side only";
    return {How::approximately, why + "."};
}

void ShadowZBuffer::build(const Scene& scene, const SceneFacts& facts) { views_.emplace(scene, facts, map_options_); }

namespace {

/// Of a disk that has the area of the light, as large as a sphere looks.
double radius_of(const Light& light) {
    if (light.kind != LightKind::rectangle) return static_cast<double>(light.radius);
    return std::sqrt(glm::length(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v))) / kPi);
}

}  // namespace

void ShadowZBuffer::aim(LightId light) {
    const Light& aimed = views_->scene().lights[light];
    is_soft_           = finds_blockers_ && is_area(aimed.kind);
    if (is_soft_) soft_.size = radius_of(aimed);
    views_->fit(light);
    views_->rasterise();
}

void ShadowZBuffer::visibility(const PointBatch& points, LightId light, Visibility out) const {
    for_each_facet(views_->scene(), points, light, [&](std::size_t i, const Facet& facet, dvec3 p) {
        if (centre_is_behind(views_->scene(), points, light, i)) {
            out.s[i] = 0;
            return;
        }
        for (const MapView& view : views_->views())
            if (const std::optional<Receiver> biased = receive(view, facet, p, bias_, filter_)) {
                out.s[i] = is_soft_ ? soft_share(view, *biased, view.frame.light_space(p).z, bias_.mode, soft_)
                                    : lit_share(view.map, *biased, bias_.mode, filter_);
                return;
            }
        // No view covers the point: nothing blocks the light there, or nobody looked.
        out.s[i] = 1;
        if (!views_->cover_all()) out.answer[i] = Answer::undefined;
    });
}

void ShadowZBuffer::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    struct Sample {
        std::size_t view = ~std::size_t{0};
        ivec2 at{0};
    };
    const std::vector<MapView>& views = views_->views();
    std::vector<Sample> samples(points.size());
    // What the search of pcss may find lies farther off; few points are asked.
    const Filter asked = is_soft_ ? Filter{static_cast<int>(std::ceil(soft_.texels)), false} : filter_;
    for_each_facet(views_->scene(), points, light, [&](std::size_t i, const Facet& facet, dvec3 p) {
        for (std::size_t v = 0; v < views.size(); ++v)
            if (const std::optional<Receiver> receiver = receive(views[v], facet, p, bias_, filter_)) {
                if (const auto at = blocked_sample(views[v].map, *receiver, bias_.mode, asked)) samples[i] = {v, *at};
                return;
            }
    });
    std::ranges::fill(blockers, kNoTriangle);
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (std::ranges::find(samples, v, &Sample::view) == samples.end()) continue;
        const std::vector<TriangleId> owners = views_->owners(views[v]);
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i].view == v)
                blockers[i] =
                    owners[static_cast<std::size_t>(samples[i].at.y) * views[v].map.width() + samples[i].at.x];
    }
}

std::size_t ShadowZBuffer::memory_bytes() const { return views_ ? views_->memory_bytes() : 0; }

extern const MethodInfo shadow_zbuffer;
const MethodInfo shadow_zbuffer{
    .name  = "shadow_zbuffer",
    .title = "Shadow z-buffer",
    .paper = "Lance Williams, Casting Curved Shadows on Curved Surfaces, 1978",
    .summary =
        "Draws the depth of what the light sees into a map, then compares each surface point with it. Serves any "
        "geometry; errs by the map's texels along shadow edges, loses gaps and occluders narrower than a texel, and "
        "moves contacts by up to 16 texel widths at grazing light. The automatic bias holds for light down to 1e-5 "
        "radians above an even floor, 1e-3 above one that rounding has left uneven, and for lights up to 1e12 scene "
        "sizes away.",
    .parameters = kParameters,
    .presets    = {{"textbook", "bias=manual,constant=4,fit=scene",
                    "Williams 1978: one map of the whole scene and a constant bias of four texels."},
                   {"fast", "resolution=512", "A map of 512 x 512 texels."},
                   {"soft", "filter=pcss", "Fernando 2005: penumbrae of area lights, by a search for blockers."},
                   {"best", "resolution=8192,filter=pcf", "A map of 8192 x 8192 texels, 3 x 3 comparisons."}},
    .create     = create<ShadowZBuffer>};

}  // namespace umbra
