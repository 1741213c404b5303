// Shadow z-buffer: draw depth from the light, then compare every surface point with it.
//
// build finds what can block a light (shadows/maps/casters.h). aim fits frames to that as the light sees it, one map or
// six (light_views.h, light_frame.h), and rasterises its depth into each (depth_map.h). look notes which picture the
// points are seen in, and traces that picture where contact shadows need it and the points have none (answers.h).
// visibility takes each point to the view that covers it, projects it there, moves it towards the light by the bias,
// and compares its depth with those that the filter asks for (kernels.h, depth_lookup.h): S_j is the fraction that does
// not block. If it is asked to, it then looks for contacts in the picture (contact_march.h).
//
// This work is based on:
// Lance Williams. Casting Curved Shadows on Curved Surfaces. 1978
// William Reeves, David Salesin, Robert Cook. Rendering Antialiased Shadows with Depth Maps. 1987 (PCF)
// Ignacio Castano. Shadow Mapping Summary, Part 1. 2013 (kernel=castano3, castano5, castano7)
// Jorge Jimenez. Next Generation Post Processing in Call of Duty: Advanced Warfare. 2014 (rotation=gradient)
// Randima Fernando. Percentage-Closer Soft Shadows. 2005 (PCSS)
// Andrew Woo. The Shadow Depth Map Revisited. Graphics Gems III. 1992 (surface=midpoint)
// Yulan Wang, Steven Molnar. Second-Depth Shadow Mapping. 1994 (faces=back)
// Christian Schueler. Eliminating Surface Acne with Gradient Shadow Mapping. 2005 (the receiver's plane as bias)
// Daniel Holbert. Saying Goodbye to Shadow Acne. 2011 (normal offset)
#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/shadows/maps/answers.h"
#include "umbra/shadows/maps/map_options.h"
#include "umbra/shadows/maps/penumbra.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/zbuffer/contact_march.h"

