// Scan-line shadows: along each row of the raster, a run of pixels that show one triangle is a span, and each occluder
// darkens an interval of it. Its ends are where the planes through the light and the occluder's edges cut the span, so
// that no pixel between them is tested. Which triangles can darken a span is looked up in a subdivision of space as the
// light sees it.
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// W. Jack Bouknight, Karl C. Kelley. An Algorithm for Producing Half-Tone Computer Graphics Presentations with Shadows
// and Movable Light Sources. 1970
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/scanline/light_cells.h"

namespace umbra {
namespace {

using scanline_detail::LightCells;

/// Pixels [first, last] of one row that show one triangle; both ends in world space, and their depths before the eye (1
/// where the view is orthographic).
struct Span {
    std::size_t first, last;
    dvec3 a, b;
    double depth_a, depth_b;
};

/// What a triangle hides from the light: the positions where all four of these are positive.
struct Shadow {
    /// dot(normal, p - from).
    struct Side {
        dvec3 normal{0}, from{0};
        [[nodiscard]] double at(dvec3 p) const { return glm::dot(normal, p - from); }
    };
    std::array<Side, 4> sides{};

    [[nodiscard]] bool holds(dvec3 p) const {
        return std::ranges::all_of(sides, [p](const Side& side) { return side.at(p) > 0; });
    }
};

/// Which span, counted by one thread, asked each triangle last.
struct Asked {
    std::vector<std::uint32_t> last_span;
    std::uint32_t span = 0;
};

class ScanLine final : public Method {
public:
    void configure(const Settings&) override {}  // it has no parameters

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only) return {How::not_at_all, "Spans have edges, and no penumbra: no area lights."};
        return {How::to_rounding, "The ends of shadows on each span, in double."};
    }

    void build(const Scene& scene, const SceneFacts&) override { scene_ = &scene; }

    void aim(LightId light) override {
        light_ = &scene_->lights[light];
        cells_.emplace(*scene_, *light_);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        const std::size_t row  = points.raster ? static_cast<std::size_t>(points.raster->width) : points.size();
        const std::size_t rows = row > 0 ? points.size() / row : 0;
        const auto darken      = [&](std::size_t begin, std::size_t end, Asked& asked) {
            while (begin < end) {
                if (!points.asks(light, begin)) {
                    ++begin;
                    continue;
                }
                const Span span = span_from(points, light, begin, end);
                std::fill(out.s.begin() + static_cast<std::ptrdiff_t>(span.first),
                               out.s.begin() + static_cast<std::ptrdiff_t>(span.last) + 1, 1.0f);
                darken_span(points, span, asked, out.s);
                begin = span.last + 1;
            }
        };
        if (points.raster)
            parallel_ranges(rows, 16, [&](std::size_t first, std::size_t last) {
                Asked asked{std::vector<std::uint32_t>(scene_->triangles.size(), 0)};
                for (std::size_t y = first; y < last; ++y) darken(y * row, (y + 1) * row, asked);
            });
        else
            parallel_ranges(points.size(), 4096, [&](std::size_t first, std::size_t last) {
                Asked asked{std::vector<std::uint32_t>(scene_->triangles.size(), 0)};
                darken(first, last, asked);
            });
    }

    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override {
        parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                blockers[i] = kNoTriangle;
                if (!points.asks(light, i)) continue;
                const dvec3 p = exact_position(*scene_, points, i);
                cells_->visit(p, p, [&](std::span<const TriangleId> triangles) {
                    for (const TriangleId t : triangles) {
                        if (t == points.triangle[i] || blockers[i] != kNoTriangle) continue;
                        if (const auto shadow = shadow_of(t);
                            shadow && shadow->holds(p) && rises(t, points.triangle[i]))
                            blockers[i] = t;
                    }
                });
            }
        });
    }

    [[nodiscard]] std::size_t memory_bytes() const override { return cells_ ? cells_->memory_bytes() : 0; }

