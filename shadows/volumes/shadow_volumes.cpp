// Shadow volumes: every point counts how many volumes it lies in; it is lit where that is none.
//
// A triangle that occludes light bounds a volume: the triangle itself, its near cap, and from each of its edges a side
// that runs away from the light to infinity; with a light at a finite place a far cap at infinity closes it. Sides
// between neighbouring triangles cancel, so that only silhouette edges extrude one. A point finds its count along the
// line from a place of known count, the view's origin O (depth-pass), or from infinity (depth-fail):
//
//     O ------- p ---[F====B]-->     depth-pass: nothing between O and p,    count(p) = count(O)      lit
//     O --[F==== p ====B]------>     one face entered between,               count(p) = count(O) + 1  umbra
//
// There is no near and no far plane, no stencil and no pixel: faces are counted at the exact points (counting_tree.h).
// In the projection from O every edge, and every line that an edge's end runs away along, is one half-space that all
// faces beside it share bit for bit, so that no point is lost or counted twice between two faces.
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
#include <atomic>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/triangle_tree.h"
#include "umbra/shadows/volumes/counting_tree.h"
#include "umbra/shadows/volumes/silhouettes.h"

namespace umbra {
namespace {

/// How often the object's surface winds around q. [Adriaan van Oosterom, Jan Strackee, The Solid Angle of a Plane
/// Triangle, 1983]
double winding_number(const SilhouetteMeshes& meshes, const Object& object, dvec3 q) {
    constexpr std::size_t kBlock = 4096;
    std::vector<double> sums((object.triangle_count + kBlock - 1) / kBlock);  // added up in one order
    parallel_ranges(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
            const std::size_t last = std::min<std::size_t>(object.triangle_count, (block + 1) * kBlock);
            for (std::size_t t = block * kBlock; t < last; ++t) {
                const uvec3 v  = meshes.triangles()[object.first_triangle + t];
                const dvec3 a  = dvec3(meshes.vertices()[v[0]]) - q;
                const dvec3 b  = dvec3(meshes.vertices()[v[1]]) - q;
                const dvec3 c  = dvec3(meshes.vertices()[v[2]]) - q;
                const double A = glm::length(a), B = glm::length(b), C = glm::length(c);
                sums[block] += std::atan2(glm::dot(a, glm::cross(b, c)),
                                          A * B * C + glm::dot(a, b) * C + glm::dot(b, c) * A + glm::dot(c, a) * B);
            }
        }
    });
    double sum = 0;
    for (const double s : sums) sum += s;
    return sum / (2 * kPi);
}