namespace umbra {
namespace {

enum class FilterKind : std::uint8_t { nearest, pcf, pcss };
enum class KeptSurface : std::uint8_t { first, midpoint };

struct Options : ComparingOptions, ViewOptions, SearchOptions {
    DepthFormat depth        = DepthFormat::float32;
    FilterKind filter        = FilterKind::nearest;
    Kernel kernel            = Kernel::grid;
    Rotation rotation        = Rotation::none;
    int samples              = 32;
    Faces faces              = Faces::all;
    KeptSurface surface      = KeptSurface::first;
    int contact_steps        = 0;
    double contact_length    = 0.3;
    double contact_thickness = 0.1;
};

const std::vector<Parameter> kParameters{
    resolution_parameter<Options>("Texels along each side of a map; a cube has six maps.",
                                  "256|512|1024|2048|4096|8192"),
    parameter<&Options::depth>("depth", "Bits of a depth value; float stores reversed depth.",
                               {.phase = Phase::aim, .choices = "16|24|32|float"}),
    bias_parameter<Options>(),
    constant_parameter<Options>(),
    slope_parameter<Options>(),
    normal_offset_parameter<Options>(),
    parameter<&Options::filter>(
        "filter",
        "nearest: one comparison; pcf: the mean of several around the point; pcss: for area lights a search "
        "for blockers, and pcf as wide as the penumbra behind them, for other lights pcf.",
        {.phase = Phase::aim, .choices = "nearest|pcf|pcss", .sweep = "nearest|pcf"}),
    parameter<&Options::kernel>(
        "kernel",
        "pcf: which texels are compared. grid: a square of them; disc: those at points spread evenly over a "
        "disk of radius + 1/2; castano3, castano5, castano7: 3, 5 or 7 a side that count most in the middle, "
        "and move with the point.",
        {.phase = Phase::aim, .choices = "grid|disc|castano3|castano5|castano7"}),
    radius_parameter<Options>("pcf: compares (2 radius + 1)^2 texels, not of Castano's kernels.", 16),
    bilinear_parameter<Options>(),
    parameter<&Options::rotation>(
        "rotation",
        "kernel=disc and pcss: rotates the points of each disc. noise: by an angle that the point's "
        "position in the map decides; gradient: by one that its pixel decides, spread over any 3 x 3 "
        "pixels; points that no picture shows have the pixel that the camera sees them through.",
        {.choices = "none|noise|gradient"}),
    parameter<&Options::samples>("samples",
                                 "kernel=disc: points compared; pcss: texels, in the search and again in the filter.",
                                 {.unit = "texels", .phase = Phase::aim, .min = 1, .max = 1024}),
    search_parameter<Options>("pcss: how far from the point texels are compared, at most."),
    parameter<&Options::faces>(
        "faces",
        "Which side of a triangle casts; back (second depth) and front expect closed occluders whose normals "
        "point outwards.",
        {.phase = Phase::aim, .choices = "all|front|back"}),
    parameter<&Options::surface>(
        "surface",
        "Depth that a texel keeps. first: of the first surface that the light sees; midpoint: halfway "
        "between it and the second, if there is one, so that the lit sides of closed occluders need no "
        "bias: bias=auto is then receiver_plane. Where one surface is alone, its own, with the bias that is "
        "set.",
        {.phase = Phase::aim, .choices = "first|midpoint"}),
    parameter<&Options::contact_steps>(
        "contact_steps",
        "Contact shadows: steps of a march through the picture, from the point towards the light; a "
        "point is dark where a step lies just behind what the picture shows. 0: no march. Points "
        "without a picture have one of the scene traced.",
        {.unit = "steps", .phase = Phase::look, .min = 0, .max = 1024}),
    parameter<&Options::contact_length>("contact_length", "How far that march goes.",
                                        {.unit = "world units", .min = 1e-6, .max = 1e6}),
    parameter<&Options::contact_thickness>(
        "contact_thickness", "How thick what the picture shows is taken to be: a step further behind it is not dark.",
        {.unit = "world units", .min = 0, .max = 1e6}),
    fit_parameter<Options>(),
    surround_parameter<Options>(),
};

class ShadowZBuffer final : public MethodWith<Options, BuiltCasters> {
public:
    explicit ShadowZBuffer(const Settings& settings) : MethodWith(settings) {
        if (options.filter != FilterKind::nearest)
            filter_ = {kernel_radius(options.kernel, options.radius), options.bilinear, options.kernel, disc_};
        if (finds_blockers_ && !profile(options.kernel).empty())
            throw UsageError(
                "shadow_zbuffer: filter=pcss filters as wide as the penumbra, and Castano's kernels have one width, "
                "expected kernel=grid or kernel=disc");
        const double reach    = std::max<double>(filter_.radius, finds_blockers_ ? search_ : 0);
        const MapMargins room = margins("shadow_zbuffer", options, filter_.radius, reach);
        map_options_          = {.method     = "shadow_zbuffer",
                                 .resolution = options.resolution,
                                 .format     = options.depth,
                                 .faces      = options.faces,
                                 .all_depths = finds_blockers_,
                                 .midpoints  = options.surface == KeptSurface::midpoint,
                                 .surround   = options.surround,
                                 .border     = room.border,
                                 .headroom   = room.headroom};
    }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        std::string why = "any triangles and lights, through a map that samples depth";
        if (!facts.hard_lights_only)
            why += finds_blockers_ ? "; penumbrae are as wide as those behind one blocker that is parallel to the light"
                                   : "; area lights are taken as their centres, so that penumbrae are missing";
        if (options.faces != Faces::all && (facts.open_objects > 0 || facts.nonmanifold_objects > 0))
            why += "; open meshes cast with one side only";
        if (options.rotation == Rotation::gradient)
            why += "; samples depend on the pixel that the camera sees a point through";
        if (options.contact_steps > 0) why += "; contact shadows of what the camera sees";
        return {How::approximately, why + "."};
    }

    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        return std::make_unique<LightViews>(built, light, map_options_);
    }

    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        return std::make_unique<SeenPicture>(built.scene, points, options.contact_steps > 0);
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& views = as<LightViews>(aimed);
        const auto& seen  = as<SeenPicture>(looked);
        const bool soft   = is_soft(aimed.source());
        const SoftFilter soft_filter{disc_, soft ? disk_radius(aimed.source()) : 0, search_};
        const auto share = [&](std::size_t v, const Receiver& receiver, dvec3 p) {
            const MapView& view = views.views()[v];
            return soft ? soft_share(view, receiver, view.frame.light_space(p).z, bias_.mode, soft_filter)
                        : lit_share(view, receiver, bias_.mode, filter_);
        };
        const auto rotated_share = [&](std::size_t v, const Receiver& receiver, dvec3 p) {
            return share(v, rotated(receiver, seen.camera, p), p);
        };
        const auto one_sample = [&](std::size_t v, const Receivers8& receivers, const FacetPoints8&, float(&s)[8]) {
            const unsigned lit = lit_lanes(views.views()[v], receivers, bias_.mode);
            for (int k = 0; k < 8; ++k) s[k] = (lit >> k & 1) != 0 ? 1.0f : 0.0f;
        };
        if (filter_.is_one_sample() && !soft && !map_options_.midpoints)
            look_up(views, seen.points, bias_, filter_, out, one_sample);
        else if (options.rotation == Rotation::none)
            look_up(views, seen.points, bias_, filter_, out, point_by_point(share));
        else
            look_up(views, seen.points, bias_, filter_, out, point_by_point(rotated_share));
        for_each_contact(
            aimed, seen, [&](std::size_t i) { return out.s[i] > 0; }, [&](std::size_t i, TriangleId) { out.s[i] = 0; });
    }

    /// Whose depth the map holds in the texel that blocks the point, the nearest of several. Draws the maps again.
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const auto& views  = as<LightViews>(aimed);
        const auto& seen   = as<SeenPicture>(looked);
        const Filter asked = searched(aimed.source());
        BlockingSamples samples(seen.points.size());
        for_each_facet(aimed.scene(), seen.points, aimed.light, [&](std::size_t i, const Facet& facet, dvec3 p) {
            if (const auto found = receive(views.views(), facet, p, bias_, filter_))
                samples.find(i, found->view, views.views()[found->view], rotated(found->receiver, seen.camera, p),
                             bias_.mode, asked);
        });
        samples.name(blockers, [&](std::size_t v, auto where) { return views.owners(v, where); });
        for_each_contact(
            aimed, seen, [&](std::size_t i) { return blockers[i] == kNoTriangle; },
            [&](std::size_t i, TriangleId shown) { blockers[i] = shown; });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        const PointBatch& points = looked.points;
        const auto& views        = as<LightViews>(aimed);
        FacetOfPoint of{aimed.scene(), points};
        const dvec3 p    = of.go_to(i);
        const auto found = receive(views.views(), of.facet, p, bias_, filter_);
        std::optional<ivec2> sample;
        if (found && given.answer == Answer::given && given.s < 1)
            sample =
                blocked_sample(views.views()[found->view], rotated(found->receiver, as<SeenPicture>(looked).camera, p),
                               bias_.mode, searched(aimed.source()));
        // Without such a sample it is a contact in the picture that blocks, or nothing.
        Reason reason =
            sample ? reason_by_geometry(aimed.scene(), points, i, aimed.light, given, views.owner(found->view, *sample))
                   : Method::explain(aimed, looked, i, given);
        if (found)
            add_texel(reason, *found, views.views()[found->view], given);
        else
            reason.evidence.push_back({"map", "none shows the point"});
        return reason;
    }

