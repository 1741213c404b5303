// Exact visibility: of hard lights by the segment from the exact surface point to the light (exact_segment.h), or by
// all triangles against binned points (binned_shadows.h) with the same answers; of area lights by the part of the light
// that no triangle covers as seen from there (exact_area.h).
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/tiles.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/exact/exact_area.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/binned_shadows.h"
#include "umbra/shadows/shared/exact_segment.h"
#include "umbra/shadows/shared/light_points.h"
#include "umbra/shadows/shared/triangle_tree.h"

namespace umbra {
namespace {

using namespace exact_detail;

enum class HardLights : std::uint8_t { automatic, segments, bins };

struct Options {
    HardLights hard_lights           = HardLights::automatic;
    ExactArea::Arithmetic arithmetic = ExactArea::Arithmetic::filtered;
    Measure measure                  = Measure::area;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::hard_lights>(
        {.name  = "hard_lights",
         .doc   = "Lights without an area, with the same answers. segments: from each point to the light, in a tree of "
                  "boxes; bins: points in the light's image, every triangle against those behind it; auto: bins where "
                  "there are at least half as many points as triangles.",
         .phase = Phase::visibility,
         .choices = "auto|segments|bins"}),
    parameter<&Options::arithmetic>(
        {.name = "arithmetic",
         .doc = "Area lights. filtered: floating point with a proven bound, and rationals where the bound is too wide; "
                "rational: rationals throughout, for a few points.",
         .phase       = Phase::build,
         .choices     = "filtered|rational",
         .area_lights = true}),
    parameter<&Options::measure>(
        {.name        = "measure",
         .doc         = "Which fraction of an area light S_j is. area: visible area over the light's area; irradiance: "
                        "irradiance that arrives over irradiance without occluders, as radiosity and most renderers have it.",
         .phase       = Phase::build,
         .choices     = "area|irradiance",
         .area_lights = true}),
};

constexpr int kPoints = 256;  ///< of an area light, tried in turn until one is hidden

/// A point light at point k of an area light, as p sees it.
Light point_of(const Light& light, const ExactPoint& p, int k) {
    Light point    = light;
    point.kind     = LightKind::point;
    point.position = vec3(light_point(light, p.rounded(), k));
    return point;
}

class Exact final : public MethodWith<Options> {
public:
    void configure(const Settings& settings) override {
        MethodWith::configure(settings);
        area_ = ExactArea(options.arithmetic, options.measure);
    }

    [[nodiscard]] Measure measures() const override { return options.measure; }

    [[nodiscard]] bool multiplies() const override { return true; }

    Service serves(const SceneFacts& facts) const override {
        bool round = false;
        for (const LightFacts& light : facts.lights)
            round = round || light.kind == LightKind::disk || light.kind == LightKind::sphere;
        if (facts.has_filters && round)
            return {How::not_at_all,
                    "Of disks and spheres it finds the part that is seen, not what occluders let "
                    "through of the rest; of rectangles it finds both."};
        if (facts.has_filters && !facts.hard_lights_only && options.measure == Measure::irradiance)
            return {How::not_at_all,
                    "It finds the area of a light that is seen through occluders, not the irradiance."};
        if (facts.hard_lights_only)
            return {How::exactly, "All geometric predicates are exact; the answer does not depend on rounding."};
        if (!round)
            return {How::exactly,
                    "All geometric predicates are exact; visible areas are off by less than 1e-9 of the light."};
        return {
            How::exactly,
            "All geometric predicates are exact; visible areas are off by less than 1e-9 of the light, and where that "
            "cannot be told of a round light, have a proven bracket."};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        scene_ = &scene;
        takes_.resize(scene.triangles.size());
        parallel_ranges(takes_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) takes_[t] = taken_by(scene, static_cast<TriangleId>(t));
        });
        has_filters_ = facts.has_filters;
        tree_.emplace(scene);
        bins_            = BinnedShadows(scene);
        has_area_lights_ = !facts.hard_lights_only;
        if (has_area_lights_) area_.build(scene, *tree_);
    }

    void aim(LightId light) override {
        if (is_area(scene_->lights[light].kind)) area_.aim(scene_->lights[light]);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        if (!is_area(scene_->lights[light].kind))
            bins_serve(points) ? bins_.visibility(points, light, out) : see_hard(points, light, out);
        else
            see_area(points, light, out);
    }

    /// The nearest of the triangles that the segment to the light crosses. For an area light, the segment to one of its
    /// points, the first of a fixed list that is occluded.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) const override {
        const Light& lamp = scene_->lights[light];
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                who[i] = kNoTriangle;
                if (!points.asks(light, i)) continue;
                const ExactPoint point(*scene_, points.triangle[i], points.u[i], points.v[i]);
                for (int k = 0; k < (is_area(lamp.kind) ? kPoints : 1) && who[i] == kNoTriangle; ++k)
                    who[i] = nearest_crossed(Segment(point, is_area(lamp.kind) ? point_of(lamp, point, k) : lamp),
                                             points.triangle[i]);
            }
        });
    }

    std::size_t memory_bytes() const override {
        return (tree_ ? tree_->memory_bytes() : 0) + takes_.size() + bins_.memory_bytes() +
               (has_area_lights_ ? area_.memory_bytes() : 0);
    }

