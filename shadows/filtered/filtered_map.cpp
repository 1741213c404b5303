// Filterable shadow maps: draw depth from the light, turn it into moments that may be averaged, and bound the lit
// fraction of a surface point by the mean moments about it.
//
//   build       the casters (shadows/maps)
//   aim         chooses views and draws depth as the shadow z-buffer does (shadows/maps), then turns each sample into
//               moments and averages these over a box (moment_map.h)
//   visibility  takes each point to the view that covers it, moves it towards the light by the bias, and asks one
//               bilinear mean for a bound of the fraction that does not block (moments.h), in place of the comparisons
//               of PCF with every sample
// look makes nothing. filter=pcss has windows in place of the box, of any size by summed-area tables
// (summed_moments.h): those in which it searches for the blockers of an area light, and one as wide as the penumbra
// behind these (shadows/maps/penumbra.h).
//
// This work is based on the papers in moments.h and summed_moments.h, and on:
// Randima Fernando. Percentage-Closer Soft Shadows. 2005 (filter=pcss)
// Li Shen, Jieqing Feng, Baoguang Yang. Exponential Soft Shadow Mapping. 2013 (filter=pcss, kind=evsm2, evsm4)
#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/shadows/filtered/summed_moments.h"
#include "umbra/shadows/maps/answers.h"
#include "umbra/shadows/maps/map_options.h"
#include "umbra/shadows/maps/penumbra.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

enum class DepthBias : std::uint8_t { automatic, manual };
enum class MomentFilter : std::uint8_t { box, pcss };

struct FilteredOptions : MapOptions, ViewOptions, SearchOptions {
    MomentFilter filter       = MomentFilter::box;
    int parts                 = 2;
    int searches              = 3;
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
        "kind",
        "What is kept of depth. vsm: mean and mean square; esm: an exponential; evsm2: mean and mean square of "
        "an exponential; evsm4: of two, the second of negative depth; msm: means of four powers.",
        {.phase = Phase::aim, .choices = "vsm|esm|evsm2|evsm4|msm", .sweep = "vsm|evsm4|msm"}),
    parameter<&FilteredOptions::filter>(
        "filter",
        "box: a mean about the point. pcss: for area lights the mean depth of what blocks in a wide window, "
        "and then the lit fraction of one as wide as the penumbra behind that, both from a summed-area "
        "table; for other lights box.",
        {.phase = Phase::aim, .choices = "box|pcss", .area_lights = true}),
    search_parameter<FilteredOptions>("pcss: how far from the point windows reach, at most."),
    parameter<&FilteredOptions::parts>(
        "parts", "pcss: parts of a window along each side, each compared with the receiver's plane in its middle.",
        {.min = 1, .max = 16, .area_lights = true}),
    parameter<&FilteredOptions::searches>(
        "searches",
        "pcss: windows that are searched for what blocks, each as wide as the penumbra behind what the one "
        "before has found.",
        {.min = 1, .max = 16, .area_lights = true}),
    resolution_parameter<FilteredOptions>("Texels along each side of a map; a cube has six maps.",
                                          "512|1024|2048|4096"),
    radius_parameter<FilteredOptions>("box: the mean of (2 radius + 1)^2 texels, and between them bilinear.", 64,
                                      "1|4"),
    parameter<&FilteredOptions::positive_exponent>(
        "positive_exponent",
        "esm, evsm2, evsm4: factor of depth, -1 to 1, in the exponential; taken as 42 at most "
        "where precision=float, so that its square is a number, and as 5 in the tables of "
        "filter=pcss.",
        {.phase = Phase::aim, .min = 0.01, .max = kMostExponentTwofold}),
    parameter<&FilteredOptions::negative_exponent>(
        "negative_exponent", "evsm4: the same factor for the exponential of negative depth, with the same limits.",
        {.phase = Phase::aim, .min = 0.01, .max = kMostExponentTwofold}),
    parameter<&FilteredOptions::bleed>(
        "bleed",
        "Light-bleed cut: a lit fraction of the drawn texels below this is 0, what is above is stretched over "
        "0 to 1. Removes leaks and narrows penumbrae of the filter.",
        {.min = 0, .max = 0.99}),
    parameter<&FilteredOptions::min_variance>("min_variance",
                                              "vsm, evsm2, evsm4: no variance of depth is taken as less.",
                                              {.unit = "squares of the map's depth range", .min = 0, .max = 1}),
    parameter<&FilteredOptions::moment_bias>(
        "moment_bias", "msm: fraction of the moments 0, 3/8, 0, 3/8 that is mixed in, against rounding.",
        {.min = 0, .max = 1}),
    parameter<&FilteredOptions::empty>(
        "empty",
        "Texels on which nothing was drawn. far: depth of the far plane; apart: never block, and only the "
        "drawn fraction of the filter is bounded by moments; one more number a texel.",
        {.phase = Phase::aim, .choices = "far|apart"}),
    parameter<&FilteredOptions::precision>("precision", "Numbers that moments are kept in.",
                                           {.phase = Phase::aim, .choices = "float|double"}),
    parameter<&FilteredOptions::bias>(
        "bias",
        "Depth that is looked up. manual: the point's, less constant and slope bias; auto: less also a texel "
        "width and a quarter of the depth gradient, each times 2 radius + 1, at most 16 such widths.",
        {.choices = "auto|manual"}),
    constant_parameter<FilteredOptions>(),
    slope_parameter<FilteredOptions>(),
    normal_offset_parameter<FilteredOptions>(),
    fit_parameter<FilteredOptions>(),
    surround_parameter<FilteredOptions>(),
};

