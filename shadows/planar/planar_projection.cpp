// Planar projection: project every occluder from the light onto the receiver's plane, and find the points that lie in
// its shadow. Blinn draws the projected polygons; here each surface point of the plane is asked whether one lies over
// it, so that there is no bitmap whose resolution could err.
//
// build finds the receivers, which are both sides of every large plane, and the occluders with their edges. aim picks
// the light's sources and projects from each of them, onto each receiver, the edges at which the number of shadows
// changes (outline.h). look sorts the points by receiver, and those of a receiver by where they lie in its plane.
// visibility darkens, for each source, the points over which there is a shadow (darkening_tree.h): S_j is the fraction
// of the sources from which the point stayed bright. A point where rounding leaves open whether there is one is decided
// by the exact segment to the source (geometry/exact_sight.h).
//
// This work is based on:
// James Blinn. Me and My (Fake) Shadow. 1988
// Paul Heckbert, Michael Herf. Simulating Soft Shadows with Graphics Hardware. 1997 (lights with an area)
// Philippe Bergeron. A General Version of Crow's Shadow Volumes. 1986 (edges that count)
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <optional>

#include "umbra/core/base/heights.h"
#include "umbra/core/base/lanes.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/geometry/exact_sight.h"
#include "umbra/shadows/geometry/point_groups.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/planar/darkening_tree.h"
#include "umbra/shadows/planar/outline.h"
#include "umbra/shadows/planar/project.h"

namespace umbra {

using namespace planar;

namespace {

/// The part of the machine's memory that an area light's shadows may take.
constexpr double kMemoryShare = 0.25;

enum class Edges : std::uint8_t { weighted, per_triangle };

struct Options {
    double plane_share = kPlanarShare;
    int light_samples  = 64;
    Edges edges        = Edges::weighted;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::plane_share>("plane_share", "Smallest share of the scene's area that makes a plane a receiver.",
                                     {.phase = Phase::build, .min = kPlanarShare, .max = 1}),
    parameter<&Options::light_samples>(
        "light_samples",
        "Points of an area light that occluders are projected from; other lights have one. 1: the "
        "centre. All their shadows are kept in memory.",
        {.unit        = "points a light",
         .phase       = Phase::aim,
         .min         = 1,
         .max         = 4096,
         .sweep       = "4|16|64|256",
         .area_lights = true}),
    parameter<&Options::edges>(
        "edges",
        "Which edges are projected. weighted: those whose triangles, turned to face the light, do not cancel: "
        "points count the shadows over them; per_triangle: all three of every triangle, whose shadows are "
        "tested one by one. The answers are the same.",
        {.phase = Phase::build, .choices = "weighted|per_triangle", .sweep = "weighted|per_triangle"}),
};

constexpr std::uint32_t kNoGroup = 0xffffffffu;

double area_of(const SceneFacts& facts) {
    double area = 0;
    for (const ObjectFacts& object : facts.objects) area += object.area;
    return area;
}

bool is_receiver(const PlanarReceiver& plane, double scene_area, const Options& options) {
    return plane.area >= options.plane_share * scene_area;
}

/// The occluders, and the receivers onto which they are projected.
struct Planes final : Built {
    Planes(const Scene& of, const SceneFacts& its_facts, const Options& options)
        : Built(of, its_facts),
          occluders{&of, {}, std::vector(of.triangles.size(), Occluders::kNoPlane)},
          group_of(of.triangles.size(), kNoGroup),
          sight(of) {
        const double area = area_of(facts);
        for (const PlanarReceiver& plane : facts.planes) {
            if (!is_receiver(plane, area, options)) continue;
            const auto index = static_cast<std::uint32_t>(receivers.size() / 2);
            for (const int side : {1, -1}) receivers.push_back(make_receiver(scene, plane, index, side));
            for (const TriangleId t : plane.triangles) {
                occluders.plane_of[t] = index;
                const dvec3 normal    = unit_normal(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
                group_of[t]           = 2 * index + (glm::dot(normal, receivers[2 * index].normal) < 0 ? 1 : 0);
            }
        }
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (occludes(scene, t)) occluders.triangles.push_back(t);
        if (options.edges == Edges::weighted && !receivers.empty())
            mesh.emplace(scene).left_out = std::vector<std::uint8_t>();  // occluders has a list
    }
    [[nodiscard]] std::size_t memory_bytes() const override {
        return receivers.size() * sizeof(Receiver) + occluders.plane_of.size() * sizeof(std::uint32_t) +
               occluders.triangles.size() * sizeof(TriangleId) + group_of.size() * sizeof(std::uint32_t) +
               (mesh ? mesh->memory_bytes() : 0) + sight.memory_bytes();
    }

    Occluders occluders;
    std::vector<Receiver> receivers;      ///< both sides of plane k at 2 k and 2 k + 1
    std::vector<std::uint32_t> group_of;  ///< of each triangle: the receiver that its front belongs to, or kNoGroup
    std::optional<OccluderMesh> mesh;     ///< where edges are projected
    const ExactSight sight;               ///< for points that rounding leaves open
};

/// The shadows of one light.
struct ProjectedLight final : Aimed {
    ProjectedLight(const Planes& planes, LightId at, const Options& options)
        : Aimed(planes, at),
          centre(centre_of(source())),
          sources(sources_of(source(), options.light_samples)),
          outlines(project(planes.occluders, planes.mesh ? &*planes.mesh : nullptr, planes.receivers, sources,
                           kMemoryShare * usable_memory())) {}
    [[nodiscard]] std::size_t memory_bytes() const override {
        return sources.size() * sizeof(Source) + planar::memory_bytes(outlines);
    }

