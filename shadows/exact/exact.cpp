// Exact visibility: of hard lights by the segment from the exact surface point to the light (exact_segment.h), of area
// lights by the part of the light that no triangle covers as seen from there (exact_area.h).
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/exact/exact_area.h"
#include "umbra/shadows/exact/exact_segment.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/triangle_tree.h"

namespace umbra {
namespace {

using namespace exact_detail;

constexpr Parameter kParameters[] = {
    {.name     = "arithmetic",
     .type     = Parameter::Type::choice,
     .fallback = "filtered",
     .doc      = "area lights: filtered computes in floating point with a proven bound and in rationals where that is "
                 "not small; rational in rationals throughout, for chosen points",
     .choices  = "filtered|rational"},
};

constexpr int kPlaces = 256;

/// A point light at place k of an area light, as p sees it; the places are spread evenly.
Light place_of(const Light& lamp, const ExactPoint& p, int k) {
    Light place    = lamp;
    place.kind     = LightKind::point;
    const double x = (k + 1) * 0.7548776662466927, y = (k + 1) * 0.5698402909980532;  // an additive recurrence
    const double a = x - std::floor(x), b = y - std::floor(y);
    const double radius = std::sqrt(a), angle = 2 * kPi * b;
    dvec3 at(lamp.position);
    TangentDisk disk;
    if (lamp.kind == LightKind::rectangle) {
        at += (a - 0.5) * dvec3(lamp.edge_u) + (b - 0.5) * dvec3(lamp.edge_v);
    } else if (lamp.kind == LightKind::disk) {
        const DiskAxes axes = disk_axes(lamp);
        at += radius * (std::cos(angle) * axes.u + std::sin(angle) * axes.v);
    } else if (tangent_disk(p.rounded(), at, lamp.radius, disk)) {
        at = disk.centre + radius * (std::cos(angle) * disk.axis_u + std::sin(angle) * disk.axis_v);
    }
    place.position = vec3(at);
    return place;
}

class Exact final : public Method {
public:
    explicit Exact(const Settings& settings)
        : area_(settings.choice("arithmetic") == "rational" ? ExactArea::Arithmetic::rational
                                                            : ExactArea::Arithmetic::filtered) {}

    Service serves(const SceneFacts& facts) const override {
        bool round = false;
        for (const LightFacts& light : facts.lights)
            round = round || light.kind == LightKind::disk || light.kind == LightKind::sphere;
        if (facts.hard_lights_only) return {How::exactly, "Every sign is proven: no rounding in what is decided."};
        if (!round)
            return {How::exactly, "Every sign is proven; visible areas are off by less than 1e-9 of the light."};
        return {How::exactly,
                "Every sign is proven; of round lights a proven bracket around the visible area, as wide as stated."};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        scene_ = &scene;
        // A triangle without area is no surface: it has no inside to cross and bounds no shadow.
        no_area_.resize(scene.triangles.size());
        parallel_ranges(no_area_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                const auto id = static_cast<TriangleId>(t);
                no_area_[t]   = is_degenerate(scene.vertex(id, 0), scene.vertex(id, 1), scene.vertex(id, 2));
            }
        });
        tree_.emplace(scene);
        has_area_lights_ = !facts.hard_lights_only;
        if (has_area_lights_) area_.build(scene, *tree_);
    }

    void aim(LightId light) override {
        if (is_area(scene_->lights[light].kind)) area_.aim(scene_->lights[light]);
    }

    void visibility(const PointBatch& points, LightId light, std::span<float> s,
                    std::span<std::uint8_t> defined) override {
        half_widths_.clear();
        if (!is_area(scene_->lights[light].kind))
            see_hard(points, light, s, defined);
        else
            see_area(points, light, s, defined);
    }

    std::span<const float> half_widths() const override { return half_widths_; }

    /// The nearest of the triangles that the way to the light crosses. Of an area light the way to one of its places,
    /// the first of a fixed list that is hidden.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) override {
        const Light& lamp = scene_->lights[light];
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                who[i]              = kNoTriangle;
                const Facing facing = points.facing[light][i];
                if (facing != Facing::front && facing != Facing::partly) continue;
                const ExactPoint point(*scene_, points.triangle[i], points.u[i], points.v[i]);
                for (int k = 0; k < (is_area(lamp.kind) ? kPlaces : 1) && who[i] == kNoTriangle; ++k)
                    who[i] = nearest_crossed(Segment(point, is_area(lamp.kind) ? place_of(lamp, point, k) : lamp),
                                             points.triangle[i]);
            }
        });
    }

    std::size_t memory_bytes() const override {
        return (tree_ ? tree_->memory_bytes() : 0) + no_area_.size() + (has_area_lights_ ? area_.memory_bytes() : 0);
    }

