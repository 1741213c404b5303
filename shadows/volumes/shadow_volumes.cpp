// Shadow volumes: every point counts how many volumes it lies in; it is lit where that is none.
//
// A triangle that occludes light bounds a volume: the triangle itself, its near cap, and from each of its edges a side
// that runs away from the light to infinity; with a light at a finite position a far cap at infinity closes it. Sides
// between neighbouring triangles cancel, so that only silhouette edges extrude one. A point finds its count along the
// line from a point of known count, the view's origin O (depth-pass), or from infinity (depth-fail):
//
//     O ------- p ---[F====B]-->     depth-pass: nothing between O and p,    count(p) = count(O)      lit
//     O --[F==== p ====B]------>     one face entered between,               count(p) = count(O) + 1  umbra
//
// There is no near and no far plane, no stencil and no pixel: faces are counted at the exact points (counting_tree.h).
// A point that a face, an edge seen from O, or a line that an edge's end runs away along passes within rounding is
// marked, and decided apart, by the exact segment to the light (geometry/exact_sight.h).
//
// build welds the objects' vertices and finds their edges. aim finds the triangles that bound a volume and the edges
// that extrude a side. look chooses O, and sorts the surface points as seen from there into a tree. visibility adds the
// faces of the volumes to counts in the tree, and reads them at the points that the light is in front of; it alone asks
// for exact segments, and the first that does sorts the triangles into a tree of boxes.
//
// This work is based on:
// Frank Crow. Shadow Algorithms for Computer Graphics. 1977
// Philippe Bergeron. A General Version of Crow's Shadow Volumes. 1986
// Tim Heidmann. Real Shadows, Real Time. 1991
// Cass Everitt, Mark Kilgard. Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering. 2002
// Graham Aldridge, Eric Woods. Robust, Geometry-Independent Shadow Volumes. 2004
// Byungmoon Kim, Kihwan Kim, Greg Turk. A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters. 2008
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/scene/winding.h"
#include "umbra/shadows/geometry/exact_sight.h"
#include "umbra/shadows/geometry/triangle_tree.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/volumes/seen_volumes.h"

namespace umbra {
namespace {

enum class Counting : std::uint8_t { depth_pass, depth_fail };
enum class Edges : std::uint8_t { weighted, silhouette, per_triangle };

struct Options {
    Counting counting = Counting::depth_pass;
    Edges edges       = Edges::weighted;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::counting>(
        "counting",
        "Which faces a point counts. depth_pass: those between it and the viewpoint, starting from the "
        "viewpoint's own count; depth_fail: those beyond it, with caps at infinity.",
        {.choices = "depth_pass|depth_fail", .sweep = "depth_pass|depth_fail"}),
    parameter<&Options::edges>(
        "edges",
        "Which edges extrude a side. weighted: those whose triangles, turned to face the light, do not "
        "cancel; silhouette: of closed meshes that are wound outwards and have the light outside, silhouettes "
        "of the triangles that face it, right unless such a mesh turns inside out where it crosses itself; "
        "per_triangle: all three edges of every triangle.",
        {.phase   = Phase::aim,
         .choices = "weighted|silhouette|per_triangle",
         .sweep   = "weighted|silhouette|per_triangle"}),
};

/// The objects as meshes that know their edges.
struct Meshes final : Built {
    Meshes(const Scene& of, const SceneFacts& its_facts)
        : Built(of, its_facts), meshes(of, its_facts.objects), sight(of) {}
    [[nodiscard]] std::size_t memory_bytes() const override { return meshes.memory_bytes() + sight.memory_bytes(); }
    const SilhouetteMeshes meshes;
    const ExactSight sight;
};

/// The triangles and edges that bound the volumes of one light.
struct Volumes final : Aimed {
    Volumes(const Meshes& from, LightId at, const Options& options)
        : Aimed(from, at), meshes(from.meshes), orientation(sides_of_light(scene(), source())) {
        leave_out_transparent();
        if (options.edges == Edges::silhouette) leave_out_back_faces();
        edges = options.edges == Edges::per_triangle ? all_edges() : meshes.edges(orientation);
    }
    [[nodiscard]] std::size_t memory_bytes() const override {
        return orientation.capacity() + edges.capacity() * sizeof(ChangeEdge);
    }

    const SilhouetteMeshes& meshes;
    std::vector<std::int8_t> orientation;  ///< of each triangle: +1 taken as wound, -1 flipped, 0 no occluder
    std::vector<ChangeEdge> edges;

private:
    void leave_out_transparent() {
        for (const Object& object : scene().objects)
            if (object.triangle_count > 0 && !scene().blocks(object.first_triangle))
                std::fill_n(orientation.begin() + object.first_triangle, object.triangle_count, std::int8_t{0});
    }