private:
    /// The longest span that begins at a point and ends before `end`. Without a raster, the point alone.
    [[nodiscard]] Span span_from(const PointBatch& points, LightId light, std::size_t first, std::size_t end) const {
        std::size_t last = first;
        if (points.raster)
            while (last + 1 < end && points.triangle[last + 1] == points.triangle[first] &&
                   points.asks(light, last + 1))
                ++last;
        const dvec3 a          = exact_position(*scene_, points, first);
        const dvec3 b          = last > first ? exact_position(*scene_, points, last) : a;
        const bool perspective = points.raster && points.raster->projection == Projection::perspective;
        const auto depth       = [&](dvec3 p) {
            return perspective ? glm::dot(p - points.raster->eye, points.raster->forward) : 1.0;
        };
        return {first, last, a, b, depth(a), depth(b)};
    }

    /// Sets s to 0 wherever a triangle hides the span from the light. Each triangle is asked once a span.
    void darken_span(const PointBatch& points, const Span& span, Asked& asked, std::span<float> s) const {
        const TriangleId own = points.triangle[span.first];
        const double shift   = largest_shift(points, span);
        ++asked.span;
        cells_->visit(span.a, span.b, [&](std::span<const TriangleId> triangles) {
            for (const TriangleId t : triangles) {
                if (t == own || asked.last_span[t] == asked.span) continue;
                asked.last_span[t] = asked.span;
                darken_by(t, points, span, shift, s);
            }
        });
    }

    /// How far the span's points lie beside the line through its ends: their barycentrics are rounded.
    [[nodiscard]] double largest_shift(const PointBatch& points, const Span& span) const {
        double largest    = 0;
        const auto pixels = static_cast<double>(span.last - span.first);
        for (std::size_t i = span.first + 1; i < span.last; ++i) {
            const double t = static_cast<double>(i - span.first) / pixels;
            const double a = (1 - t) / span.depth_a, b = t / span.depth_b;
            largest = std::max(largest,
                               glm::length(exact_position(*scene_, points, i) - (a * span.a + b * span.b) / (a + b)));
        }
        return largest;
    }

    /// Points lie beside the span's line by as much as `shift`. Between the pixels that a shadow holds in spite of that
    /// and those that it cannot hold, each point is asked.
    void darken_by(TriangleId t, const PointBatch& points, const Span& span, double shift, std::span<float> s) const {
        const std::optional<Shadow> shadow = shadow_of(t);
        if (!shadow) return;
        Run sure{0, static_cast<double>(span.last - span.first)}, open = sure;
        for (const Shadow::Side& side : shadow->sides) {
            // Divided by depth, its value is linear along the row.
            const double a = side.at(span.a) / span.depth_a, b = side.at(span.b) / span.depth_b;
            const double slack = glm::length(side.normal) * shift / std::min(span.depth_a, span.depth_b);
            open               = above(-slack, a, b, span, open);
            if (open.first > open.last) return;
            sure = above(slack, a, b, span, sure);
        }
        if (!rises(t, points.triangle[span.first])) return;
        for (double k = open.first; k <= open.last; ++k) {
            const std::size_t i = span.first + static_cast<std::size_t>(k);
            if ((k >= sure.first && k <= sure.last) || shadow->holds(exact_position(*scene_, points, i))) s[i] = 0;
        }
    }

    /// Pixels of a span, counted from its first; none where first > last.
    struct Run {
        double first, last;
    };
    /// Those of `among` where a value that is a at the span's first pixel and b at its last is above a limit.
    static Run above(double limit, double a, double b, const Span& span, Run among) {
        const double pixels = static_cast<double>(span.last - span.first), cut = pixels * (a - limit) / (a - b);
        if (!(a > limit) && !(b > limit)) return {1, 0};
        if (!(a > limit)) among.first = std::max(among.first, std::floor(cut) + 1);
        if (!(b > limit)) among.last = std::min(among.last, std::ceil(cut) - 1);
        return among;
    }

    /// Whether some of triangle t is in front of the plane of the receiver, where the light is: else it hides nothing.
    [[nodiscard]] bool rises(TriangleId t, TriangleId own) const {
        const vec3 a = scene_->vertex(own, 0), b = scene_->vertex(own, 1), c = scene_->vertex(own, 2);
        const int front = side_of_light(*light_, a, b, c);
        for (int k = 0; k < 3; ++k)
            if (side_of_plane(a, b, c, scene_->vertex(t, k)) == front) return true;
        return false;
    }

    /// None for a triangle that the light sees edge-on.
    [[nodiscard]] std::optional<Shadow> shadow_of(TriangleId t) const {
        const bool infinite = light_->kind == LightKind::directional;
        const dvec3 corner[3]{dvec3(scene_->vertex(t, 0)), dvec3(scene_->vertex(t, 1)), dvec3(scene_->vertex(t, 2))};
        const dvec3 light   = infinite ? -dvec3(light_->direction) : dvec3(light_->position);
        const dvec3 normal  = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double facing = glm::dot(normal, infinite ? light : light - corner[0]);
        if (facing == 0) return std::nullopt;
        const double turn = facing > 0 ? -1 : 1;
        Shadow shadow;
        shadow.sides[0] = {turn * normal, corner[0]};  // first, since it rules out most
        for (std::size_t k = 0; k < 3; ++k) {
            // From a corner, since a far light is known less well than the corners' distance; from the same one for the
            // triangle on the edge's other side, so that no point is between the two.
            dvec3 p = corner[k], q = corner[(k + 1) % 3];
            double sign = turn;
            if (std::tie(q.x, q.y, q.z) < std::tie(p.x, p.y, p.z)) std::swap(p, q), sign = -turn;
            shadow.sides[k + 1] = {sign * glm::cross(q - p, infinite ? light : light - p), p};
        }
        return shadow;
    }

    const Scene* scene_ = nullptr;
    const Light* light_ = nullptr;
    std::optional<LightCells> cells_;
};

}  // namespace

extern const MethodInfo scan_line;
const MethodInfo scan_line{
    .name  = "scan_line",
    .title = "Scan-line shadows",
    .paper =
        "W. Jack Bouknight, Karl Kelley, An Algorithm for Producing Half-Tone Computer Graphics Presentations with "
        "Shadows and Movable Light Sources, 1970",
    .summary =
        "Cuts the runs of pixels that show one triangle by the planes through the light and the edges of occluders, "
        "which are looked up in a subdivision of space as the light sees it. Exact to rounding for hard lights. Limit: "
        "no area lights; time grows with the spans and with the triangles behind one another.",
    .by_default = false,
    .shown_on   = {"sun_on_plane", "stairs", "interpenetrating", "self_shadow"},
    .create     = create<ScanLine>};

}  // namespace umbra
