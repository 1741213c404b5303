// Filterable shadow maps: draw depth from the light, turn it into moments that may be averaged, and bound the lit
// fraction of a surface point by the mean moments about it.
//
// build and aim choose views and draw depth as the shadow z-buffer does (shadows/maps); aim then turns each sample into
// moments and averages these over a box (moment_map.h).
// visibility takes each point to the view that covers it, moves it towards the light by the bias, and asks one bilinear
// mean for a bound of the fraction that does not block (moments.h): what PCF finds by comparing every sample.
//
// This work is based on:
// William Donnelly, Andrew Lauritzen. Variance Shadow Maps. 2006 (kind=vsm)
// Thomas Annen, Tom Mertens, Hans-Peter Seidel, Eddy Flerackers, Jan Kautz. Exponential Shadow Maps. 2008 (kind=esm)
// Marco Salvi. Rendering Filtered Shadows with Exponential Shadow Maps. ShaderX6. 2008 (kind=esm)
// Andrew Lauritzen, Michael McCool. Layered Variance Shadow Maps. 2008 (kind=evsm2, evsm4)
// Christoph Peters, Reinhard Klein. Moment Shadow Mapping. 2015 (kind=msm)
#include <algorithm>
#include <cmath>
#include <optional>

#include "umbra/shadows/filtered/moment_map.h"
#include "umbra/shadows/maps/answers.h"
#include "umbra/shadows/maps/map_options.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

enum class DepthBias : std::uint8_t { automatic, manual };

struct FilteredOptions : MapOptions, ViewOptions {
    MomentKind kind           = MomentKind::evsm4;
    double positive_exponent  = 40;
    double negative_exponent  = 5;
    double bleed              = 0.1;
    double min_variance       = 1e-7;
    double moment_bias        = 3e-7;
    EmptySamples empty        = EmptySamples::apart;
    MomentPrecision precision = MomentPrecision::single;
    DepthBias bias            = DepthBias::automatic;
};

// The squares of exponentials are kept: exp(2 c) and exp(-2 c) are normal floats up to c = 43, normal doubles up to
// 354.
constexpr double kMostExponentSingle = 42, kMostExponentTwofold = 350;

