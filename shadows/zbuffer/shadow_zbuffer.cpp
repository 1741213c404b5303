// Shadow z-buffer: draw depth from the light, then compare every surface point with it.
//
// The parts: casters (what can block the light), light_frame and light_views (which maps see that), depth_map (drawing
// them), depth_lookup (bias and filter).
//
// This work is based on:
// Lance Williams. Casting Curved Shadows on Curved Surfaces. 1978
// William Reeves, David Salesin, Robert Cook. Rendering Antialiased Shadows with Depth Maps. 1987 (PCF)
// Yulan Wang, Steven Molnar. Second-Depth Shadow Mapping. 1994 (faces=back)
// Christian Schueler. Eliminating Surface Acne with Gradient Shadow Mapping. 2005 (the receiver's plane as bias)
// Daniel Holbert. Saying Goodbye to Shadow Acne. 2011 (normal offset)
#include "umbra/shadows/zbuffer/shadow_zbuffer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr std::size_t kGrain = 4096;

constexpr Parameter kParameters[] = {
    {"resolution",
     Parameter::Type::integer,
     "2048",
     "samples along each side of a map (a cube has six)",
     16,
     16384,
     {}},
    {"depth", Parameter::Type::choice, "float", "bits of a depth value; float is kept reversed", 0, 0,
     "16|24|32|float"},
    {"bias", Parameter::Type::choice, "auto",
     "what a sample is compared with: manual: the point; receiver_plane: the point's plane at the sample, nearer by "
     "what rounding costs; auto: the nearer of the two, nearer still by a sample's width and a quarter of the depth "
     "gradient, but by no more than 16 widths from the plane",
     0, 0, "auto|receiver_plane|manual"},
    {"constant",
     Parameter::Type::real,
     "0",
     "moves the point towards the light, in widths of a sample there",
     0,
     1e6,
     {}},
    {"slope",
     Parameter::Type::real,
     "0",
     "moves the point towards the light, in times its plane's depth gradient a sample",
     0,
     1e6,
     {}},
    {"normal_offset",
     Parameter::Type::real,
     "0",
     "moves the point along its normal, in widths of a sample times the sine of the light's angle",
     0,
     64,
     {}},
    {"filter", Parameter::Type::choice, "nearest", "nearest: one comparison; pcf: the mean of those about the point", 0,
     0, "nearest|pcf"},
    {"radius", Parameter::Type::integer, "1", "pcf: takes (2 radius + 1)^2 samples", 0, 16, {}},
    {"bilinear",
     Parameter::Type::boolean,
     "true",
     "pcf: weights samples by how much of them the moving kernel covers",
     0,
     0,
     {}},
    {"faces", Parameter::Type::choice, "all",
     "which side of triangles casts; back (second depth) and front want closed, outward occluders", 0, 0,
     "all|front|back"},
    {"fit", Parameter::Type::choice, "casters",
     "what maps are fitted to: scene: all of it; casters: what can block the light, without planes behind all else", 0,
     0, "casters|scene"},
    {"surround",
     Parameter::Type::real,
     "0.5",
     "spot lights: resolution of the maps around the cone, in times the cone's own; 0: no maps, points undefined there",
     0,
     1,
     {}},
};

DepthFormat read_format(const std::string& depth) {
    return depth == "16"   ? DepthFormat::unorm16
           : depth == "24" ? DepthFormat::unorm24
           : depth == "32" ? DepthFormat::unorm32
                           : DepthFormat::float32;
}

Bias read_bias(const Settings& s) {
    const std::string& mode = s.choice("bias");
    return {mode == "auto"     ? BiasMode::automatic
            : mode == "manual" ? BiasMode::manual
                               : BiasMode::receiver_plane,
            s.real("constant"), s.real("slope"), s.real("normal_offset")};
}

Filter read_filter(const Settings& s) {
    if (s.choice("filter") != "pcf") return {};
    return {s.integer("radius"), s.boolean("bilinear")};
}

LightViews::Options read_map_options(const Settings& s, const Bias& bias, const Filter& filter) {
    const std::string& faces = s.choice("faces");
    return {.resolution     = s.integer("resolution"),
            .format         = read_format(s.choice("depth")),
            .faces          = faces == "front"  ? Faces::front
                              : faces == "back" ? Faces::back
                                                : Faces::all,
            .fit_to_casters = s.choice("fit") == "casters",
            .surround       = s.real("surround"),
            // What the filter and the offset may ask for, and a rounding.
            .border   = filter.radius + bias.normal_offset + 2,
            .headroom = std::max(64.0, kMostAutomatic * (4 * filter.radius + 2)) + bias.constant};
}

}  // namespace

ShadowZBuffer::ShadowZBuffer(const Settings& settings)
    : bias_(read_bias(settings)),
      filter_(read_filter(settings)),
      map_options_(read_map_options(settings, bias_, filter_)) {
    if (4 * map_options_.border > map_options_.resolution)
        throw UsageError(fmt::format(
            "radius={} and normal_offset={} reach over a quarter of resolution={} "
            "(choose a resolution of at least {})",
            filter_.radius, bias_.normal_offset, map_options_.resolution, std::ceil(4 * map_options_.border)));
}

