// Exact visibility: of hard lights by the segment from the exact surface point to the light (exact_segment.h), or by
// all triangles against binned points (binned_shadows.h) with the same answers; of area lights by the part of the light
// that no triangle covers as seen from there (exact_area.h).
//
//     build       a tree of boxes, triangles in groups for the bins, which triangles take light; where there are area
//                 lights, the welded triangles and the edges that may be silhouette edges
//     aim         on which side of an area light's plane each vertex lies, and which triangles may pass through it
//     visibility  the segment of each point in the tree, all triangles against the points in bins, or the sweep over
//                 the silhouette edges before an area light
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/light_points.h"
#include "umbra/core/render/tiles.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/bins/binned_shadows.h"
#include "umbra/shadows/exact/exact_area.h"
#include "umbra/shadows/geometry/exact_contacts.h"
#include "umbra/shadows/geometry/triangle_tree.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

using namespace exact_visibility;

enum class HardLights : std::uint8_t { automatic, segments, bins };

struct Options {
    HardLights hard_lights           = HardLights::automatic;
    ExactArea::Arithmetic arithmetic = ExactArea::Arithmetic::filtered;
    Measure measure                  = Measure::area;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::hard_lights>(
        "hard_lights",
        "Lights without an area, with the same answers. segments: from each point to the light, in a "
        "tree of boxes; bins: points in the light's image, every triangle against those behind it; "
        "auto: bins where there are at least half as many points as triangles.",
        {.choices = "auto|segments|bins"}),
    parameter<&Options::arithmetic>(
        "arithmetic",
        "Area lights. filtered: floating point with a proven bound, and rationals where the bound is too "
        "wide; rational: rationals throughout, for a few points.",
        {.phase = Phase::build, .choices = "filtered|rational", .area_lights = true}),
    parameter<&Options::measure>(
        "measure",
        "Which fraction of an area light S_j is. area: visible area over the light's area; irradiance: "
        "irradiance that arrives over irradiance without occluders, as radiosity and most renderers have it.",
        {.phase = Phase::build, .choices = "area|irradiance", .area_lights = true}),
};

/// The part of light that a triangle takes; one without an area has no inside to cross and bounds no shadow.
enum class Takes : std::uint8_t { all, part, nothing };

Takes taken_by(const Scene& scene, TriangleId t) {
    const vec3 passes = scene.lets_through(t);
    if (passes == vec3(1) || is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2)))
        return Takes::nothing;
    return passes == vec3(0) ? Takes::all : Takes::part;
}

std::vector<Takes> taken_by_all(const Scene& scene) {
    std::vector<Takes> takes(scene.triangles.size());
    parallel_ranges(takes.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) takes[t] = taken_by(scene, static_cast<TriangleId>(t));
    });
    return takes;
}

/// The triangles, as segments meet them, as points in bins do, and as they lie before area lights.
class Geometry final : public Built {
public:
    Geometry(const Scene& of, const SceneFacts& its_facts)
        : Built(of, its_facts),
          takes_(taken_by_all(of)),
          tree_(of),
          bins_(of),
          before_area_lights_(its_facts.hard_lights_only ? nullptr : std::make_unique<const AreaOccluders>(of, tree_)) {
    }

    [[nodiscard]] std::size_t memory_bytes() const override {
        return tree_.memory_bytes() + takes_.size() + bins_.memory_bytes() +
               (before_area_lights_ ? before_area_lights_->memory_bytes() : 0);
    }

    [[nodiscard]] const BinnedShadows& bins() const { return bins_; }
    /// Only where the scene has area lights.
    [[nodiscard]] const AreaOccluders& before_area_lights() const { return *before_area_lights_; }

    /// `crosses` as soon as one triangle that blocks is crossed; else `touches` if any is touched. `last` is tried
    /// first.
    [[nodiscard]] Segment::Meeting first_meeting(const Segment& segment, TriangleId own, TriangleId& last) const {
        using Meeting   = Segment::Meeting;
        const auto with = [&](TriangleId t) {
            return t == own || takes_[t] != Takes::all ? Meeting::none : segment.meeting(scene, t);
        };
        if (last != kNoTriangle && with(last) == Meeting::crosses) return Meeting::crosses;
        Meeting met = Meeting::none;
        tree_.visit(segment.piece(), [&](TriangleId t) {
            const Meeting m = with(t);
            if (m == Meeting::crosses) last = t;
            met = std::max(met, m);
            return m != Meeting::crosses;
        });
        return met;
    }

    /// The light that arrives past all triangles, though the segment crosses none that blocks.
    [[nodiscard]] Contacts::Together passed(const Segment& segment, TriangleId own) const {
        dvec3 fraction(1);
        std::optional<Contacts> touched;
        visit_taking(segment, own, [&](TriangleId t, Segment::Meeting met) {
            if (met == Segment::Meeting::crosses)
                fraction *= dvec3(scene.lets_through(t));
            else
                add_contact(touched, segment, scene, t);
        });
        if (!touched) return {vec3(fraction), true};
        const Contacts::Together together = touched->together();
        return {vec3(fraction) * together.passed, together.agreed};
    }