    const Source centre;  ///< the light as one source
    const std::vector<Source> sources;
    const planar::LightOutlines outlines;
};

/// Points, as indices into the batch.
using Members = std::span<const std::uint32_t>;

/// A point that is off the plane by its triangle's rounding is moved along its own ray to the light's centre, which
/// leaves unchanged what that ray meets.
PlaneTree tree_of(const Scene& scene, const PointBatch& points, Members members, const Receiver& receiver,
                  const LocalSource& centre) {
    LeafPlaces places(points, members, [&](TriangleId t) -> std::array<dvec3, 3> {
        const auto [a, b, c] = local_triangle(scene, t, receiver);
        return {a, b - a, c - a};
    });
    return {members.size(), [&, places](auto& at, std::size_t begin, std::size_t end) mutable {
                places.find(begin, end);
                for (std::size_t k = 0; k < PlaneTree::kLeaf; ++k) {
                    const double x = places.x[k], y = places.y[k], z = places.z[k];
                    // As LocalSource::project, where the light's centre is above the point.
                    const double step = centre.at_infinity          ? -z / centre.at.z
                                        : centre.at.z > std::abs(z) ? z / (centre.at.z - z)
                                                                    : 0;
                    at[0][begin + k]  = x + step * (centre.at_infinity ? centre.at.x : x - centre.at.x);
                    at[1][begin + k]  = y + step * (centre.at_infinity ? centre.at.y : y - centre.at.y);
                }
            }};
}

/// The surface points on the receivers.
struct OnPlanes final : Looked {
    /// The points on one receiver, in an order in which neighbours are near.
    struct Group {
        RawVector<std::uint32_t> members;
        std::optional<PlaneTree> tree;  ///< where no point is off the plane, so that none is moved for any light
    };

    OnPlanes(const Planes& planes, const PointBatch& at) : Looked(at), groups(planes.receivers.size()) {
        auto members = grouped(points, groups.size(), [&](std::size_t i) -> std::size_t {
            if (points.triangle[i] == kNoTriangle) return kNoGroup;
            const std::uint32_t side = planes.group_of[points.triangle[i]];
            return side == kNoGroup ? side : side ^ points.flipped[i];
        });
        for (std::size_t r = 0; r < groups.size(); ++r) {
            groups[r].members        = std::move(members[r]);
            const Receiver& receiver = planes.receivers[r];
            if (!points.raster)  // rasters are in order
                sort_in_plane(groups[r].members,
                              [&](std::uint32_t p) { return dvec2(receiver.local(dvec3(points.position(p)))); });
            if (groups[r].members.empty() || receiver.tolerance != 0) continue;
            const LocalSource above(receiver, {true, vec3(receiver.normal)});
            groups[r].tree = tree_of(planes.scene, points, groups[r].members, receiver, above);
        }
    }
    [[nodiscard]] std::size_t memory_bytes() const override {
        std::size_t bytes = 0;
        for (const Group& group : groups)
            bytes += group.members.size() * sizeof(std::uint32_t) + (group.tree ? group.tree->memory_bytes() : 0);
        return bytes;
    }