const std::vector<Parameter> kFilteredParameters{
    parameter<&FilteredOptions::kind>(
        {.name = "kind",
         .doc = "What is kept of depth. vsm: mean and mean square; esm: an exponential; evsm2: mean and mean square of "
                "an exponential; evsm4: of two, the second of negative depth; msm: means of four powers.",
         .phase   = Phase::aim,
         .choices = "vsm|esm|evsm2|evsm4|msm",
         .sweep   = "vsm|evsm4|msm"}),
    resolution_parameter<FilteredOptions>("Texels along each side of a map; a cube has six maps.",
                                          "512|1024|2048|4096"),
    radius_parameter<FilteredOptions>("Filter: the mean of (2 radius + 1)^2 texels, and between them bilinear.", 64,
                                      "1|4"),
    parameter<&FilteredOptions::positive_exponent>(
        {.name  = "positive_exponent",
         .doc   = "esm, evsm2, evsm4: factor of depth, -1 to 1, in the exponential; taken as 42 at most where "
                  "precision=float, so that its square is a number.",
         .phase = Phase::aim,
         .min   = 0.01,
         .max   = kMostExponentTwofold}),
    parameter<&FilteredOptions::negative_exponent>(
        {.name  = "negative_exponent",
         .doc   = "evsm4: the same factor for the exponential of negative depth, with the same limit.",
         .phase = Phase::aim,
         .min   = 0.01,
         .max   = kMostExponentTwofold}),
    parameter<&FilteredOptions::bleed>(
        {.name = "bleed",
         .doc  = "Light-bleed cut: a lit fraction of the drawn texels below this is 0, what is above is stretched over "
                 "0 to 1. Removes leaks and narrows penumbrae of the filter.",
         .min  = 0,
         .max  = 0.99}),
    parameter<&FilteredOptions::min_variance>({.name = "min_variance",
                                               .doc  = "vsm, evsm2, evsm4: no variance of depth is taken as less.",
                                               .unit = "squares of the map's depth range",
                                               .min  = 0,
                                               .max  = 1}),
    parameter<&FilteredOptions::moment_bias>(
        {.name = "moment_bias",
         .doc  = "msm: fraction of the moments 0, 3/8, 0, 3/8 that is mixed in, against rounding.",
         .min  = 0,
         .max  = 1}),
    parameter<&FilteredOptions::empty>(
        {.name    = "empty",
         .doc     = "Texels on which nothing was drawn. far: depth of the far plane; apart: never block, and only the "
                    "drawn fraction of the filter is bounded by moments; one more number a texel.",
         .phase   = Phase::aim,
         .choices = "far|apart"}),
    parameter<&FilteredOptions::precision>({.name    = "precision",
                                            .doc     = "Numbers that moments are kept in.",
                                            .phase   = Phase::aim,
                                            .choices = "float|double"}),
    parameter<&FilteredOptions::bias>(
        {.name  = "bias",
         .doc   = "Depth that is looked up. manual: the point's, less constant and slope bias; auto: less also a texel "
                  "width and a quarter of the depth gradient, each times 2 radius + 1, at most 16 such widths.",
         .phase = Phase::visibility,
         .choices = "auto|manual"}),
    constant_parameter<FilteredOptions>(),
    slope_parameter<FilteredOptions>(),
    normal_offset_parameter<FilteredOptions>(),
    fit_parameter<FilteredOptions>(),
    surround_parameter<FilteredOptions>(),
};

constexpr double kSteps = 0x1p16;  // of S_j: floats keep moments to 2^-24, and bounds are ratios of their differences

class FilteredMap final : public Method {
public:
    void configure(const Settings& settings) override {
        options_          = settings.as<FilteredOptions>();
        const double most = options_.precision == MomentPrecision::single ? kMostExponentSingle : kMostExponentTwofold;
        bound_ = {options_.kind, std::min(options_.positive_exponent, most), std::min(options_.negative_exponent, most),
                  options_.min_variance, options_.moment_bias};
        filter_ = {options_.radius, true};
        bias_   = {options_.bias == DepthBias::manual ? BiasMode::manual : BiasMode::automatic, options_.constant,
                 options_.slope, options_.normal_offset};
        // Moments are kept beside the depth that they are made of.
        const double share = 4.0 / (4 + MomentMap::bytes_per_sample(options_.kind, options_.empty, options_.precision));
        // What is nearer to the light than what the map is fitted to counts as on the near plane: a quarter of the
        // map's side before that, so that exponentials of the two depths differ, too.
        const MapMargins room =
            margins("filtered_map", options_, options_.radius, options_.radius, 0.25 * options_.resolution);
        map_options_ = {.method         = "filtered_map",
                        .resolution     = options_.resolution,
                        .fit_to_casters = options_.fit == Fit::casters,
                        .surround       = options_.surround,
                        .border         = room.border,
                        .headroom       = room.headroom,
                        .memory_limit   = share * LightViews::half_of_memory()};
        if (views_) views_->set_options(map_options_);
    }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        std::string why = "any triangles and lights, through a filtered map that leaks light where depths differ";
        if (!facts.hard_lights_only) why += "; area lights are taken as their centres, so that penumbrae are missing";
        return {How::approximately, why + "."};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        maps_.clear();
        views_.emplace(scene, facts, map_options_);
    }

    void aim(LightId light) override {
        maps_.clear();
        views_->fit(light);
        views_->rasterise();
        for (const MapView& view : views_->views())
            maps_.emplace_back(view, bound_, options_.radius, options_.empty, options_.precision);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        look_up(*views_, points, light, bias_, filter_, out, [&](std::size_t v, const Receiver& receiver, dvec3) {
            return lit(views_->views()[v], maps_[v], receiver);
        });
    }

    /// Whose depth the map holds in the texel under the filter that blocks the point, the nearest of several. Draws the
    /// maps again.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        BlockingSamples samples(points.size());
        for_each_facet(views_->scene(), points, light, [&](std::size_t i, const Facet& facet, dvec3 p) {
            if (auto found = receive(views_->views(), facet, p, bias_, filter_)) {
                found->receiver.bias = total_bias(found->receiver);
                samples.find(i, found->view, views_->views()[found->view], found->receiver, BiasMode::manual, filter_);
            }
        });
        samples.name(blockers, [&](std::size_t v) { return views_->owners(v); });
    }

    /// Moments, and the depth that blame asks.
    [[nodiscard]] std::size_t memory_bytes() const override {
        std::size_t bytes = views_ ? views_->memory_bytes() : 0;
        for (const MomentMap& map : maps_) bytes += map.memory_bytes();
        return bytes;
    }