    /// How many triangles that take light the segment crosses, and touches.
    [[nodiscard]] std::array<std::size_t, 2> count_met(const Segment& segment, TriangleId own) const {
        std::array<std::size_t, 2> count{};
        visit_taking(segment, own,
                     [&](TriangleId, Segment::Meeting met) { ++count[met == Segment::Meeting::crosses ? 0 : 1]; });
        return count;
    }

    /// Which triangles are crossed is decided exactly, and which of these is nearest in double. Where none is, the
    /// nearest of the triangles that take light together though each is only touched.
    [[nodiscard]] TriangleId nearest_blocker(const Segment& segment, TriangleId own) const {
        struct Nearest {
            double distance     = std::numeric_limits<double>::infinity();
            TriangleId triangle = kNoTriangle;
        } crossed, touching;
        const BoxTree::Piece piece = segment.piece();
        std::optional<Contacts> touched;
        visit_taking(segment, own, [&](TriangleId t, Segment::Meeting met) {
            if (met == Segment::Meeting::touches) add_contact(touched, segment, scene, t);
            Nearest& nearest      = met == Segment::Meeting::crosses ? crossed : touching;
            const auto [x, y, z]  = corners_of(scene, t);
            const dvec3 n         = glm::cross(y - x, z - x);
            const double distance = std::abs(glm::dot(n, x - piece.from) / glm::dot(n, piece.direction));
            if (distance < nearest.distance || (distance == nearest.distance && t < nearest.triangle))
                nearest = {distance, t};
        });
        if (crossed.triangle != kNoTriangle || !touched || touched->together().passed == vec3(1))
            return crossed.triangle;
        return touching.triangle;
    }

private:
    /// Calls visit(t, meeting) for all triangles that take light, other than `own`, that the segment crosses or
    /// touches.
    template <class Visit>
    void visit_taking(const Segment& segment, TriangleId own, const Visit& visit) const {
        visit_met(
            tree_, scene, segment, [&](TriangleId t) { return t != own && takes_[t] != Takes::nothing; },
            [&](TriangleId t, Segment::Meeting met) { return visit(t, met), true; });
    }

    const std::vector<Takes> takes_;  ///< one a triangle
    const TriangleTree tree_;
    const BinnedShadows bins_;
    const std::unique_ptr<const AreaOccluders> before_area_lights_;  ///< null where no light has an area
};

struct AreaLight final : Aimed {
    AreaLight(const Geometry& among, LightId at)
        : Aimed(among, at), area_light(source(), among.before_area_lights().occluders) {}
    [[nodiscard]] std::size_t memory_bytes() const override { return area_light.memory_bytes(); }

    const AimedLight area_light;
};

constexpr int kPoints = 256;  ///< of an area light, tried in turn until one is hidden

/// A point light at point k of an area light, as p sees it.
Light point_of(const Light& light, const ExactPoint& p, int k) {
    Light point    = light;
    point.kind     = LightKind::point;
    point.position = vec3(light_point(light, p.rounded(), k));
    return point;
}

class Exact final : public MethodWith<Options, Geometry> {
public:
    explicit Exact(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Measure measures() const override { return options.measure; }

    [[nodiscard]] bool multiplies() const override { return true; }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
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

    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        if (!is_area(built.scene.lights[light].kind)) return std::make_unique<Aimed>(built, light);
        return std::make_unique<AreaLight>(as<Geometry>(built), light);
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        if (is_area(aimed.source().kind))
            see_area(as<AreaLight>(aimed), looked.points, out);
        else if (bins_serve(aimed.built, looked.points))
            as<Geometry>(aimed.built).bins().visibility(looked.points, aimed.light, out);
        else
            see_hard(aimed, looked.points, out);
    }

    /// The nearest of the triangles that the segment to the light crosses, or at a seam touches. For an area light, the
    /// segment to one of its points, the first of a fixed list that is occluded.
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const auto& geometry = as<Geometry>(aimed.built);
        const Light& light   = aimed.source();
        const bool has_area  = is_area(light.kind);
        blame_each(aimed, looked, blockers, [&](std::size_t i) {
            const ExactPoint point(aimed.scene(), looked.points, i);
            TriangleId blocker = kNoTriangle;
            for (int k = 0; k < (has_area ? kPoints : 1) && blocker == kNoTriangle; ++k)
                blocker = geometry.nearest_blocker(Segment(point, has_area ? point_of(light, point, k) : light),
                                                   looked.points.triangle[i]);
            return blocker;
        });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason = Method::explain(aimed, looked, i, given);
        if (is_area(aimed.source().kind)) {
            add_account(as<AreaLight>(aimed), looked.points, i, reason);
            return reason;
        }
        const ExactPoint point(aimed.scene(), looked.points, i);
        const auto [crossed, touched] =
            as<Geometry>(aimed.built).count_met(Segment(point, aimed.source()), looked.points.triangle[i]);
        reason.evidence.push_back({"triangles crossed", static_cast<double>(crossed)});
        reason.evidence.push_back({"triangles touched", static_cast<double>(touched)});
        return reason;
    }