/// The volumes of one light, seen from a view.
///
/// Directions from the light are taken to the view's frame. `far(v)`, where vertex v ends up at infinity, is v less the
/// light, or the light's direction; on the way there v moves in the plane of v and `travel`, from O.
class SeenVolumes {
public:
    SeenVolumes(const SilhouetteMeshes& meshes, const Light& light, const ViewFrame& view)
        : meshes_(meshes), at_infinity_(light.kind == LightKind::directional) {
        travel_ = at_infinity_ ? view.turned(dvec3(light.direction)) : -view.seen(dvec3(light.position));
        vertices_.resize(meshes.vertices().size());
        parallel_ranges(vertices_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) vertices_[v] = view.seen(dvec3(meshes.vertices()[v]));
        });
        double radius2 = 0;
        for (const dvec3& v : vertices_) radius2 = std::max(radius2, glm::dot(v, v));
        radius_ = std::sqrt(radius2);
    }

    /// The near cap of a triangle: region and weight of its crossings.
    void add_near_cap(CountingTree& tree, TriangleId t, int turn, bool depth_fail) const {
        const Cap cap = near_cap(t, turn);
        Region region;
        region.add(HalfSpace::side(cap.behind, cap.behind_offset, cap.origin_behind == depth_fail ? +1 : -1));
        for (int k = 0; k < 3; ++k) {
            const Line e = edge(cap.corners[k], cap.corners[(k + 1) % 3]);
            region.add(HalfSpace::side(e.normal, 0, cap.origin_behind ? e.sense : -e.sense));
        }
        bound(region, cap.corners, depth_fail);
        tree.add(region, cap.origin_behind == depth_fail ? +1 : -1);
    }

    /// The far cap: directions in which a point at infinity lies in the triangle's volume.
    void add_far_cap(CountingTree& tree, TriangleId t, int turn) const {
        const uvec3 corners = turned(meshes_.triangles()[t], turn);
        Region region;
        for (int k = 0; k < 3; ++k) {
            const Line e = far_edge(corners[k], corners[(k + 1) % 3]);
            region.add(HalfSpace::side(e.normal, 0, -e.sense));
        }
        tree.add(region, +1);
    }

    void add_side(CountingTree& tree, const SilhouetteEdge& e, bool depth_fail) const {
        const Plane plane = side_plane(e.a, e.b);
        const int origin  = plane.origin_outside ? +1 : -1;
        Region region;
        region.add(HalfSpace::side(plane.normal, plane.offset, depth_fail ? origin : -origin));
        region.add(HalfSpace::side(edge(e.a, e.b).normal, 0, origin));
        region.add(HalfSpace::side(glm::cross(vertices_[e.b], travel_), 0, origin));
        region.add(HalfSpace::side(glm::cross(vertices_[e.a], travel_), 0, -origin));
        if (depth_fail && !at_infinity_) region.add(HalfSpace::side(far_edge(e.a, e.b).normal, 0, -origin));
        tree.add(region, depth_fail ? -origin * e.weight : origin * e.weight);
    }

    /// In how many volumes the view's origin lies: by the same planes, and the same rule where it lies in one.
    std::int32_t count_at_origin(std::span<const std::int8_t> turn) const {
        std::atomic<std::int32_t> count{0};
        parallel_ranges(turn.size(), 4096, [&](std::size_t begin, std::size_t end) {
            std::int32_t in_range = 0;
            for (std::size_t t = begin; t < end; ++t) {
                if (turn[t] == 0) continue;
                const Cap cap = near_cap(static_cast<TriangleId>(t), turn[t]);
                bool within   = cap.origin_behind;
                for (int k = 0; within && k < 3; ++k) {
                    const std::uint32_t i = cap.corners[k], j = cap.corners[(k + 1) % 3];
                    within = side_plane(std::min(i, j), std::max(i, j)).origin_outside == (i > j);
                }
                in_range += within;
            }
            count += in_range;
        });
        return count;
    }

private:
    static uvec3 turned(uvec3 t, int turn) { return turn > 0 ? t : uvec3(t[0], t[2], t[1]); }

    /// A triangle as the light sees it, anticlockwise; behind.p + behind_offset > 0 on its far side.
    ///
    /// A point in the plane of the triangle, its own or one that coincides with it, is not behind it. Points and
    /// vertices carry a few roundings u = 2^-53 relative to their distance from O, at most `radius`, the normal
    /// relative to the two sides that span it; the sum of both, over both points and the evaluation, is below 32 u.
    struct Cap {
        uvec3 corners;
        dvec3 behind;
        double behind_offset = 0;
        bool origin_behind   = false;
    };
    Cap near_cap(TriangleId t, int turn) const {
        Cap cap;
        cap.corners       = turned(meshes_.triangles()[t], turn);
        const dvec3 a     = vertices_[cap.corners[0]];
        const dvec3 p     = vertices_[cap.corners[1]] - a;
        const dvec3 q     = vertices_[cap.corners[2]] - a;
        cap.behind        = glm::cross(q, p);
        const double tiny = 32 * 0x1p-53 * radius_ * std::sqrt(glm::dot(p, p) * glm::dot(q, q));
        cap.behind_offset = -glm::dot(cap.behind, a) - tiny;
        cap.origin_behind = cap.behind_offset > 0;
        return cap;
    }

    /// A side's plane, its normal out of the volume of a triangle that runs the edge from a to b.
    struct Plane {
        dvec3 normal;
        double offset       = 0;
        bool origin_outside = false;
    };
    Plane side_plane(std::uint32_t a, std::uint32_t b) const {
        Plane plane;
        plane.normal         = glm::cross(far(a), vertices_[b] - vertices_[a]);
        plane.offset         = -glm::dot(plane.normal, vertices_[a]);
        plane.origin_outside = plane.offset >= 0;
        return plane;
    }

    dvec3 far(std::uint32_t v) const { return at_infinity_ ? travel_ : vertices_[v] + travel_; }

    /// The plane through O and an edge, made the same for both directions of the edge; `sense` is -1 for the second.
    struct Line {
        dvec3 normal;
        int sense = +1;
    };
    Line edge(std::uint32_t from, std::uint32_t to) const {
        return {glm::cross(vertices_[std::min(from, to)], vertices_[std::max(from, to)]), from < to ? +1 : -1};
    }
    Line far_edge(std::uint32_t from, std::uint32_t to) const {
        return {glm::cross(far(std::min(from, to)), far(std::max(from, to))), from < to ? +1 : -1};
    }

    /// A box around the points that can count a cap in front of the view: those that it covers, farther or nearer.
    void bound(Region& region, uvec3 corners, bool depth_fail) const {
        dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (int k = 0; k < 3; ++k) {
            const dvec3 v = vertices_[corners[k]];
            if (!(v.z > 0x1p-20 * (std::abs(v.x) + std::abs(v.y)))) return;
            const dvec3 projected(v.x / v.z, v.y / v.z, 1 / v.z);
            low  = glm::min(low, projected);
            high = glm::max(high, projected);
        }
        const dvec3 rounding = 0x1p-40 * glm::max(glm::abs(low), glm::abs(high));
        region.box_min       = low - rounding;
        region.box_max       = high + rounding;
        (depth_fail ? region.box_max.z : region.box_min.z) =
            depth_fail ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
    }

    const SilhouetteMeshes& meshes_;
    bool at_infinity_;
    dvec3 travel_;
    std::vector<dvec3> vertices_;
    double radius_ = 0;
};

