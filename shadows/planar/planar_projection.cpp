// Planar projection: project every occluder from the light onto the receiver's plane, and find the points that lie in
// its shadow.
//
// This work is based on:
// James Blinn. Me and My (Fake) Shadow. 1988
// Paul Heckbert, Michael Herf. Simulating Soft Shadows with Graphics Hardware. 1997 (lights with an area)
// Philippe Bergeron. A General Version of Crow's Shadow Volumes. 1986 (edges that count)
//
// Blinn draws the projected polygons. Here they are not drawn: each surface point of the plane is asked whether a
// projected triangle lies over it, so that there is no bitmap whose resolution could err.
//
// build finds the receivers, which are both sides of every large plane, and the occluders with their edges. aim picks
// the light's sources and projects from each of them, onto each receiver, the edges at which the number of shadows
// changes (outline.h). visibility sorts the points by receiver and, for each source, darkens those over which there is
// a shadow (darkening_tree.h): S_j is the fraction of the sources from which the point stayed bright. A point where
// rounding leaves open whether there is one is tested against every triangle.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "umbra/core/base/heights.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/planar/darkening_tree.h"
#include "umbra/shadows/planar/outline.h"
#include "umbra/shadows/planar/project.h"
#include "umbra/shadows/shared/point_groups.h"

namespace umbra {
namespace {

using planar::DarkeningTree;
using planar::LocalSource;
using planar::OccluderEdges;
using planar::Occluders;
using planar::Outline;
using planar::Receiver;
using planar::Shadow;
using planar::Shadows;
using planar::Source;

/// The part of the machine's memory that an area light's shadows may take.
constexpr double kMemoryShare = 0.25;

enum class Edges : std::uint8_t { weighted, per_triangle };

struct Options {
    double plane_share = kPlanarShare;
    int light_samples  = 64;
    Edges edges        = Edges::weighted;
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
    parameter<&Options::edges>(
        {.name = "edges",
         .doc  = "Which edges are projected. weighted: those whose triangles, turned to face the light, do not cancel: "
                 "points count the shadows over them; per_triangle: all three of every triangle, whose shadows are "
                 "tested one by one. The answers are the same.",
         .phase   = Phase::build,
         .choices = "weighted|per_triangle",
         .sweep   = "weighted|per_triangle"}),
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
        outlines_.clear();
        edges_.reset();
        group_of_.assign(scene.triangles.size(), kNoGroup);
        occluders_  = {&scene, {}, std::vector(scene.triangles.size(), Occluders::kNoPlane)};
        double area = 0;
        for (const ObjectFacts& object : facts.objects) area += object.area;
        for (const PlanarReceiver& plane : facts.planes) {
            if (!is_receiver(plane, area)) continue;
            const auto index = static_cast<std::uint32_t>(receivers_.size() / 2);
            for (const int side : {1, -1}) receivers_.push_back(planar::make_receiver(scene, plane, index, side));
            for (const TriangleId t : plane.triangles) {
                occluders_.plane_of[t] = index;
                const dvec3 normal     = unit_normal(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
                group_of_[t]           = 2 * index + (glm::dot(normal, receivers_[2 * index].normal) < 0 ? 1 : 0);
            }
        }
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (scene.blocks(t) && !is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2)))
                occluders_.triangles.push_back(t);
        if (options.edges == Edges::weighted && !receivers_.empty()) edges_.emplace(occluders_);
    }