private:
    void see_hard(const PointBatch& points, LightId light, std::span<float> s, std::span<std::uint8_t> defined) const {
        parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
            TriangleId last = kNoTriangle;  // what blocked a point often blocks its neighbour
            for (std::size_t i = begin; i < end; ++i) {
                if (points.facing[light][i] != Facing::front) continue;
                const ExactPoint point(*scene_, points.triangle[i], points.u[i], points.v[i]);
                const Segment segment(point, scene_->lights[light]);
                const Segment::Meeting met = first_meeting(segment, points.triangle[i], last);
                s[i]                       = met == Segment::Meeting::crosses ? 0.0f : 1.0f;
                defined[i]                 = met == Segment::Meeting::touches ? kOnBoundary : kDefined;
            }
        });
    }

    void see_area(const PointBatch& points, LightId light, std::span<float> s, std::span<std::uint8_t> defined) {
        const LightKind kind = scene_->lights[light].kind;
        const bool bracket   = kind != LightKind::rectangle;
        if (bracket) half_widths_.resize(points.size());
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            ExactArea::Workspace work;
            for (std::size_t i = begin; i < end; ++i) {
                const Facing facing = points.facing[light][i];
                if (facing != Facing::front && facing != Facing::partly) continue;
                const ExactArea::Answer answer = area_.seen(points.triangle[i], points.u[i], points.v[i],
                                                            facing == Facing::partly, points.flipped[i] ? -1 : 1, work);
                s[i]                           = answer.visibility;
                defined[i]                     = answer.edge_on ? kOnBoundary : kDefined;
                if (bracket) half_widths_[i] = answer.half_width;
            }
        });
    }

    /// `crosses` as soon as one triangle is crossed; else `touches` if any is touched. `last` is tried first.
    Segment::Meeting first_meeting(const Segment& segment, TriangleId own, TriangleId& last) const {
        using Meeting   = Segment::Meeting;
        const auto with = [&](TriangleId t) {
            return t == own || no_area_[t]
                       ? Meeting::none
                       : segment.meeting(scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
        };
        if (last != kNoTriangle && with(last) == Meeting::crosses) return Meeting::crosses;
        Meeting met = Meeting::none;
        tree_->visit(segment.piece(), [&](TriangleId t) {
            const Meeting m = with(t);
            if (m == Meeting::crosses) last = t;
            met = std::max(met, m);
            return m != Meeting::crosses;
        });
        return met;
    }

    /// What is crossed is decided exactly, and which of that is nearest in double.
    TriangleId nearest_crossed(const Segment& segment, TriangleId own) const {
        const BoxTree::Piece piece = segment.piece();
        TriangleId nearest         = kNoTriangle;
        double least               = std::numeric_limits<double>::infinity();
        tree_->visit(piece, [&](TriangleId t) {
            const vec3 x = scene_->vertex(t, 0), y = scene_->vertex(t, 1), z = scene_->vertex(t, 2);
            if (t == own || no_area_[t] || segment.meeting(x, y, z) != Segment::Meeting::crosses) return true;
            const dvec3 n    = glm::cross(dvec3(y) - dvec3(x), dvec3(z) - dvec3(x));
            const double way = std::abs(glm::dot(n, dvec3(x) - piece.from) / glm::dot(n, piece.direction));
            if (way < least || (way == least && t < nearest)) least = way, nearest = t;
            return true;
        });
        return nearest;
    }

    const Scene* scene_ = nullptr;
    std::optional<TriangleTree> tree_;
    std::vector<std::uint8_t> no_area_;  ///< one a triangle
    bool has_area_lights_ = false;
    ExactArea area_;
    std::vector<float> half_widths_;
};

}  // namespace

extern const MethodInfo exact;
const MethodInfo exact{
    .name  = "exact",
    .title = "Exact visibility",
    .paper =
        "Predicates after Jonathan Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust "
        "Geometric Predicates, 1997; area lights after Samuli Laine et al., Soft Shadow Volumes for Ray Tracing, 2005",
    .summary =
        "The segment from the exact surface point to the light against every triangle but its own, decided by signs "
        "that are proven in floating point or computed in rationals; of area lights the area that no triangle covers, "
        "by a sweep over silhouette edges with a proven bound. The reference of the others.",
    .parameters = kParameters,
    .make       = make_method<Exact>};

}  // namespace umbra