enum class Counting : std::uint8_t { depth_pass, depth_fail };
enum class Edges : std::uint8_t { weighted, silhouette, per_triangle };

struct Options {
    Counting counting = Counting::depth_pass;
    Edges edges       = Edges::weighted;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::counting>({.name = "counting",
                                   .doc = "Which faces a point counts. depth_pass: those between it and the viewpoint, "
                                          "starting from the viewpoint's own count; depth_fail: those beyond it, with "
                                          "caps at infinity.",
                                   .phase   = Phase::visibility,
                                   .choices = "depth_pass|depth_fail",
                                   .sweep   = "depth_pass|depth_fail"}),
    parameter<&Options::edges>(
        {.name = "edges",
         .doc = "Which edges extrude a side. weighted: those whose triangles, turned to face the light, do not cancel; "
                "silhouette: of closed meshes that are wound outwards and have the light outside, silhouettes of the "
                "triangles that face it, right unless such a mesh turns inside out where it crosses itself; "
                "per_triangle: all three edges of every triangle.",
         .phase   = Phase::aim,
         .choices = "weighted|silhouette|per_triangle",
         .sweep   = "weighted|silhouette|per_triangle"}),
};

class ShadowVolumes final : public MethodWith<Options> {
public:
    Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::approximately, "area lights are taken as points at their centres: umbra only, no penumbra"};
        if (options.edges == Edges::silhouette && facts.closed_objects > 0)
            return {How::approximately,
                    "silhouettes of closed meshes are right unless one turns inside out where it crosses itself"};
        return {How::to_rounding,
                "counts volumes at the points themselves, with weighted edges for meshes that are open, "
                "non-manifold or badly oriented"};
    }

    void build(const Scene& scene, const SceneFacts&) override {
        scene_  = &scene;
        meshes_ = std::make_unique<SilhouetteMeshes>(scene);
    }

    void aim(LightId light) override {
        const Light& l = scene_->lights[light];
        turn_          = facing_triangles(*scene_, l);
        if (options.edges == Edges::silhouette) {
            // From a solid that the light is outside of, a line to the light leaves as often as it enters, or once
            // more: the triangles that face the light are enough.
            for (std::size_t o = 0; o < scene_->objects.size(); ++o) {
                const Object& object = scene_->objects[o];
                if (!meshes_->solid(o)) continue;
                if (l.kind != LightKind::directional &&
                    std::abs(winding_number(*meshes_, object, dvec3(l.position))) > 1e-6)  // inside, or on it
                    continue;
                for (std::uint32_t t = 0; t < object.triangle_count; ++t)
                    turn_[object.first_triangle + t] = std::max<std::int8_t>(turn_[object.first_triangle + t], 0);
            }
        }
        edges_ = options.edges == Edges::per_triangle ? all_edges() : meshes_->edges(turn_);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        const bool depth_fail = options.counting == Counting::depth_fail;
        CountingTree tree(*scene_, points, light);
        if (tree.size() == 0) return;
        const Light& l = scene_->lights[light];
        const SeenVolumes volumes(*meshes_, l, tree.view());
        const std::int32_t origin = depth_fail ? 0 : volumes.count_at_origin(turn_);

        parallel_ranges(turn_.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (turn_[t] == 0) continue;
                volumes.add_near_cap(tree, static_cast<TriangleId>(t), turn_[t], depth_fail);
                if (depth_fail && l.kind != LightKind::directional)
                    volumes.add_far_cap(tree, static_cast<TriangleId>(t), turn_[t]);
            }
        });
        parallel_ranges(edges_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) volumes.add_side(tree, edges_[e], depth_fail);
        });
        tree.for_each([&](std::uint32_t i, std::int32_t count) {
            out.s[i] = origin + count > 0 || centre_is_behind(*scene_, points, light, i) ? 0.0f : 1.0f;
        });
    }

    /// A sum of crossings names no volume. So the volumes that hold the point are looked for anew, each by its own
    /// planes, in double: the triangle farthest off is named, which rounding at the point's own surface cannot be.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) const override {
        const TriangleTree tree(*scene_);
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                who[i] = points.asks(light, i) ? farthest_volume(tree, points, i, light) : kNoTriangle;
        });
    }

    std::size_t memory_bytes() const override {
        return meshes_->memory_bytes() + turn_.capacity() + edges_.capacity() * sizeof(SilhouetteEdge);
    }