constexpr double kSteps = 0x1p16;  // of S_j: floats keep moments to 2^-24, and bounds are ratios of their differences

/// The result of `aim`: the views of a light, and their moments.
struct FilteredViews final : LightViews {
    using LightViews::LightViews;
    /// Moments, and the depth that blame asks.
    [[nodiscard]] std::size_t memory_bytes() const override {
        std::size_t bytes = LightViews::memory_bytes();
        for (const MomentMap& map : maps) bytes += map.memory_bytes();
        for (const SummedMoments& table : tables) bytes += table.memory_bytes();
        return bytes;
    }
    std::vector<MomentMap> maps;        ///< of the views, in their order
    std::vector<SummedMoments> tables;  ///< in their place, where blockers of an area light are searched
};

class FilteredMap final : public MethodWith<FilteredOptions, BuiltCasters> {
public:
    explicit FilteredMap(const Settings& settings) : MethodWith(settings) {
        const double most = options.precision == MomentPrecision::single ? kMostExponentSingle : kMostExponentTwofold;
        bound_ = {options.kind, std::min(options.positive_exponent, most), std::min(options.negative_exponent, most),
                  options.min_variance, options.moment_bias};
        soft_bound_          = bound_;
        soft_bound_.positive = std::min(bound_.positive, SummedMoments::kMostExponent);
        soft_bound_.negative = std::min(bound_.negative, SummedMoments::kMostExponent);
        if (finds_blockers_ && options.kind == MomentKind::esm)
            throw UsageError(
                "filtered_map: filter=pcss sums exponentials of 5 times the depth at most, of which kind=esm keeps too "
                "little to tell what blocks, expected kind=vsm, evsm2, evsm4 or msm");
        // Moments are kept beside the depth that they are made of.
        int bytes = MomentMap::bytes_per_sample(options.kind, options.empty, options.precision);
        if (finds_blockers_) bytes = std::max(bytes, SummedMoments::bytes_per_sample(options.kind, options.empty));
        const double of_depth = 4.0 / (4 + bytes);
        const double reach    = std::max<double>(options.radius, search_);
        // Surfaces nearer to the light than the fitted ones count as on the near plane: a quarter of the map's side
        // before those, so that exponentials of the two depths differ, too.
        const MapMargins room = margins("filtered_map", options, options.radius, reach, 0.25 * options.resolution);
        map_options_          = {.method       = "filtered_map",
                                 .resolution   = options.resolution,
                                 .all_depths   = finds_blockers_,
                                 .surround     = options.surround,
                                 .border       = room.border,
                                 .headroom     = room.headroom,
                                 .memory_limit = of_depth * LightViews::half_of_memory()};
    }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        std::string why = "any triangles and lights, through a filtered map that leaks light where depths differ";
        if (!facts.hard_lights_only)
            why += finds_blockers_ ? "; penumbrae are as wide as those behind one blocker that is parallel to the map"
                                   : "; area lights are taken as their centres, so that penumbrae are missing";
        return {How::approximately, why + "."};
    }

    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        auto filtered   = std::make_unique<FilteredViews>(built, light, map_options_);
        const bool soft = finds_blockers_ && is_area(filtered->source().kind);
        for (const MapView& view : filtered->views())
            if (soft)
                filtered->tables.emplace_back(view, soft_bound_, options.empty, 2 * search_);
            else
                filtered->maps.emplace_back(view, bound_, options.radius, options.empty, options.precision);
        return filtered;
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& of   = as<FilteredViews>(aimed);
        const auto share = [&](std::size_t v, const Receiver& receiver, dvec3 p) {
            const MapView& view = of.views()[v];
            return of.tables.empty() ? lit(view, of.maps[v], receiver)
                                     : soft_lit(view, of.tables[v], receiver, of.source(), p);
        };
        look_up(of, looked.points, bias_, compared(of), out, point_by_point(share));
    }

    /// Whose depth the map holds in the texel under the filter that blocks the point, the nearest of several. Draws the
    /// maps again.
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const auto& of     = as<FilteredViews>(aimed);
        const Filter asked = searched(of);
        BlockingSamples samples(looked.points.size());
        for_each_facet(of.scene(), looked.points, of.light, [&](std::size_t i, const Facet& facet, dvec3 p) {
            if (auto found = receive(of.views(), facet, p, bias_, compared(of))) {
                found->receiver.bias = total_bias(found->receiver);
                samples.find(i, found->view, of.views()[found->view], found->receiver, BiasMode::manual, asked);
            }
        });
        samples.name(blockers, [&](std::size_t v, auto where) { return of.owners(v, where); });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        const PointBatch& points = looked.points;
        const auto& of           = as<FilteredViews>(aimed);
        FacetOfPoint at{of.scene(), points};
        const dvec3 p      = at.go_to(i);
        const auto found   = receive(of.views(), at.facet, p, bias_, compared(of));
        TriangleId blocker = kNoTriangle;
        if (found && given.answer == Answer::given && given.s < 1) {
            Receiver biased = found->receiver;
            biased.bias     = total_bias(biased);
            if (const auto sample = blocked_sample(of.views()[found->view], biased, BiasMode::manual, searched(of)))
                blocker = of.owner(found->view, *sample);
        }
        Reason reason = reason_by_geometry(of.scene(), points, i, aimed.light, given, blocker);
        if (!found) {
            reason.evidence.push_back({"map", "none shows the point"});
            return reason;
        }
        add_texel(reason, *found, of.views()[found->view], given);
        if (!of.tables.empty()) return reason;
        const Receiver& receiver     = found->receiver;
        const FilteredDepth filtered = of.maps[found->view].at(receiver.x, receiver.y);
        const double z               = compared_depth(of.views()[found->view], receiver.r + total_bias(receiver));
        reason.evidence.push_back({"drawn fraction of the filter", filtered.drawn});
        if (filtered.drawn == 0) return reason;
        reason.evidence.push_back({"bound of the lit fraction by moments", lit_bound(bound_, filtered.moments, z)});
        return reason;
    }

