// Planar projection: project every occluder from the light onto the receiver's plane, and find the points that lie in
// its shadow.
//
// This work is based on:
// James Blinn. Me and My (Fake) Shadow. 1988
// Paul Heckbert, Michael Herf. Simulating Soft Shadows with Graphics Hardware. 1997 (lights with an area)
//
// Blinn draws the projected polygons. Here they are not drawn: each surface point of the plane is tested against the
// projected triangles themselves, so that there is no bitmap whose resolution could err.
//
// build finds the receivers, which are both sides of every large plane, and the occluders. aim picks the light's
// sources and projects every occluder from each of them onto each receiver (project.h). visibility sorts the points by
// receiver and, for each source, darkens those that lie in a shadow (darkening_tree.h): S_j is the fraction of the
// sources from which the point stayed bright.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/planar/darkening_tree.h"
#include "umbra/shadows/planar/groups.h"
#include "umbra/shadows/planar/project.h"

namespace umbra {
namespace {

using planar::DarkeningTree;
using planar::LocalSource;
using planar::Occluders;
using planar::Receiver;
using planar::Shadow;
using planar::Shadows;
using planar::Source;

/// The part of the machine's memory that an area light's shadows may take.
constexpr double kMemoryShare = 0.25;

struct Options {
    double plane_share = kPlanarShare;
    int light_samples  = 64;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::plane_share>({.name  = "plane_share",
                                      .doc   = "Smallest share of the scene's area that makes a plane a receiver.",
                                      .phase = Phase::build,
                                      .min   = kPlanarShare,
                                      .max   = 1}),
    parameter<&Options::light_samples>({.name  = "light_samples",
                                        .doc   = "Points of an area light that occluders are projected from; other "
                                                 "lights have one. 1: the centre. All their shadows are kept in memory.",
                                        .unit  = "points a light",
                                        .phase = Phase::aim,
                                        .min   = 1,
                                        .max   = 4096,
                                        .sweep = "4|16|64|256",
                                        .area_lights = true}),
};

class PlanarProjection final : public MethodWith<Options> {
public:
    Service serves(const SceneFacts& facts) const override {
        double area = 0, served = 0;
        std::size_t planes = 0;
        bool flat          = true;
        for (const ObjectFacts& object : facts.objects) area += object.area;
        for (const PlanarReceiver& plane : facts.planes)
            if (is_receiver(plane, area)) {
                ++planes;
                served += plane.area;
                flat = flat && is_flat(plane, facts.box);
            }
        if (planes == 0)
            return {How::not_at_all,
                    fmt::format("the scene has no planar receiver: no plane holds {:.3g} % of its area",
                                100 * options.plane_share)};
        const std::string where =
            fmt::format("on {} plane{}, which hold{} {:.3g} % of the scene's area; points elsewhere stay undefined",
                        planes, planes == 1 ? "" : "s", planes == 1 ? "s" : "", 100 * served / area);
        // Triangles that are a plane up to rounding may shade one another where the light grazes them, and are merged
        // with others that only look like it where rounding is coarse.
        if (facts.hard_lights_only && !flat)
            return {How::approximately,
                    fmt::format("some planes are flat up to the rounding of floats only; {}", where)};
        if (facts.hard_lights_only) return {How::to_rounding, where};
        if (options.light_samples == 1)
            return {How::approximately,
                    fmt::format("lights with an area are taken as their centres: umbra only, no penumbra; {}", where)};
        return {How::approximately,
                fmt::format("lights with an area are taken at {} points; {}", options.light_samples, where)};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        receivers_.clear();
        sources_.clear();
        shadows_.clear();
        occluders_  = {&scene, {}, std::vector(scene.triangles.size(), Occluders::kNoPlane)};
        double area = 0;
        for (const ObjectFacts& object : facts.objects) area += object.area;
        for (const PlanarReceiver& plane : facts.planes) {
            if (!is_receiver(plane, area)) continue;
            const auto index = static_cast<std::uint32_t>(receivers_.size() / 2);
            for (const TriangleId t : plane.triangles) occluders_.plane_of[t] = index;
            for (const int side : {1, -1}) receivers_.push_back(planar::make_receiver(scene, plane, index, side));
        }
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (scene.blocks(t) && !is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2)))
                occluders_.triangles.push_back(t);
    }

