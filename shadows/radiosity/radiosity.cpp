// Direct light as a radiosity system has it: surfaces are patches, a light sends each corner of a patch what its form
// factor and the sight between them let through, and patches are cut where that changes. Between corners S_j is
// interpolated. What surfaces send to one another is in exchange.h.
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

using namespace radiosity_detail;

namespace {

using Options       = RadiosityOptions;
using Interpolation = RadiosityOptions::Interpolation;

const std::vector<Parameter> kParameters{
    parameter<&Options::size>({.name  = "size",
                               .doc   = "Longest edge of a patch that is not cut further.",
                               .unit  = "scene diagonals",
                               .phase = Phase::build,
                               .min   = 0.001,
                               .max   = 1,
                               .sweep = "0.125|0.0625|0.03125|0.015625"}),
    parameter<&Options::levels>({.name  = "levels",
                                 .doc   = "How many times a patch is cut into four where S_j changes over it.",
                                 .phase = Phase::aim,
                                 .min   = 0,
                                 .max   = 8,
                                 .sweep = "0|2|4|6"}),
    parameter<&Options::threshold>({.name  = "threshold",
                                    .doc   = "The change of S_j over an element from which on it is cut.",
                                    .phase = Phase::aim,
                                    .min   = 0,
                                    .max   = 1}),
    parameter<&Options::samples>(
        {.name        = "samples",
         .doc         = "Points of an area light to which rays run from a corner; other lights take one.",
         .unit        = "rays a corner",
         .phase       = Phase::aim,
         .min         = 1,
         .max         = 4096,
         .sweep       = "16|64",
         .area_lights = true}),
    parameter<&Options::interpolation>({.name    = "interpolation",
                                        .doc     = "S_j over an element: linear between its corners, or their mean.",
                                        .phase   = Phase::visibility,
                                        .choices = "linear|constant"}),
};

}  // namespace

Service Radiosity::serves(const SceneFacts&) const {
    return {How::approximately, "S_j is known at the corners of patches, and interpolated between them"};
}

void Radiosity::build(const Scene& scene, const SceneFacts&) {
    scene_    = &scene;
    diagonal_ = static_cast<double>(bounds(scene).diagonal());
    sight_.emplace(scene);
    patches_ = Patches(scene, options.size * diagonal_);
}

void Radiosity::aim(LightId light) {
    light_ = &scene_->lights[light];
    for (const bool flipped : {false, true}) {
        std::vector<Elements>& elements = elements_[flipped ? 1 : 0];
        elements.assign(patches_.size(), {});
        parallel_ranges(patches_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) grow(static_cast<PatchId>(k), flipped, elements[k]);
        });
    }
}

void Radiosity::visibility(const PointBatch& points, LightId light, Visibility out) const {
    const bool linear = options.interpolation == Interpolation::linear;
    parallel_ranges(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!points.asks(light, i)) continue;
            const InPatch at = patches_.find(points.triangle[i], points.u[i], points.v[i]);
            out.s[i]         = elements_[points.flipped[i]][at.patch].at(at.u, at.v, linear);
        }
    });
}

void Radiosity::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            blockers[i] = kNoTriangle;
            if (!points.asks(light, i)) continue;
            const SurfacePoint from{exact_position(*scene_, points, i), dvec3(points.normal(i)), points.triangle[i]};
            blockers[i] = light_blocker(*sight_, from, *light_, options.samples);
            if (blockers[i] != kNoTriangle) continue;
            // Dark by what the corners of its element see: the nearest one first.
            const bool flipped = points.flipped[i] != 0;
            const InPatch at   = patches_.find(points.triangle[i], points.u[i], points.v[i]);
            auto corners       = elements_[flipped ? 1 : 0][at.patch].corners(at.u, at.v);
            std::ranges::sort(corners, {}, [&](dvec2 corner) {
                return glm::length(place(at.patch, flipped, corner).position - from.position);
            });
            for (const dvec2 corner : corners)
                if (blockers[i] == kNoTriangle)
                    blockers[i] = light_blocker(*sight_, place(at.patch, flipped, corner), *light_, options.samples);
        }
    });
}