private:
    /// Nearness that is added to the point's: the filter's samples have one depth to be compared with.
    [[nodiscard]] static double total_bias(const Receiver& r) { return r.bias + std::min(r.slack, r.most); }

    [[nodiscard]] float lit(const MapView& view, const MomentMap& map, const Receiver& receiver) const {
        const FilteredDepth filtered = map.at(receiver.x, receiver.y);
        if (filtered.drawn == 0) return 1;
        // As far as the empty texels, and no farther; where those are apart, what lies behind all that is drawn does
        // so by its distance.
        const double most  = options_.empty == EmptySamples::far ? 1 : kInfinity;
        const double z     = std::min(linear_depth(view.frame, receiver.r + total_bias(receiver)), most);
        const double bound = lit_bound(bound_, filtered.moments, z);
        const double cut   = std::max(0.0, (bound - options_.bleed) / (1 - options_.bleed));
        const double s     = std::clamp(1 - filtered.drawn * (1 - cut), 0.0, 1.0);
        // Bounds tend to 0 and 1; what float moments do not tell from these is 0 or 1.
        return static_cast<float>(std::round(s * kSteps) / kSteps);
    }

    FilteredOptions options_;
    MomentBound bound_;
    Bias bias_;
    Filter filter_;
    LightViews::Options map_options_;
    std::optional<LightViews> views_;
    std::vector<MomentMap> maps_;  ///< of the views, in their order
};

}  // namespace

extern const MethodInfo filtered_map;
const MethodInfo filtered_map{
    .name  = "filtered_map",
    .title = "Filterable shadow map",
    .paper =
        "William Donnelly, Andrew Lauritzen, Variance Shadow Maps, 2006; Andrew Lauritzen, Michael McCool, Layered "
        "Variance Shadow Maps, 2008; Christoph Peters, Reinhard Klein, Moment Shadow Mapping, 2015",
    .summary =
        "Turns the depth of what the light sees into moments, averages them over a box, and bounds the lit fraction of "
        "a point from one bilinear mean. Errs as a shadow z-buffer does by texels and bias, blurs hard edges, and "
        "leaks "
        "light where a filter holds several depths; acne where light falls at a thousandth of a radian or less.",
    .parameters = kFilteredParameters,
    .presets    = {{"textbook", "kind=vsm,fit=scene,empty=far,bias=manual,bleed=0",
                    "Donnelly, Lauritzen 2006: mean and mean square of one map of the whole scene."},
                   {"fast", "resolution=512", "A map of 512 x 512 texels."},
                   {"best", "resolution=4096", "A map of 4096 x 4096 texels."}},
    .by_default = false,
    .shown_on   = {"sun_on_plane", "low_sun_fence", "interpenetrating"},
    .create     = create<FilteredMap>};

}  // namespace umbra
