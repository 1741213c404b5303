// Direct light as a radiosity system has it: surfaces are patches, a light sends to each corner of a patch by its form
// factor and the sight between them, and patches are cut where that changes. Between corners S_j is interpolated. Light
// that surfaces send to one another is in exchange.h.
//
//     build        patches: triangles cut into equal parts; the tree of triangles that rays are traced in
//     aim          S_j at the corners of each patch and, while it changes over it, of the four that it is cut into
//     look         nothing: a point's patch is found again for each light
//     visibility   the element of each point, and S_j between its corners
//
// This work is based on:
// Cindy Goral, Kenneth Torrance, Donald Greenberg, Bennett Battaile. Modeling the Interaction of Light between Diffuse
// Surfaces. 1984
// Michael Cohen, Donald Greenberg, David Immel, Philip Brock. An Efficient Radiosity Approach for Realistic Image
// Synthesis. 1986 (patches are cut where light changes)
#include "umbra/shadows/radiosity/radiosity.h"

#include <algorithm>

#include "umbra/core/base/parallel.h"

namespace umbra {

using namespace patches;

SurfacePoint RadiosityPatches::place(PatchId patch, bool flipped, dvec2 at) const {
    // A corner of a triangle may touch a wall that stands on it: points are moved a little inside.
    constexpr double inside = 0x1p-12;
    const TriangleId t      = patches.triangle(patch);
    const dvec3 a(scene.vertex(t, 0)), ab = dvec3(scene.vertex(t, 1)) - a, ac = dvec3(scene.vertex(t, 2)) - a;
    const auto corner  = patches.corners(patch);
    const dvec2 uv     = corner[0] + at.x * (corner[1] - corner[0]) + at.y * (corner[2] - corner[0]);
    const dvec2 moved  = (1 - inside) * uv + dvec2(inside / 3);
    const dvec3 normal = glm::normalize(glm::cross(ab, ac));
    return {a + moved.x * ab + moved.y * ac, flipped ? -normal : normal, t};
}

RadiosityElements::ElementId RadiosityElements::element(const PointBatch& points, std::size_t i) const {
    const InPatch at = surfaces.find(points, i);
    return {at.patch, static_cast<std::uint32_t>(sides[points.flipped[i]][at.patch].leaf(at.u, at.v))};
}

std::size_t RadiosityElements::memory_bytes() const {
    std::size_t bytes = 0;
    for (const auto& side : sides)
        for (const Elements& patch : side) bytes += sizeof(Elements) + patch.memory_bytes();
    return bytes;
}

namespace {

enum class Interpolation : std::uint8_t { linear, constant };

struct Options {
    double size                 = 0.03125;
    int levels                  = 4;
    double threshold            = 0.05;
    int samples                 = 16;
    Interpolation interpolation = Interpolation::linear;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::size>("size", "Longest edge of a patch that is not cut further.",
                              {.unit  = "scene diagonals",
                               .phase = Phase::build,
                               .min   = 0.001,
                               .max   = 1,
                               .sweep = "0.125|0.0625|0.03125|0.015625"}),
    parameter<&Options::levels>("levels", "How many times a patch is cut into four where S_j changes over it.",
                                {.phase = Phase::aim, .min = 0, .max = 8, .sweep = "0|2|4|6"}),
    parameter<&Options::threshold>("threshold", "The change of S_j over an element from which on it is cut.",
                                   {.phase = Phase::aim, .min = 0, .max = 1}),
    parameter<&Options::samples>(
        "samples", "Points of an area light to which rays run from a corner; other lights take one.",
        {.unit = "rays a corner", .phase = Phase::aim, .min = 1, .max = 4096, .sweep = "16|64", .area_lights = true}),
    parameter<&Options::interpolation>("interpolation",
                                       "S_j over an element: linear between its corners, or their mean.",
                                       {.choices = "linear|constant"}),
};

class Radiosity final : public MethodWith<Options> {
public:
    explicit Radiosity(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Measure measures() const override { return Measure::irradiance; }

    [[nodiscard]] Service serves(const SceneFacts&) const override {
        return {How::approximately, "S_j is known at the corners of patches, and interpolated between them"};
    }

    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        return std::make_unique<RadiosityPatches>(scene, facts, options.size);
    }

    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        const auto& surfaces = as<RadiosityPatches>(built);
        auto aimed           = std::make_unique<RadiosityElements>(surfaces, light);
        for (const bool flipped : {false, true})
            parallel_ranges(surfaces.patches.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = begin; k < end; ++k)
                    grow(surfaces, aimed->source(), static_cast<PatchId>(k), flipped, aimed->sides[flipped ? 1 : 0][k]);
            });
        return aimed;
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& light        = as<RadiosityElements>(aimed);
        const PointBatch& points = looked.points;
        const bool linear        = options.interpolation == Interpolation::linear;
        for_each_asked(aimed, looked, 4096, [&](std::size_t i) {
            const InPatch at = light.surfaces.find(points, i);
            out.s[i]         = light.sides[points.flipped[i]][at.patch].at(at.u, at.v, linear);
        });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason            = Method::explain(aimed, looked, i, given);
        const auto& light        = as<RadiosityElements>(aimed);
        const auto [patch, leaf] = light.element(looked.points, i);
        reason.evidence.push_back({"patch", static_cast<double>(patch)});
        reason.evidence.push_back({"element of the patch", static_cast<double>(leaf)});
        reason.margin = static_cast<double>(given.s) - 0.5;
        reason.unit   = "of the light";
        return reason;
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const auto& light                = as<RadiosityElements>(aimed);
        const RadiosityPatches& surfaces = light.surfaces;
        const PointBatch& points         = looked.points;
        const auto blocker               = [&](const SurfacePoint& from) {
            return light_blocker(surfaces.sight, from, aimed.source(), options.samples);
        };
        blame_each(aimed, looked, blockers, [&](std::size_t i) {
            const SurfacePoint from{exact_position(aimed.scene(), points, i), dvec3(points.normal(i)),
                                    points.triangle[i]};
            TriangleId found = blocker(from);
            // Else dark by the view of its element's corners: the nearest one first.
            const bool flipped = points.flipped[i] != 0;
            const InPatch at   = surfaces.find(points, i);
            auto corners       = light.sides[flipped ? 1 : 0][at.patch].corners(at.u, at.v);
            std::ranges::sort(corners, {}, [&](dvec2 corner) {
                return glm::length(surfaces.place(at.patch, flipped, corner).position - from.position);
            });
            for (const dvec2 corner : corners)
                if (found == kNoTriangle) found = blocker(surfaces.place(at.patch, flipped, corner));
            return found;
        });
    }

