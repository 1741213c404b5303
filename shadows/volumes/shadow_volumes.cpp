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
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/scene/winding.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/triangle_tree.h"
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
                    "silhouettes of closed meshes are correct unless one turns inside out where it crosses itself"};
        return {How::to_rounding,
                "counts volumes at the points themselves, with weighted edges for open, "
                "non-manifold or inconsistently oriented meshes"};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        scene_  = &scene;
        facts_  = &facts;
        meshes_ = std::make_unique<SilhouetteMeshes>(scene, facts.objects);
    }

    void aim(LightId light) override {
        const Light& l = scene_->lights[light];
        orientation_   = meshes_->facing(l);
        leave_out_transparent();
        if (options.edges == Edges::silhouette) leave_out_back_faces(l);
        edges_ = options.edges == Edges::per_triangle ? all_edges() : meshes_->edges(orientation_);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        const bool depth_fail = options.counting == Counting::depth_fail;
        CountingTree tree(*scene_, points, light);
        if (tree.size() == 0) return;
        const Light& l = scene_->lights[light];
        const SeenVolumes volumes(*meshes_, l, tree.view());
        const std::int32_t origin = depth_fail ? 0 : volumes.count_at_origin(orientation_);

        parallel_ranges(orientation_.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (orientation_[t] == 0) continue;
                volumes.add_near_cap(tree, static_cast<TriangleId>(t), orientation_[t], depth_fail);
                if (depth_fail && l.kind != LightKind::directional)
                    volumes.add_far_cap(tree, static_cast<TriangleId>(t), orientation_[t]);
            }
        });
        parallel_ranges(edges_.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) volumes.add_side(tree, edges_[e], depth_fail);
        });
        tree.for_each([&](std::uint32_t i, std::int32_t count) {
            out.s[i] = origin + count > 0 || centre_is_behind(*scene_, points, light, i) ? 0.0f : 1.0f;
        });
    }

    /// A sum of crossings names no volume. So each volume is asked whether it holds the point, by its own planes, in
    /// double: the farthest triangle is named, which rounding at the point's own surface cannot be.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        const TriangleTree tree(*scene_);
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                blockers[i] = points.asks(light, i) ? farthest_volume(tree, points, i, light) : kNoTriangle;
        });
    }

    std::size_t memory_bytes() const override {
        return meshes_->memory_bytes() + orientation_.capacity() + edges_.capacity() * sizeof(SilhouetteEdge);
    }

private:
    void leave_out_transparent() {
        for (const Object& object : scene_->objects)
            if (object.triangle_count > 0 && !scene_->blocks(object.first_triangle))
                std::fill_n(orientation_.begin() + object.first_triangle, object.triangle_count, std::int8_t{0});
    }

    /// From a solid that the light is outside of, a line to the light leaves as often as it enters, or once more: the
    /// triangles that face the light are enough.
    void leave_out_back_faces(const Light& light) {
        for (std::size_t o = 0; o < scene_->objects.size(); ++o) {
            const Object& object = scene_->objects[o];
            if (!facts_->objects[o].solid) continue;
            if (light.kind != LightKind::directional &&
                std::abs(winding_number(*scene_, object, dvec3(light.position))) > 1e-6)  // inside, or on it
                continue;
            for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
                orientation_[t] = std::max<std::int8_t>(orientation_[t], 0);
        }
    }

    TriangleId farthest_volume(const TriangleTree& tree, const PointBatch& points, std::size_t i, LightId light) const {
        const Light& l         = scene_->lights[light];
        const bool at_infinity = l.kind == LightKind::directional;
        const dvec3 p          = named_point(*scene_, points, i, dvec3(0));
        const dvec3 to_light   = at_infinity ? -dvec3(l.direction) : dvec3(l.position) - p;
        TriangleId farthest    = kNoTriangle;
        double most            = 0;
        tree.visit({p, to_light, at_infinity ? std::numeric_limits<double>::infinity() : 1.0, 0}, [&](TriangleId t) {
            if (orientation_[t] == 0) return true;
            std::array<dvec3, 3> v;
            for (int k = 0; k < 3; ++k) v[static_cast<std::size_t>(k)] = dvec3(scene_->vertex(t, k)) - p;
            const dvec3 n      = glm::cross(v[1] - v[0], v[2] - v[0]);
            const double share = glm::dot(n, v[0]) / glm::dot(n, to_light);  // of the segment to the light
            int inside         = 0;
            for (std::size_t k = 0; k < 3; ++k)
                inside += glm::dot(glm::cross(v[k], v[(k + 1) % 3]), to_light) >= 0 ? +1 : -1;
            if (std::abs(inside) == 3 && share > most && (at_infinity || share < 1)) most = share, farthest = t;
            return true;
        });
        return farthest;
    }

    std::vector<SilhouetteEdge> all_edges() const {
        std::vector<SilhouetteEdge> edges;
        for (std::size_t t = 0; t < orientation_.size(); ++t) {
            if (orientation_[t] == 0) continue;
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t i = meshes_->triangles()[t][k], j = meshes_->triangles()[t][(k + 1) % 3];
                edges.push_back({std::min(i, j), std::max(i, j), i < j ? orientation_[t] : -orientation_[t]});
            }
        }
        return edges;
    }

    const Scene* scene_      = nullptr;
    const SceneFacts* facts_ = nullptr;
    std::unique_ptr<SilhouetteMeshes> meshes_;
    std::vector<std::int8_t> orientation_;  // of each triangle: +1 taken as wound, -1 turned over, 0 no occluder
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