private:
    TriangleId farthest_volume(const TriangleTree& tree, const PointBatch& points, std::size_t i, LightId light) const {
        const Light& l         = scene_->lights[light];
        const bool at_infinity = l.kind == LightKind::directional;
        const dvec3 p          = named_point(*scene_, points, i, dvec3(0));
        const dvec3 way        = at_infinity ? -dvec3(l.direction) : dvec3(l.position) - p;
        TriangleId farthest    = kNoTriangle;
        double most            = 0;
        tree.visit({p, way, at_infinity ? std::numeric_limits<double>::infinity() : 1.0, 0}, [&](TriangleId t) {
            if (turn_[t] == 0) return true;
            std::array<dvec3, 3> v;
            for (int k = 0; k < 3; ++k) v[static_cast<std::size_t>(k)] = dvec3(scene_->vertex(t, k)) - p;
            const dvec3 n      = glm::cross(v[1] - v[0], v[2] - v[0]);
            const double share = glm::dot(n, v[0]) / glm::dot(n, way);  // of the way to the light
            int inside         = 0;
            for (std::size_t k = 0; k < 3; ++k)
                inside += glm::dot(glm::cross(v[k], v[(k + 1) % 3]), way) >= 0 ? +1 : -1;
            if (std::abs(inside) == 3 && share > most && (at_infinity || share < 1)) most = share, farthest = t;
            return true;
        });
        return farthest;
    }

    std::vector<SilhouetteEdge> all_edges() const {
        std::vector<SilhouetteEdge> edges;
        for (std::size_t t = 0; t < turn_.size(); ++t) {
            if (turn_[t] == 0) continue;
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t i = meshes_->triangles()[t][k], j = meshes_->triangles()[t][(k + 1) % 3];
                edges.push_back({std::min(i, j), std::max(i, j), i < j ? turn_[t] : -turn_[t]});
            }
        }
        return edges;
    }

    const Scene* scene_ = nullptr;
    std::unique_ptr<SilhouetteMeshes> meshes_;
    std::vector<std::int8_t> turn_;  // of each triangle: taken as wound, turned over, or not an occluder
    std::vector<SilhouetteEdge> edges_;
};

}  // namespace

extern const MethodInfo shadow_volumes;
const MethodInfo shadow_volumes{
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