private:
    /// Cuts one side of a patch where S_j of the light changes over it.
    void grow(const RadiosityPatches& surfaces, const Light& light, PatchId patch, bool flipped,
              Elements& elements) const {
        const Scene& scene = surfaces.scene;
        const TriangleId t = surfaces.patches.triangle(patch);
        const bool seen    = glm::length(area_normal(scene, t)) > 0 && (!flipped || scene.material(t).two_sided) &&
                          scene.switches(t).receives_shadows;  // else nobody asks
        // Small triangles are not cut to less than patches of large ones are.
        const double longest = options.size * surfaces.diagonal;
        int levels           = seen ? options.levels : 0;
        for (double edge = surfaces.patches.longest_edge(patch); levels > 0 && edge < longest / 2; edge *= 2) --levels;
        const auto fraction = [&](double u, double v) {
            return seen ? light_share(surfaces.sight, surfaces.place(patch, flipped, {u, v}), light, options.samples)
                        : 0.0f;
        };
        elements.grow(fraction, levels, static_cast<float>(options.threshold));
    }
};

}  // namespace

extern const MethodInfo radiosity{
    .name  = "radiosity",
    .title = "Radiosity",
    .paper =
        "Cindy Goral, Kenneth Torrance, Donald Greenberg, Bennett Battaile, Modeling the Interaction of Light "
        "between Diffuse Surfaces, 1984; Michael Cohen, Donald Greenberg, David Immel, Philip Brock, An Efficient "
        "Radiosity Approach for Realistic Image Synthesis, 1986",
    .summary =
        "Surfaces are patches; at each corner rays to points of the light say which share of its irradiance arrives, "
        "and patches are cut where that changes. One solution serves all cameras. Errs between corners: shadow edges are "
        "as sharp as the elements are small, and what is smaller than a patch may be missed.",
    .parameters = kParameters,
    .presets    = {{"textbook", "levels=0,interpolation=constant",
                    "Goral and others 1984: equal patches of constant radiosity."},
                   {"fast", "size=0.0625,levels=2", "Larger patches."},
                   {"best", "size=0.015625,levels=6,threshold=0.02,samples=64", "Smaller patches, more rays."}},
    .by_default = false,
    .shown      = true,
    .create     = create<Radiosity>};

}  // namespace umbra