private:
    /// Whether penumbrae of the light are filtered.
    [[nodiscard]] bool is_soft(const Light& light) const { return finds_blockers_ && is_area(light.kind); }

    /// Which samples may have darkened a point: what the search of pcss finds lies farther away.
    [[nodiscard]] Filter searched(const Light& light) const {
        return is_soft(light) ? Filter{static_cast<int>(std::ceil(search_)), false} : filter_;
    }

    /// With the angle that discs about a point at world position p are rotated by; `camera` has its pixel.
    [[nodiscard]] Receiver rotated(Receiver receiver, const CameraFrame& camera, dvec3 p) const {
        if (options.rotation == Rotation::noise) receiver.turn = noise_turn(receiver.x, receiver.y);
        if (options.rotation != Rotation::gradient) return receiver;
        // Behind a perspective eye there are no pixels.
        const dvec3 pixel = camera.project(p);
        if (pixel.z > 0 || camera.projection == Projection::orthographic)
            receiver.turn = gradient_turn(std::floor(pixel.x), std::floor(pixel.y));
        return receiver;
    }

    /// Calls found(i, triangle) for the points that `asks(i)` and that a triangle of the picture casts a contact shadow
    /// on, in parallel.
    template <class Asks, class Found>
    void for_each_contact(const Aimed& aimed, const SeenPicture& seen, const Asks& asks, const Found& found) const {
        const PointBatch* const picture = seen.shown();
        if (options.contact_steps == 0 || picture == nullptr) return;
        const ContactMarch contact{options.contact_steps, options.contact_length, options.contact_thickness};
        for_each_facet(aimed.scene(), seen.points, aimed.light, [&](std::size_t i, const Facet&, dvec3 p) {
            if (!asks(i)) return;
            const auto pixel = march(aimed.scene(), *picture, p, aimed.source(), contact);
            if (pixel) found(i, picture->triangle[*pixel]);
        });
    }

    const Bias bias_{options.bias, options.constant, options.slope, options.normal_offset};
    const bool finds_blockers_     = options.filter == FilterKind::pcss;
    const double search_           = options.search * options.resolution;  ///< texels that the search of pcss reaches
    const std::vector<dvec2> disc_ = even_disk(options.samples);
    Filter filter_;
    LightViews::Options map_options_;
};

}  // namespace

extern const MethodInfo shadow_zbuffer{
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
                   {"smooth", "filter=pcf,kernel=castano7",
                    "Castano 2013: edges blurred over eight texels, without steps."},
                   {"midpoint", "surface=midpoint", "Woo 1992: closed occluders cast from half of their depth."},
                   {"best", "resolution=8192,filter=pcf", "A map of 8192 x 8192 texels, 3 x 3 comparisons."}},
    .create     = create<ShadowZBuffer>};

}  // namespace umbra