    void aim(LightId id) override {
        const Light& light = occluders_.scene->lights[id];
        centre_            = planar::centre_of(light);
        sources_           = planar::sources_of(light, options.light_samples);
        outlines_.clear();  // before new ones take memory
        outlines_ = planar::project(occluders_, edges_ ? &*edges_ : nullptr, receivers_, sources_,
                                    kMemoryShare * usable_memory());
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        parallel_ranges(points.size(), 65536, [&](std::size_t begin, std::size_t end) {
            const Facing* const facing = points.facing[light].data();
            for (std::size_t i = begin; i < end; ++i)
                out.answer[i] = facing[i] >= Facing::partly ? Answer::undefined : out.answer[i];
        });
        for_each_receiver(points, light, [&](std::size_t r, RawVector<std::uint32_t>& members) {
            // A light that the point's own triangle faces, but that is not above the plane to which the triangle
            // belongs up to rounding, leaves nothing to project.
            if (std::ranges::none_of(sources_,
                                     [&](const Source& s) { return LocalSource(receivers_[r], s).is_above(); }))
                return;
            const std::size_t count = members.size();
            Places at               = positions(points, members, receivers_[r]);
            DarkeningTree tree(std::move(members), std::move(at.x), std::move(at.y), points.raster.has_value());
            std::vector<std::uint32_t> sources_seen(sources_.size() > 1 ? count : 0, 0);
            for (std::size_t s = 0; s < sources_.size(); ++s) {
                const LocalSource source(receivers_[r], sources_[s]);
                if (!source.is_above()) continue;  // the receiver does not see this part of the light
                if (s > 0) tree.brighten();
                const Outline& outline = outlines_[s][r];
                darken(tree, receivers_[r], source, outline.rest);
                darken_one_by_one(tree, tree.darken(outline), receivers_[r], sources_[s]);
                parallel_ranges(sources_seen.size(), 65536, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i) sources_seen[i] += !tree.is_dark(i);
                });
            }
            const auto all = static_cast<float>(sources_.size());
            parallel_ranges(count, 65536, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const std::uint32_t p = tree.points()[i];
                    out.s[p]              = sources_seen.empty() ? (tree.is_dark(i) ? 0.0f : 1.0f)
                                                                 : static_cast<float>(sources_seen[i]) / all;
                    out.answer[p]         = Answer::given;
                }
            });
        });
    }

    /// Tests every point against every shadow, since few are asked for: the first that holds one is named.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        std::ranges::fill(blockers, kNoTriangle);
        for_each_receiver(points, light, [&](std::size_t r, const RawVector<std::uint32_t>& members) {
            const Places at = positions(points, members, receivers_[r]);
            for (const Source& from : sources_) {
                const LocalSource source(receivers_[r], from);
                const auto shadows = planar::project(occluders_, occluders_.triangles, receivers_[r], from);
                parallel_ranges(members.size(), 16, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i)
                        if (blockers[members[i]] == kNoTriangle)
                            blockers[members[i]] = planar::first_over(*occluders_.scene, receivers_[r], source, shadows,
                                                                      {at.x[i], at.y[i]});
                });
            }
        });
    }

    std::size_t memory_bytes() const override {
        return receivers_.size() * sizeof(Receiver) + occluders_.plane_of.size() * sizeof(std::uint32_t) +
               occluders_.triangles.size() * sizeof(TriangleId) + group_of_.size() * sizeof(std::uint32_t) +
               (edges_ ? edges_->memory_bytes() : 0) + sources_.size() * sizeof(Source) +
               planar::memory_bytes(outlines_);
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
        auto groups = grouped(points, receivers_.size(), [&](std::size_t i) -> std::size_t {
            if (!points.asks(light, i)) return kNoGroup;
            const std::uint32_t side = group_of_[points.triangle[i]];
            return side == kNoGroup ? side : side ^ points.flipped[i];
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

    /// Darkens those of some points of the tree that lie in any shadow.
    void darken_one_by_one(DarkeningTree& tree, const std::vector<std::uint32_t>& which, const Receiver& receiver,
                           const Source& from) const {
        if (which.empty()) return;
        RawVector<std::uint32_t> some(which.begin(), which.end());
        RawVector<double> x, y;
        for (const std::uint32_t i : some) x.push_back(tree.place(i).x), y.push_back(tree.place(i).y);
        DarkeningTree few(std::move(some), std::move(x), std::move(y), false);
        const auto shadows = planar::project(occluders_, occluders_.triangles, receiver, from);
        darken(few, receiver, LocalSource(receiver, from), shadows);
        for (std::size_t i = 0; i < few.points().size(); ++i)
            if (few.is_dark(i)) tree.darken(few.points()[i]);
    }

    static constexpr std::size_t kTogether = 16;  ///< points, whose places are computed at once

    /// Where points lie in a plane.
    struct Places {
        RawVector<double> x, y;
    };

    /// A point that is off the plane by its triangle's rounding is moved along its own ray to the light's centre, which
    /// leaves unchanged what that ray meets.
    Places positions(const PointBatch& points, const RawVector<std::uint32_t>& members,
                     const Receiver& receiver) const {
        const LocalSource centre(receiver, centre_);
        const Scene& scene = *occluders_.scene;
        Places places{RawVector<double>(members.size()), RawVector<double>(members.size())};
        parallel_ranges((members.size() + kTogether - 1) / kTogether, 1024, [&](std::size_t first, std::size_t last) {
            TriangleId before = kNoTriangle;
            dvec3 a{0}, ab{0}, ac{0};
            const auto stand_on = [&](TriangleId t) {  // neighbours are mostly on one triangle
                if (t == before) return;
                before = t;
                a      = receiver.local(dvec3(scene.vertex(t, 0)));
                ab     = receiver.local(dvec3(scene.vertex(t, 1))) - a;
                ac     = receiver.local(dvec3(scene.vertex(t, 2))) - a;
            };
            for (std::size_t begin = first * kTogether; begin < std::min(last * kTogether, members.size());
                 begin += kTogether) {
                const std::size_t count = std::min(kTogether, members.size() - begin);
                // Of points in squares of 4 x 4 pixels, the first of each row: what follows in memory is another row.
                if (begin + 5 * kTogether < members.size())
                    for (const std::size_t k : {0, 2, 8, 10}) {
                        const std::uint32_t p = members[begin + 4 * kTogether + k];
                        __builtin_prefetch(&points.triangle[p]);
                        __builtin_prefetch(&points.u[p]);
                        __builtin_prefetch(&points.v[p]);
                    }
                double u[kTogether]{}, v[kTogether]{};
                bool one = count == kTogether;
                for (std::size_t k = 0; k < count; ++k) {
                    const std::uint32_t p = members[begin + k];
                    u[k] = static_cast<double>(points.u[p]), v[k] = static_cast<double>(points.v[p]);
                    one &= points.triangle[p] == points.triangle[members[begin]];
                }
                for (std::size_t k = 0; k < count; k += one ? kTogether : 1) {
                    stand_on(points.triangle[members[begin + k]]);
                    for (std::size_t j = k; j < (one ? kTogether : k + 1); ++j) {
                        const double x = a.x + u[j] * ab.x + v[j] * ac.x, y = a.y + u[j] * ab.y + v[j] * ac.y;
                        const double z = a.z + u[j] * ab.z + v[j] * ac.z;
                        // As LocalSource::project, where the light's centre is above the point.
                        const double step   = centre.at_infinity          ? -z / centre.at.z
                                              : centre.at.z > std::abs(z) ? z / (centre.at.z - z)
                                                                          : 0;
                        places.x[begin + j] = x + step * (centre.at_infinity ? centre.at.x : x - centre.at.x);
                        places.y[begin + j] = y + step * (centre.at_infinity ? centre.at.y : y - centre.at.y);
                    }
                }
            }
        });
        return places;
    }

    static constexpr std::uint32_t kNoGroup = 0xffffffffu;

    Occluders occluders_;
    std::vector<Receiver> receivers_;  ///< both sides of plane k at 2 k and 2 k + 1
    std::vector<Source> sources_;
    Source centre_;                        ///< the light as one source
    std::vector<std::uint32_t> group_of_;  ///< of each triangle: the receiver that its front belongs to, or kNoGroup
    std::optional<OccluderEdges> edges_;
    planar::LightOutlines outlines_;
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
    .presets    = {{"textbook", "light_samples=1,edges=per_triangle",
                    "Blinn 1988: every polygon projected, from the light's centre."},
                   {"fast", "light_samples=4", "Four points of an area light."},
                   {"best", "light_samples=256", "256 points of an area light."}},
    .create     = create<PlanarProjection>,
};

}  // namespace umbra