    std::vector<Group> groups;  ///< one a receiver
};

class PlanarProjection final : public MethodWith<Options, Planes, ProjectedLight, OnPlanes> {
public:
    explicit PlanarProjection(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        const double area  = area_of(facts);
        double served      = 0;
        std::size_t planes = 0;
        bool flat          = true;
        for (const PlanarReceiver& plane : facts.planes)
            if (is_receiver(plane, area, options)) {
                ++planes;
                served += plane.area;
                flat = flat && plane.exact;
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

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const Planes& planes               = as<Planes>(aimed.built);
        const ProjectedLight& light        = as<ProjectedLight>(aimed);
        const std::vector<Source>& sources = light.sources;
        parallel_ranges(looked.points.size(), 65536, [&](std::size_t begin, std::size_t end) {
            const Facing* const facing = looked.points.facing[aimed.light].data();
            for (std::size_t i = begin; i < end; ++i)
                out.answer[i] = is_asked(facing[i]) ? Answer::undefined : out.answer[i];
        });
        for_each_receiver(light, looked, [&](std::size_t r, Members members, const PlaneTree& places) {
            const Receiver& receiver = planes.receivers[r];
            DarkeningTree tree(places);
            std::vector<std::uint32_t> sources_seen(sources.size() > 1 ? members.size() : 0, 0);
            for (std::size_t s = 0; s < sources.size(); ++s) {
                const LocalSource source(receiver, sources[s]);
                if (!source.is_above()) continue;  // the receiver does not see this part of the light
                if (s > 0) tree.brighten();
                const Outline& outline = light.outlines[s][r];
                darken(tree, planes.scene, receiver, source, outline.rest);
                tree.darken(outline);
                darken_doubtful(tree, planes.sight, looked.points, members, light_at(aimed.source(), sources[s]));
                parallel_ranges(sources_seen.size(), 65536, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i) sources_seen[i] += !tree.is_dark(i);
                });
            }
            const auto all = static_cast<float>(sources.size());
            parallel_ranges(members.size(), 65536, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const std::uint32_t p = members[i];
                    out.s[p]              = sources_seen.empty() ? (tree.is_dark(i) ? 0.0f : 1.0f)
                                                                 : static_cast<float>(sources_seen[i]) / all;
                    out.answer[p]         = Answer::given;
                }
            });
        });
    }

    /// Tests every point against every shadow, since few are asked for: the first that holds one is named.
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const Planes& planes        = as<Planes>(aimed.built);
        const ProjectedLight& light = as<ProjectedLight>(aimed);
        std::ranges::fill(blockers, kNoTriangle);
        for_each_receiver(light, looked, [&](std::size_t r, Members members, const PlaneTree& places) {
            const Receiver& receiver = planes.receivers[r];
            for (const Source& from : light.sources) {
                const LocalSource source(receiver, from);
                const auto shadows = project(planes.occluders, planes.occluders.triangles, receiver, from);
                parallel_ranges(members.size(), 16, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin; i < end; ++i)
                        if (blockers[members[i]] == kNoTriangle)
                            blockers[members[i]] = first_over(planes.scene, receiver, source, shadows, places.point(i));
                });
            }
        });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason            = Method::explain(aimed, looked, i, given);
        const Planes& planes     = as<Planes>(aimed.built);
        const std::uint32_t side = planes.group_of[looked.points.triangle[i]];
        if (side == kNoGroup) {
            reason.evidence.push_back({"receiver", "no plane"});
            return reason;
        }
        const std::uint32_t index = side ^ looked.points.flipped[i], plane = index / 2;
        const Receiver& receiver = planes.receivers[index];
        const LocalSource centre(receiver, as<ProjectedLight>(aimed).centre);
        reason.evidence.push_back({"receiver", static_cast<double>(plane)});
        reason.evidence.push_back({"flatness of the receiver", receiver.tolerance, "world"});
        reason.evidence.push_back(
            {centre.at_infinity ? "slope of the light above the receiver" : "height of the light above the receiver",
             centre.at.z, centre.at_infinity ? "" : "world"});
        if (is_area(aimed.source().kind))
            add_samples(reason, static_cast<int>(as<ProjectedLight>(aimed).sources.size()), given);
        return reason;
    }