    void aim(LightId id) override {
        const Light& light = occluders_.scene->lights[id];
        centre_            = planar::centre_of(light);
        sources_           = planar::sources_of(light, options.light_samples);
        shadows_.clear();  // before new ones take memory
        shadows_ = planar::project(occluders_, receivers_, sources_, kMemoryShare * usable_memory());
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        parallel_ranges(points.size(), 65536, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                if (points.asks(light, i)) out.answer[i] = Answer::undefined;
        });
        for_each_receiver(points, light, [&](std::size_t r, std::vector<std::uint32_t>& members) {
            // A light that the point's own triangle faces, but that is not above the plane to which the triangle
            // belongs up to rounding, leaves nothing to project.
            if (std::ranges::none_of(sources_,
                                     [&](const Source& s) { return LocalSource(receivers_[r], s).is_above(); }))
                return;
            const std::size_t count = members.size();
            const auto at           = positions(points, members, receivers_[r]);
            DarkeningTree tree(std::move(members), at, points.raster.has_value());
            std::vector<std::uint32_t> sources_seen(count, 0);
            for (std::size_t s = 0; s < sources_.size(); ++s) {
                const LocalSource source(receivers_[r], sources_[s]);
                if (!source.is_above()) continue;  // the receiver does not see this part of the light
                tree.brighten();
                darken(tree, receivers_[r], source, shadows_[s][r]);
                parallel_ranges(count, 65536, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i) sources_seen[i] += !tree.is_dark(i);
                });
            }
            parallel_ranges(count, 65536, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const std::uint32_t p = tree.points()[i];
                    out.s[p]              = static_cast<float>(sources_seen[i]) / static_cast<float>(sources_.size());
                    out.answer[p]         = Answer::given;
                }
            });
        });
    }

    /// Tests every point against every shadow, since few are asked for: the first that holds one is named.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        std::ranges::fill(blockers, kNoTriangle);
        for_each_receiver(points, light, [&](std::size_t r, const std::vector<std::uint32_t>& members) {
            const std::vector<dvec2> at = positions(points, members, receivers_[r]);
            for (std::size_t s = 0; s < sources_.size(); ++s) {
                const LocalSource source(receivers_[r], sources_[s]);
                parallel_ranges(members.size(), 16, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i)
                        if (blockers[members[i]] == kNoTriangle)
                            blockers[members[i]] =
                                planar::first_over(*occluders_.scene, receivers_[r], source, shadows_[s][r], at[i]);
                });
            }
        });
    }

    std::size_t memory_bytes() const override {
        return receivers_.size() * sizeof(Receiver) + occluders_.plane_of.size() * sizeof(std::uint32_t) +
               occluders_.triangles.size() * sizeof(TriangleId) + sources_.size() * sizeof(Source) +
               planar::memory_bytes(shadows_);
    }

private:
    bool is_receiver(const PlanarReceiver& plane, double scene_area) const {
        return plane.area >= options.plane_share * scene_area;
    }

    /// Whether all its corners lie in it, up to the arithmetic that found it, in double.
    static bool is_flat(const PlanarReceiver& plane, const Box& box) {
        const vec3 reach = glm::max(glm::abs(box.min), glm::abs(box.max));
        return plane.tolerance <= 64 * 0x1p-53 * double(reach.x + reach.y + reach.z);
    }

    /// Calls body(r, points) with the points on receivers_[r] that face the light, where there are any.
    template <class Body>
    void for_each_receiver(const PointBatch& points, LightId light, const Body& body) const {
        auto groups = planar::grouped(points, receivers_.size(), [&](std::size_t i) -> std::size_t {
            if (!points.asks(light, i)) return Occluders::kNoPlane;
            const std::uint32_t plane = occluders_.plane_of[points.triangle[i]];
            if (plane == Occluders::kNoPlane) return Occluders::kNoPlane;
            const bool below = glm::dot(dvec3(points.normal(i)), receivers_[2 * plane].normal) < 0;
            return 2 * plane + below;
        });
        for (std::size_t r = 0; r < groups.size(); ++r)
            if (!groups[r].empty()) body(r, groups[r]);
    }

    /// Darkens the points that lie in any of the shadows.
    void darken(DarkeningTree& tree, const Receiver& receiver, const LocalSource& source,
                const std::vector<Shadows>& runs) const {
        parallel_ranges(runs.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t r = first; r < last; ++r)
                for (const Shadow& shadow : runs[r].shadows)
                    tree.darken(shadow, planar::sides_of(*occluders_.scene, receiver, source, runs[r], shadow));
        });
    }

    /// Where the points lie in the plane. A point that is off it by its triangle's rounding is moved along its own ray
    /// to the light's centre, which leaves unchanged what that ray meets.
    std::vector<dvec2> positions(const PointBatch& points, const std::vector<std::uint32_t>& members,
                                 const Receiver& receiver) const {
        const LocalSource centre(receiver, centre_);
        std::vector<dvec2> at(members.size());
        parallel_ranges(members.size(), 16384, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const dvec3 x      = receiver.local(exact_position(*occluders_.scene, points, members[i]));
                const bool aligned = centre.at_infinity || centre.at.z > std::abs(x.z);
                at[i]              = aligned ? centre.project(x) : dvec2(x);
            }
        });
        return at;
    }

    Occluders occluders_;
    std::vector<Receiver> receivers_;  ///< both sides of plane k at 2 k and 2 k + 1
    std::vector<Source> sources_;
    Source centre_;  ///< the light as one source
    planar::LightShadows shadows_;
};

}  // namespace

extern const MethodInfo planar_projection;
const MethodInfo planar_projection{
    .name  = "planar_projection",
    .title = "Planar projection",
    .paper = "James Blinn, Me and My (Fake) Shadow, 1988",
    .summary =
        "Projects all occluders from the light onto each plane of the scene and tests the plane's points against "
        "their outlines. Exact on planes for lights without an area; says nothing about curved receivers. Limit: more "
        "than a million "
        "scene sizes from the origin float coordinates merge faces into planes that are none.",
    .parameters = kParameters,
    .presets    = {{"textbook", "light_samples=1", "Blinn 1988: one shadow a plane, from the light's centre."},
                   {"fast", "light_samples=4", "Four points of an area light."},
                   {"best", "light_samples=256", "256 points of an area light."}},
    .create     = create<PlanarProjection>,
};

}  // namespace umbra