Radiosity::ElementId Radiosity::element(const PointBatch& points, std::size_t i) const {
    const InPatch at = patches_.find(points.triangle[i], points.u[i], points.v[i]);
    return {at.patch, static_cast<std::uint32_t>(elements_[points.flipped[i]][at.patch].leaf(at.u, at.v))};
}

std::size_t Radiosity::elements() const {
    std::size_t count = 0;
    for (const auto& side : elements_)
        for (const Elements& patch : side) count += patch.leaves();
    return count;
}

std::size_t Radiosity::memory_bytes() const {
    std::size_t bytes = (sight_ ? sight_->memory_bytes() : 0) + patches_.memory_bytes();
    for (const auto& side : elements_)
        for (const Elements& patch : side) bytes += sizeof(Elements) + patch.memory_bytes();
    return bytes;
}

/// A place in a patch, seen from one side; `flipped`: from that which its winding does not face.
SurfacePoint Radiosity::place(PatchId patch, bool flipped, dvec2 at) const {
    // A corner of a triangle may touch a wall that stands on it: places are moved a little inside.
    constexpr double inside = 0x1p-12;
    const TriangleId t      = patches_.triangle(patch);
    const dvec3 a(scene_->vertex(t, 0)), ab = dvec3(scene_->vertex(t, 1)) - a, ac = dvec3(scene_->vertex(t, 2)) - a;
    const auto corner  = patches_.corners(patch);
    const dvec2 uv     = corner[0] + at.x * (corner[1] - corner[0]) + at.y * (corner[2] - corner[0]);
    const dvec2 moved  = (1 - inside) * uv + dvec2(inside / 3);
    const dvec3 normal = glm::normalize(glm::cross(ab, ac));
    return {a + moved.x * ab + moved.y * ac, flipped ? -normal : normal, t};
}

void Radiosity::grow(PatchId patch, bool flipped, Elements& elements) const {
    const TriangleId t = patches_.triangle(patch);
    const bool seen    = glm::length(area_normal(*scene_, t)) > 0 && (!flipped || scene_->material(t).two_sided);
    // Small triangles are not cut to less than patches of large ones are.
    int levels = seen ? options.levels : 0;
    for (double edge = patches_.longest_edge(patch); levels > 0 && edge < options.size * diagonal_ / 2; edge *= 2)
        --levels;
    const auto share = [&](double u, double v) {
        return seen ? light_share(*sight_, place(patch, flipped, {u, v}), *light_, options.samples) : 0.0f;
    };
    elements.grow(share, levels, static_cast<float>(options.threshold));
}

extern const MethodInfo radiosity;
const MethodInfo radiosity{
    .name  = "radiosity",
    .title = "Radiosity",
    .paper =
        "Cindy Goral, Kenneth Torrance, Donald Greenberg, Bennett Battaile, Modeling the Interaction of Light "
        "between Diffuse Surfaces, 1984; Michael Cohen, Donald Greenberg, David Immel, Philip Brock, An Efficient "
        "Radiosity Approach for Realistic Image Synthesis, 1986",
    .summary =
        "Surfaces are patches; at each corner rays to points of the light say which share of its irradiance arrives, "
        "and "
        "patches are cut where that changes. One solution serves all cameras. Errs between corners: shadow edges are "
        "as sharp as the elements are small, and what is smaller than a patch may be missed.",
    .parameters = kParameters,
    .presets    = {{"textbook", "levels=0,interpolation=constant",
                    "Goral and others 1984: equal patches of constant radiosity."},
                   {"fast", "size=0.0625,levels=2", "Larger patches."},
                   {"best", "size=0.015625,levels=6,threshold=0.02,samples=64", "Smaller patches, more rays."}},
    .by_default = false,
    .shown_on   = {"sun_on_plane", "umbra_penumbra", "closed_room"},
    .create     = create<Radiosity>};

}  // namespace umbra