private:
    /// Bins serve triangles that block, not those that let a part through.
    [[nodiscard]] bool bins_serve(const Built& built, const PointBatch& points) const {
        if (built.facts.has_filters || options.hard_lights == HardLights::segments) return false;
        return options.hard_lights == HardLights::bins || 2 * points.size() >= built.scene.triangles.size();
    }

    static void see_hard(const Aimed& aimed, const PointBatch& points, Visibility out) {
        const auto& geometry   = as<Geometry>(aimed.built);
        const bool has_filters = geometry.facts.has_filters;
        parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
            TriangleId last = kNoTriangle;  // the blocker of a point often blocks its neighbour
            for (std::size_t i = begin; i < end; ++i) {
                if (points.facing[aimed.light][i] != Facing::front) continue;
                const ExactPoint point(aimed.scene(), points, i);
                const Segment segment(point, aimed.source());
                const auto met = geometry.first_meeting(segment, points.triangle[i], last);
                Contacts::Together seen{vec3(met == Segment::Meeting::crosses ? 0.0f : 1.0f), true};
                if (met == Segment::Meeting::touches || (met == Segment::Meeting::none && has_filters))
                    seen = geometry.passed(segment, points.triangle[i]);
                out.s[i] = mean_of(seen.passed);
                if (!out.colour.empty()) out.colour[i] = seen.passed;
                if (!seen.agreed) out.answer[i] = Answer::on_boundary;
            }
        });
    }

    [[nodiscard]] ExactArea before(const AreaLight& aimed) const {
        return {as<Geometry>(aimed.built).before_area_lights(), aimed.area_light, options.arithmetic, options.measure};
    }

    void add_account(const AreaLight& aimed, const PointBatch& points, std::size_t i, Reason& reason) const {
        constexpr std::size_t kFew = 12;
        const ExactArea::Account account =
            before(aimed).account(points.triangle[i], points.u[i], points.v[i],
                                  points.facing[aimed.light][i] == Facing::partly, points.flipped[i] ? -1 : 1);
        std::size_t corners = 0;
        std::string outlines;
        for (const std::vector<dvec2>& outline : account.outlines) {
            corners += outline.size();
            const char* between = outlines.empty() ? "" : " | ";
            for (const dvec2 c : outline) {
                const dvec2 shown = glm::round(c * 1e4) / 1e4 + 0.0;  // no negative zeros
                outlines += fmt::format("{}{} {}", std::exchange(between, ", "), shown.x, shown.y);
            }
        }
        reason.evidence.push_back({"visible area", static_cast<double>(account.answer.visibility), "of the light"});
        reason.evidence.push_back({"visible pieces", static_cast<double>(account.pieces)});
        reason.evidence.push_back({"corners", static_cast<double>(corners)});
        if (corners > 0 && corners <= kFew) reason.evidence.push_back({"corners in half axes", outlines});
        reason.evidence.push_back({"silhouette edges", static_cast<double>(account.edges)});
        reason.evidence.push_back({"sides that doubles leave open", static_cast<double>(account.open_sides)});
        reason.evidence.push_back({"arithmetic", account.arithmetic});
    }

    void see_area(const AreaLight& aimed, const PointBatch& points, Visibility out) const {
        const ExactArea area   = before(aimed);
        const bool irradiance  = options.measure == Measure::irradiance;
        const bool bracket     = irradiance || aimed.source().kind != LightKind::rectangle;
        const bool has_filters = aimed.built.facts.has_filters;
        const auto see         = [&](std::size_t i, ExactArea::Workspace& work) {
            const bool partly = points.facing[aimed.light][i] == Facing::partly;
            const int turn    = points.flipped[i] ? -1 : 1;
            const ExactArea::Answer answer =
                area.seen(points.triangle[i], points.u[i], points.v[i], partly, turn, work);
            out.s[i]      = irradiance ? answer.irradiance : answer.visibility;
            out.answer[i] = answer.edge_on ? Answer::on_boundary : Answer::given;
            if (has_filters) {
                const auto passed =
                    area.seen_through(points.triangle[i], points.u[i], points.v[i], partly, turn, answer, work);
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
                    if (points.asks(aimed.light, i)) asked[count++] = static_cast<std::uint32_t>(i);
            });
            const auto see_group = [&](std::size_t i) { see(i, work); };
            area.for_all(points, std::span(asked).first(count), work, see_group);
            if (out.steps != nullptr) *out.steps += work.steps;
        };
        for_each_tile(points, see_tile, 1);
    }
};

}  // namespace

extern const MethodInfo exact{
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