    /// From a solid that the light is outside of, a line to the light leaves as often as it enters, or once more: the
    /// triangles that face the light are enough.
    void leave_out_back_faces() {
        for (std::size_t o = 0; o < scene().objects.size(); ++o) {
            const Object& object = scene().objects[o];
            if (!built.facts.objects[o].solid) continue;
            if (source().kind != LightKind::directional &&
                std::abs(winding_number(scene(), object, dvec3(source().position))) > 1e-6)  // inside, or on it
                continue;
            for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
                orientation[t] = std::max<std::int8_t>(orientation[t], 0);
        }
    }

    [[nodiscard]] std::vector<ChangeEdge> all_edges() const {
        std::vector<ChangeEdge> all;
        for (std::size_t t = 0; t < orientation.size(); ++t) {
            if (orientation[t] == 0) continue;
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t i = meshes.triangles()[t][k], j = meshes.triangles()[t][(k + 1) % 3];
                all.push_back({std::min(i, j), std::max(i, j), i < j ? orientation[t] : -orientation[t]});
            }
        }
        return all;
    }
};

/// The surface points and the meshes' vertices, as seen from O.
struct Seen final : Looked {
    Seen(const Meshes& built, const PointBatch& at)
        : Looked(at), tree(built.scene, at), vertices(built.meshes, tree.view()) {}
    [[nodiscard]] std::size_t memory_bytes() const override {
        return tree.memory_bytes() + vertices.at.size() * sizeof(dvec3);
    }
    const CountingTree tree;
    const SeenVertices vertices;
};

class ShadowVolumes final : public MethodWith<Options, Meshes, Volumes, Seen> {
public:
    explicit ShadowVolumes(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::approximately, "area lights are taken as points at their centres: umbra only, no penumbra"};
        if (options.edges == Edges::silhouette && facts.closed_objects > 0)
            return {How::approximately,
                    "silhouettes of closed meshes are correct unless one turns inside out where it crosses itself"};
        return {How::to_rounding,
                "counts volumes at the points themselves, with weighted edges for open, "
                "non-manifold or inconsistently oriented meshes"};
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const Volumes& of = as<Volumes>(aimed);
        const Seen& seen  = as<Seen>(looked);
        const Light& l    = aimed.source();
        PointCounts counts(seen.tree, aimed.scene(), looked.points, aimed.light);
        if (counts.empty()) return;
        const SeenVolumes volumes(of.meshes, seen.vertices, l, seen.tree);
        const bool depth_fail     = options.counting == Counting::depth_fail;
        const std::int32_t origin = depth_fail ? 0 : volumes.count_at_origin(of.orientation);

        parallel_ranges(of.orientation.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (of.orientation[t] == 0) continue;
                volumes.add_near_cap(counts, static_cast<TriangleId>(t), of.orientation[t], depth_fail);
                if (depth_fail && l.kind != LightKind::directional)
                    volumes.add_far_cap(counts, static_cast<TriangleId>(t), of.orientation[t]);
            }
        });
        parallel_ranges(of.edges.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) volumes.add_side(counts, of.edges[e], depth_fail);
        });
        const bool has_area     = is_area(l.kind);
        const ExactSight& sight = as<Meshes>(aimed.built).sight;
        counts.for_each([&](std::uint32_t i, std::int32_t count, bool is_sure) {
            const bool behind = has_area && centre_is_behind(aimed.scene(), looked.points, aimed.light, i);
            const bool lit    = is_sure ? origin + count <= 0 : sight.is_lit(looked.points, i, l);
            out.s[i]          = lit && !behind ? 1.0f : 0.0f;
        });
    }

    /// A sum of crossings names no volume. So each volume is asked whether it holds the point, by its own planes, in
    /// double: the farthest triangle is named, which rounding at the point's own surface cannot be.
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const TriangleTree tree(aimed.scene());
        blame_each(aimed, looked, blockers, [&](std::size_t i) {
            const Line line(as<Volumes>(aimed), looked.points, i);
            Holding holding;
            tree.visit({line.p, line.to_light, line.end, 0}, [&](TriangleId t) {
                if (t != looked.points.triangle[i]) holding.add(t, line);
                return true;
            });
            return holding.farthest;
        });
    }

    /// As blame, and counts the volumes. Every triangle is asked, since a tree for one point would take longer.
    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        const Line line(as<Volumes>(aimed), looked.points, i);
        Holding holding;
        std::mutex mutex;
        parallel_ranges(line.of.orientation.size(), 16384, [&](std::size_t begin, std::size_t end) {
            Holding some;
            for (std::size_t t = begin; t < end; ++t)
                if (t != looked.points.triangle[i]) some.add(static_cast<TriangleId>(t), line);
            const std::lock_guard lock(mutex);
            holding.add(some);
        });
        const bool dark     = given.s < 1;
        Reason reason       = reason_by_geometry(aimed.scene(), looked.points, i, aimed.light, given,
                                           dark ? holding.farthest : kNoTriangle);
        const double layers = std::max(1.0, static_cast<double>(holding.count)) - 0.5;
        reason.margin       = dark ? -layers : 0.5;
        reason.unit         = "layers";
        reason.evidence.push_back({"volumes that hold the point", static_cast<double>(holding.count)});
        if (reason.blocker != kNoTriangle) reason.silhouette = silhouette_of(line.of, reason.blocker);
        if (centre_is_behind(aimed.scene(), looked.points, aimed.light, i))
            reason.evidence.push_back({"the light's centre is behind the surface", 1.0});
        return reason;
    }