Service ShadowZBuffer::serves(const SceneFacts& facts) const {
    std::string why = "any triangles and lights, through a map that samples depth";
    if (!facts.hard_lights_only) why += "; area lights stand in their centres, so that penumbrae are missing";
    if (map_options_.faces != Faces::all && (facts.open_objects > 0 || facts.nonmanifold_objects > 0))
        why += "; open meshes cast with one side only";
    return {How::approximately, why + "."};
}

void ShadowZBuffer::build(const Scene& scene, const SceneFacts& facts) { views_.emplace(scene, facts, map_options_); }

void ShadowZBuffer::aim(LightId light) { views_->aim(light); }

template <class Body>
void ShadowZBuffer::for_each_facet(const PointBatch& points, LightId light, const Body& body) const {
    const std::vector<Facing>& facing = points.facing[light];
    parallel_ranges(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Facet facet{};
        TriangleId facet_of = kNoTriangle;
        bool facet_flipped  = false;
        for (std::size_t i = begin; i < end; ++i) {
            if (facing[i] == Facing::none || facing[i] == Facing::away) continue;
            if (points.triangle[i] != facet_of || (points.flipped[i] != 0) != facet_flipped) {
                facet_of      = points.triangle[i];
                facet_flipped = points.flipped[i] != 0;
                facet         = make_facet(facet_of, facet_flipped);
            }
            body(i, facet,
                 facet.a + static_cast<double>(points.u[i]) * facet.ab + static_cast<double>(points.v[i]) * facet.ac);
        }
    });
}

void ShadowZBuffer::visibility(const PointBatch& points, LightId light, std::span<float> s,
                               std::span<std::uint8_t> defined) {
    for_each_facet(points, light, [&](std::size_t i, const Facet& facet, dvec3 p) {
        defined[i] = look_up(facet, p, points.facing[light][i], views_->scene().lights[light], s[i]);
    });
}

void ShadowZBuffer::blame(const PointBatch& points, LightId light, std::span<TriangleId> who) {
    struct Sample {
        std::size_t view = ~std::size_t{0};
        ivec2 at{0};
    };
    const std::vector<MapView>& views = views_->views();
    std::vector<Sample> samples(points.size());
    for_each_facet(points, light, [&](std::size_t i, const Facet& facet, dvec3 p) {
        for (std::size_t v = 0; v < views.size(); ++v)
            if (const std::optional<Receiver> receiver = receive(views[v], facet, p, bias_, filter_)) {
                if (const auto at = blocked_sample(views[v].map, *receiver, bias_.mode, filter_)) samples[i] = {v, *at};
                return;
            }
    });
    std::fill(who.begin(), who.end(), kNoTriangle);
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (std::ranges::find(samples, v, &Sample::view) == samples.end()) continue;
        const std::vector<TriangleId> owners = views_->owners(views[v]);
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i].view == v)
                who[i] = owners[static_cast<std::size_t>(samples[i].at.y) * views[v].map.width() + samples[i].at.x];
    }
}

std::size_t ShadowZBuffer::memory_bytes() const { return views_ ? views_->memory_bytes() : 0; }

Facet ShadowZBuffer::make_facet(TriangleId t, bool flipped) const {
    const Scene& scene = views_->scene();
    const dvec3 a(scene.vertex(t, 0));
    Facet facet{a, dvec3(scene.vertex(t, 1)) - a, dvec3(scene.vertex(t, 2)) - a, {}};
    facet.normal = glm::normalize(glm::cross(facet.ab, facet.ac)) * (flipped ? -1.0 : 1.0);
    return facet;
}

bool ShadowZBuffer::look_up(const Facet& facet, dvec3 p, Facing facing, const Light& light, float& s) const {
    // An area light that the receiver's plane cuts may have its centre behind.
    if (facing == Facing::partly && glm::dot(facet.normal, dvec3(light.position) - p) <= 0) {
        s = 0;
        return true;
    }
    for (const MapView& view : views_->views())
        if (const std::optional<Receiver> receiver = receive(view, facet, p, bias_, filter_)) {
            s = lit_share(view.map, *receiver, bias_.mode, filter_);
            return true;
        }
    s = 1;
    return views_->cover_all();
}

extern const MethodInfo shadow_zbuffer;
const MethodInfo shadow_zbuffer{
    "shadow_zbuffer",
    "Shadow z-buffer",
    "Lance Williams, Casting Curved Shadows on Curved Surfaces, 1978",
    "Draws the depth of what the light sees into a map, then compares each surface point with it. Serves any geometry; "
    "errs by the map's samples along shadow edges, loses gaps and occluders narrower than a sample, and moves contacts "
    "by up to 16 samples' widths where light grazes. The automatic bias holds for light down to 1e-5 radians above an "
    "even floor, 1e-3 above one that rounding has left uneven, and for lamps up to 1e12 scene sizes away.",
    kParameters,
    make_method<ShadowZBuffer>,
};

}  // namespace umbra