private:
    /// The samples that may have darkened a point: those of a window may be farther away.
    [[nodiscard]] Filter searched(const FilteredViews& of) const {
        return of.tables.empty() ? filter_ : Filter{static_cast<int>(std::ceil(search_)), false};
    }

    /// The filter of the automatic bias: the parts of a window follow the receiver's plane, however wide it is.
    [[nodiscard]] Filter compared(const FilteredViews& of) const { return of.tables.empty() ? filter_ : Filter{}; }

    /// Nearness that is added to the point's: the filter's samples have one depth to be compared with.
    [[nodiscard]] static double total_bias(const Receiver& r) { return r.bias + std::min(r.slack, r.most); }

    /// The nearness to compare with at an offset from the point, in samples: the nearer of the point and its plane
    /// there.
    [[nodiscard]] double nearness_at(const Receiver& r, dvec2 offset) const {
        if (bias_.mode == BiasMode::manual) return r.r + r.bias;
        const double plane = r.r + r.r_x * offset.x + r.r_y * offset.y;
        return plane + std::min(std::max(0.0, r.r - plane) + r.slack, r.most) + r.bias;
    }

    /// As far as the empty texels, and no farther, unless those are apart.
    [[nodiscard]] double compared_depth(const MapView& view, double nearness) const {
        const double most = options.empty == EmptySamples::far ? 1 : kInfinity;
        return std::min(linear_depth(view.frame, nearness), most);
    }

    [[nodiscard]] double lit(const FilteredDepth& filtered, const MomentBound& of, double z) const {
        const double bound = lit_bound(of, filtered.moments, z);
        const double cut   = std::max(0.0, (bound - options.bleed) / (1 - options.bleed));
        const double s     = std::clamp(1 - filtered.drawn * (1 - cut), 0.0, 1.0);
        // Bounds tend to 0 and 1; what float moments do not tell from these is 0 or 1.
        return std::round(s * kSteps) / kSteps;
    }

    [[nodiscard]] float lit(const MapView& view, const MomentMap& map, const Receiver& receiver) const {
        const FilteredDepth filtered = map.at(receiver.x, receiver.y);
        if (filtered.drawn == 0) return 1;
        return static_cast<float>(lit(filtered, bound_, compared_depth(view, receiver.r + total_bias(receiver))));
    }

    /// PCSS with means in place of samples. A window has parts x parts of its own, each of which is compared with the
    /// receiver's plane in its middle: a receiver that slants does not shade itself, and occluders that differ in depth
    /// fall into different parts.
    [[nodiscard]] float soft_lit(const MapView& view, const SummedMoments& table, const Receiver& receiver,
                                 const Light& light, dvec3 p) const {
        const LightFrame& f = view.frame;
        const dvec3 q       = f.light_space(p);
        const dvec2 size    = rectangle_as(f, light, dvec2(q) / q.z);
        const int parts     = options.parts;
        const dvec2 at(receiver.x, receiver.y);
        // Windows that are searched hold whole samples: four entries of the table in place of sixteen.
        const auto for_window = [&](double depth, bool searched, const auto& body) {
            const dvec2 half = penumbra_reach(view, size, depth, q.z, search_) / static_cast<double>(parts);
            for (int j = 0; j < parts; ++j)
                for (int i = 0; i < parts; ++i) {
                    const dvec2 offset = half * dvec2(2 * i + 1 - parts, 2 * j + 1 - parts);
                    dvec2 low = at + offset - half, high = at + offset + half;
                    if (searched) low = glm::floor(low), high = glm::ceil(high);
                    const WindowedDepth part = table.mean(low, high);
                    if (part.drawn > 0) body(part, compared_depth(view, nearness_at(receiver, offset)));
                }
        };
        // The mean of the first window also has blockers of other points alone; the next windows are narrower.
        double blocking = f.near;
        for (int k = 0; k < options.searches; ++k) {
            double sum = 0, dark = 0;
            for_window(blocking, true, [&](const WindowedDepth& part, double z) {
                const double lit = lit_bound(soft_bound_, part.moments, z), weight = part.drawn * (1 - lit);
                sum += weight * occluder_depth(lit, part.depth, z);
                dark += weight;
            });
            if (dark == 0) return 1;
            blocking = f.near + sum / dark * (f.far - f.near);
        }
        double blocked = 0;
        for_window(blocking, false,
                   [&](const WindowedDepth& part, double z) { blocked += 1 - lit(part, soft_bound_, z); });
        return static_cast<float>(1 - blocked / (parts * parts));
    }

    const bool finds_blockers_ = options.filter == MomentFilter::pcss;
    const double search_       = finds_blockers_ ? options.search * options.resolution : 0;  ///< texels
    const Filter filter_{options.radius, true};
    const Bias bias_{options.bias == DepthBias::manual ? BiasMode::manual : BiasMode::automatic, options.constant,
                     options.slope, options.normal_offset};
    MomentBound bound_, soft_bound_;  ///< of maps and of tables
    LightViews::Options map_options_;
};

}  // namespace

extern const MethodInfo filtered_map{
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
    .presets    = {{"soft", "filter=pcss,kind=vsm,bleed=0,min_variance=1e-10,resolution=512",
                    "Yang and others 2010: penumbrae of area lights, by a search for blockers in means."},
                   {"textbook", "kind=vsm,fit=scene,empty=far,bias=manual,bleed=0",
                    "Donnelly, Lauritzen 2006: mean and mean square of one map of the whole scene."},
                   {"fast", "resolution=512", "A map of 512 x 512 texels."},
                   {"best", "resolution=4096", "A map of 4096 x 4096 texels."}},
    .by_default = false,
    .shown      = true,
    .create     = create<FilteredMap>};

}  // namespace umbra