private:
    /// The edges that extrude the sides of the volumes of the triangle's object.
    [[nodiscard]] static std::vector<std::array<dvec3, 2>> silhouette_of(const Volumes& volumes, TriangleId t) {
        const Scene& scene   = volumes.scene();
        const Object& object = scene.objects[scene.triangle_object[t]];
        std::map<std::uint32_t, dvec3> vertices;
        for (std::uint32_t u = object.first_triangle; u < object.first_triangle + object.triangle_count; ++u)
            for (int k = 0; k < 3; ++k) vertices[volumes.meshes.triangles()[u][k]] = dvec3(scene.vertex(u, k));
        std::vector<std::array<dvec3, 2>> edges;
        for (const ChangeEdge& edge : volumes.edges) {
            const auto a = vertices.find(edge.a), b = vertices.find(edge.b);
            if (a != vertices.end() && b != vertices.end()) edges.push_back({a->second, b->second});
        }
        return edges;
    }

    /// From a point to the light.
    struct Line {
        Line(const Volumes& volumes, const PointBatch& points, std::size_t i)
            : of(volumes), p(exact_position(of.scene(), points, i)) {
            const Light& light = of.source();
            if (light.kind == LightKind::directional)
                to_light = -dvec3(light.direction), end = std::numeric_limits<double>::infinity();
            else
                to_light = dvec3(light.position) - p;
        }
        const Volumes& of;
        dvec3 p, to_light{0};
        double end = 1;
    };

    /// The volumes that hold a point.
    struct Holding {
        std::size_t count   = 0;
        TriangleId farthest = kNoTriangle;
        double at           = 0;  ///< of `farthest`: fraction of the line

        void add(TriangleId t, const Line& line) {
            if (line.of.orientation[t] == 0) return;
            std::array<dvec3, 3> v = corners_of(line.of.scene(), t);
            for (dvec3& corner : v) corner -= line.p;
            int inside = 0;
            for (std::size_t k = 0; k < 3; ++k)
                inside += glm::dot(glm::cross(v[k], v[(k + 1) % 3]), line.to_light) >= 0 ? +1 : -1;
            if (std::abs(inside) != 3) return;
            const dvec3 n       = glm::cross(v[1] - v[0], v[2] - v[0]);
            const double across = glm::dot(n, v[0]) / glm::dot(n, line.to_light);
            if (!(across > 0 && across < line.end)) return;
            add({1, t, across});
        }
        void add(const Holding& other) {
            count += other.count;
            if (other.at > at) at = other.at, farthest = other.farthest;
        }
    };
};

}  // namespace

extern const MethodInfo shadow_volumes{
    .name  = "shadow_volumes",
    .title = "Shadow volumes",
    .paper = "Frank Crow, Shadow Algorithms for Computer Graphics, 1977",
    .summary =
        "Extrudes silhouettes away from the light and counts, at every point, the volumes that it lies in. "
        "Right to rounding for hard lights and any triangles; area lights have no penumbra. Limit: none was found on "
        "any ladder with hard lights, up to ten million scene sizes from the origin.",
    .parameters = kParameters,
    .presets    = {{"textbook", "edges=silhouette", "Silhouettes of closed meshes, counted from the viewpoint."},
                   {"fast", "edges=silhouette", "Silhouettes of closed meshes, counted from the viewpoint."}},
    .create     = create<ShadowVolumes>,
};

}  // namespace umbra