private:
    /// Calls body(r, points, where they lie) with the points on receiver r that ask for the light, where there are any.
    template <class Body>
    static void for_each_receiver(const ProjectedLight& light, const Looked& looked, const Body& body) {
        const Planes& planes     = as<Planes>(light.built);
        const PointBatch& points = looked.points;
        const auto asks          = [&](std::uint32_t i) { return points.asks(light.light, i); };
        for (std::size_t r = 0; r < planes.receivers.size(); ++r) {
            const auto& [all, tree_of_all] = as<OnPlanes>(looked).groups[r];
            std::atomic<std::size_t> asking{0};
            parallel_ranges(all.size(), 65536, [&, &all = all](std::size_t begin, std::size_t end) {
                asking += static_cast<std::size_t>(std::count_if(all.data() + begin, all.data() + end, asks));
            });
            if (asking == 0) continue;
            // A light that the points' own triangles face, but that is not above the plane to which these belong up to
            // rounding, leaves nothing to project.
            if (std::ranges::none_of(light.sources,
                                     [&](const Source& s) { return LocalSource(planes.receivers[r], s).is_above(); }))
                continue;
            const bool all_ask = asking == all.size();
            RawVector<std::uint32_t> some;
            if (!all_ask) std::ranges::copy_if(all, std::back_inserter(some), asks);
            const Members members = all_ask ? Members(all) : Members(some);
            if (all_ask && tree_of_all)
                body(r, members, *tree_of_all);
            else
                body(r, members,
                     tree_of(planes.scene, points, members, planes.receivers[r],
                             LocalSource(planes.receivers[r], light.centre)));
        }
    }

    /// Darkens the points that lie in any of the shadows.
    static void darken(DarkeningTree& tree, const Scene& scene, const Receiver& receiver, const LocalSource& source,
                       const std::vector<Shadows>& runs) {
        const double far = farthest(reach_of(receiver, source));
        parallel_ranges(runs.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t r = first; r < last; ++r)
                for (const Shadow& shadow : runs[r].shadows)
                    tree.darken(shadow, sides_of(scene, receiver, source, runs[r], shadow, far));
        });
    }

    /// The light, as the point that it is projected from.
    static Light light_at(Light light, const Source& source) {
        if (!is_area(light.kind)) return light;
        light.kind     = LightKind::point;
        light.position = source.at;
        return light;
    }

    /// Darkens those of the points that rounding leaves open which do not see the light.
    static void darken_doubtful(DarkeningTree& tree, const ExactSight& sight, const PointBatch& points, Members members,
                                const Light& light) {
        const std::vector<std::uint32_t> which = tree.doubtful();
        parallel_ranges(which.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                if (!sight.is_lit(points, members[which[k]], light)) tree.darken(which[k]);
        });
    }
};

}  // namespace

extern const MethodInfo planar_projection{
    .name  = "planar_projection",
    .title = "Planar projection",
    .paper = "James Blinn, Me and My (Fake) Shadow, 1988",
    .summary =
        "Projects all occluders from the light onto each plane of the scene and tests the plane's points against "
        "their outlines. Exact on planes for lights without an area; says nothing about curved receivers. Limit: more "
        "than a million scene sizes from the origin float coordinates merge faces into planes that are none.",
    .parameters = kParameters,
    .presets    = {{"textbook", "light_samples=1,edges=per_triangle",
                    "Blinn 1988: every polygon projected, from the light's centre."},
                   {"fast", "light_samples=4", "Four points of an area light."},
                   {"best", "light_samples=256", "256 points of an area light."}},
    .create     = create<PlanarProjection>,
};

}  // namespace umbra