private:
    /// What a triangle takes of the light that meets it.
    enum class Takes : std::uint8_t { all, part, nothing };

    /// A triangle without area is no surface: it has no inside to cross and bounds no shadow.
    static Takes taken_by(const Scene& scene, TriangleId t) {
        const vec3 passes = scene.lets_through(t);
        if (passes == vec3(1) || is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2)))
            return Takes::nothing;
        return passes == vec3(0) ? Takes::all : Takes::part;
    }

    /// Bins know what blocks, not what lets a part through.
    [[nodiscard]] bool bins_serve(const PointBatch& points) const {
        if (has_filters_ || options.hard_lights == HardLights::segments) return false;
        return options.hard_lights == HardLights::bins || 2 * points.size() >= scene_->triangles.size();
    }

    void see_hard(const PointBatch& points, LightId light, Visibility out) const {
        parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
            TriangleId last = kNoTriangle;  // what blocked a point often blocks its neighbour
            for (std::size_t i = begin; i < end; ++i) {
                if (points.facing[light][i] != Facing::front) continue;
                const ExactPoint point(*scene_, points.triangle[i], points.u[i], points.v[i]);
                const Segment segment(point, scene_->lights[light]);
                Segment::Meeting met = first_meeting(segment, points.triangle[i], last);
                out.s[i]             = met == Segment::Meeting::crosses ? 0.0f : 1.0f;
                vec3 colour(out.s[i]);
                if (has_filters_ && met != Segment::Meeting::crosses) colour = passed(segment, points.triangle[i], met);
                out.s[i] = mean_of(colour);
                if (!out.colour.empty()) out.colour[i] = colour;
                out.answer[i] = met == Segment::Meeting::touches ? Answer::on_boundary : Answer::given;
            }
        });
    }

    void see_area(const PointBatch& points, LightId light, Visibility out) const {
        const bool irradiance = options.measure == Measure::irradiance;
        const bool bracket    = irradiance || scene_->lights[light].kind != LightKind::rectangle;
        const auto see        = [&](std::size_t i, ExactArea::Workspace& work) {
            const bool partly = points.facing[light][i] == Facing::partly;
            const int turn    = points.flipped[i] ? -1 : 1;
            const ExactArea::Answer answer =
                area_.seen(points.triangle[i], points.u[i], points.v[i], partly, turn, work);
            out.s[i]      = irradiance ? answer.irradiance : answer.visibility;
            out.answer[i] = answer.edge_on ? Answer::on_boundary : Answer::given;
            if (has_filters_) {
                const auto passed =
                    area_.seen_through(points.triangle[i], points.u[i], points.v[i], partly, turn, answer, work);
                if (!passed) out.answer[i] = Answer::undefined;
                out.s[i] = passed ? mean_of(*passed) : 0.0f;
                if (!out.colour.empty() && passed) out.colour[i] = *passed;
            }
            if (bracket) out.half_width[i] = irradiance ? answer.irradiance_half_width : answer.half_width;
        };
        const auto see_tile = [&](const PointTile& tile) {
            ExactArea::Workspace work;
            std::array<std::uint32_t, PointTile::kPoints> asked;
            std::size_t count = 0;
            tile.for_each_run([&](std::size_t first, std::size_t n) {
                for (std::size_t i = first; i < first + n; ++i)
                    if (points.asks(light, i)) asked[count++] = static_cast<std::uint32_t>(i);
            });
            const auto see_group = [&](std::size_t i) { see(i, work); };
            area_.for_all(points, std::span(asked).first(count), work, see_group);
            if (out.steps != nullptr) *out.steps += work.steps;
        };
        for_each_tile(points, see_tile, 1);
    }

    /// `crosses` as soon as one triangle is crossed; else `touches` if any is touched. `last` is tried first.
    Segment::Meeting first_meeting(const Segment& segment, TriangleId own, TriangleId& last) const {
        using Meeting   = Segment::Meeting;
        const auto with = [&](TriangleId t) {
            return t == own || takes_[t] != Takes::all
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

    /// What all triangles that are crossed let through together, per channel, though none of them blocks. `met` becomes
    /// `touches` where one is touched.
    vec3 passed(const Segment& segment, TriangleId own, Segment::Meeting& met) const {
        dvec3 share(1);
        tree_->visit(segment.piece(), [&](TriangleId t) {
            if (t == own || takes_[t] != Takes::part) return true;
            const auto m = segment.meeting(scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
            if (m == Segment::Meeting::crosses) share *= dvec3(scene_->lets_through(t));
            if (m == Segment::Meeting::touches) met = m;
            return true;
        });
        return vec3(share);
    }

    /// What is crossed is decided exactly, and which of that is nearest in double.
    TriangleId nearest_crossed(const Segment& segment, TriangleId own) const {
        const BoxTree::Piece piece = segment.piece();
        TriangleId nearest         = kNoTriangle;
        double least               = std::numeric_limits<double>::infinity();
        tree_->visit(piece, [&](TriangleId t) {
            const vec3 x = scene_->vertex(t, 0), y = scene_->vertex(t, 1), z = scene_->vertex(t, 2);
            if (t == own || takes_[t] == Takes::nothing || segment.meeting(x, y, z) != Segment::Meeting::crosses)
                return true;
            const dvec3 n    = glm::cross(dvec3(y) - dvec3(x), dvec3(z) - dvec3(x));
            const double way = std::abs(glm::dot(n, dvec3(x) - piece.from) / glm::dot(n, piece.direction));
            if (way < least || (way == least && t < nearest)) least = way, nearest = t;
            return true;
        });
        return nearest;
    }

    const Scene* scene_ = nullptr;
    std::optional<TriangleTree> tree_;
    BinnedShadows bins_;
    std::vector<Takes> takes_;  ///< one a triangle
    bool has_area_lights_ = false, has_filters_ = false;
    ExactArea area_{ExactArea::Arithmetic::filtered, Measure::area};
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
    .reference  = true,
    .create     = create<Exact>};

}  // namespace umbra
