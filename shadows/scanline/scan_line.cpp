// Scan-line shadows: along each row of the raster, a run of pixels that show one triangle is a span, and each occluder
// darkens an interval of it, between the planes through the light and the occluder's edges: no pixel between these ends
// is tested. Which triangles can darken a span is looked up in a subdivision of space as the light sees it.
//
//     aim         the subdivision: which triangles lie in each of its cells
//     look        the spans, and how far their points lie beside the lines through their ends
//     visibility  cuts each span by the shadows of the triangles in the cells that it passes through; points so near to
//                 a shadow's side that rounding decides are decided by the exact segment to the light
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// W. Jack Bouknight, Karl C. Kelley. An Algorithm for Producing Half-Tone Computer Graphics Presentations with Shadows
// and Movable Light Sources. 1970
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/rounding.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/geometry/exact_sight.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/scanline/light_cells.h"

namespace umbra {
namespace {

using scanline::LightCells;

/// Pixels [first, last] of one row that show one triangle; both ends in world space, and their depths before the eye (1
/// where the view is orthographic).
struct Span {
    std::size_t first, last;
    dvec3 a, b;
    double depth_a, depth_b;
    double shift = 0;  ///< how far points lie beside the line through the ends: their barycentrics are rounded
};

Span span_of(const Scene& scene, const PointBatch& points, std::size_t first, std::size_t last) {
    const dvec3 a          = exact_position(scene, points, first);
    const dvec3 b          = last > first ? exact_position(scene, points, last) : a;
    const bool perspective = points.raster && points.raster->projection == Projection::perspective;
    const auto depth       = [&](dvec3 p) {
        return perspective ? glm::dot(p - points.raster->eye, points.raster->forward) : 1.0;
    };
    Span span{first, last, a, b, depth(a), depth(b)};
    const auto pixels = static_cast<double>(last - first);
    for (std::size_t i = first + 1; i < last; ++i) {
        const double t        = static_cast<double>(i - first) / pixels;
        const double weight_a = (1 - t) / span.depth_a, weight_b = t / span.depth_b;
        const dvec3 on_line = (weight_a * a + weight_b * b) / (weight_a + weight_b);
        span.shift          = std::max(span.shift, glm::length(exact_position(scene, points, i) - on_line));
    }
    return span;
}

/// The spans of all triangles, by rows. Without a raster 256 points are a row, and each point is a span.
class Spans final : public Looked {
public:
    Spans(const Built& built, const PointBatch& at)
        : Looked(at),
          scene_(built.scene),
          width_(at.raster ? static_cast<std::size_t>(std::max(at.raster->width, 1)) : 256),
          known_((at.size() + width_ - 1) / width_) {
        const auto is_surface = [&](std::size_t i) { return points.triangle[i] != kNoTriangle; };
        parallel_ranges(known_.size(), 16, [&](std::size_t begin, std::size_t end) {
            std::vector<Span> found;
            for (std::size_t y = begin; y < end; ++y) {
                found.clear();
                for_each_run(y, is_surface, [&](std::size_t first, std::size_t last) {
                    if (last - first >= kLeast) found.push_back(span_of(scene_, points, first, last));
                });
                known_[y].assign(found.begin(), found.end());
            }
        });
    }

    [[nodiscard]] std::size_t memory_bytes() const override {
        std::size_t bytes = known_.size() * sizeof(std::vector<Span>);
        for (const std::vector<Span>& row : known_) bytes += row.size() * sizeof(Span);
        return bytes;
    }

    [[nodiscard]] std::size_t rows() const { return known_.size(); }

    /// Calls visit(span) for the spans of those points of row y that ask the light. Where a part of a kept span asks,
    /// that part is a span of its own.
    template <class Visit>
    void for_each(LightId light, std::size_t y, const Visit& visit) const {
        auto known      = known_[y].begin();
        const auto asks = [&](std::size_t i) { return points.asks(light, i); };
        for_each_run(y, asks, [&](std::size_t first, std::size_t last) {
            while (known != known_[y].end() && known->last < first) ++known;
            const bool is_known = known != known_[y].end() && known->first == first && known->last == last;
            visit(is_known ? *known : span_of(scene_, points, first, last));
        });
    }

private:
    static constexpr std::size_t kLeast = 2;  ///< shorter spans have no points between their ends: they are not kept

    /// Calls visit(first, last) for the longest runs of points of row y that show one triangle and for which takes(i)
    /// is true.
    template <class Takes, class Visit>
    void for_each_run(std::size_t y, const Takes& takes, const Visit& visit) const {
        const std::size_t end = std::min((y + 1) * width_, points.size());
        for (std::size_t first = y * width_; first < end; ++first) {
            if (!takes(first)) continue;
            std::size_t last = first;
            if (points.raster)
                while (last + 1 < end && points.triangle[last + 1] == points.triangle[first] && takes(last + 1)) ++last;
            visit(first, last);
            first = last;
        }
    }

    const Scene& scene_;
    std::size_t width_;                     ///< points of a row
    std::vector<std::vector<Span>> known_;  ///< of each row
};

/// The positions that a triangle hides from the light: those where all four of these are positive.
struct Shadow {
    /// dot(normal, p - from).
    struct SidePlane {
        dvec3 normal{0}, from{0};
        dvec3 edge{0};     ///< of a plane through the light: along the triangle's edge, in the sense of the normal
        double doubt = 0;  ///< a value of at most this magnitude may have the wrong sign
        [[nodiscard]] double at(dvec3 p) const { return glm::dot(normal, p - from); }

        /// Where the value is 0, the sign is that of a light beside this one, the same for all edges: two triangles
        /// that share an edge have different signs there, so that a surface has no seams.
        [[nodiscard]] bool is_positive(dvec3 p) const {
            const double value = at(p);
            if (value != 0) return value > 0;
            const dvec3 moved = glm::cross(p - from, edge);
            return (moved.x != 0 ? moved.x : moved.y != 0 ? moved.y : moved.z) > 0;
        }
    };
    std::array<SidePlane, 4> sides{};

    [[nodiscard]] bool holds(dvec3 p) const {
        return std::ranges::all_of(sides, [p](const SidePlane& side) { return side.is_positive(p); });
    }
    [[nodiscard]] bool surely_holds(dvec3 p) const {
        return std::ranges::all_of(sides, [p](const SidePlane& side) { return side.at(p) > side.doubt; });
    }
    [[nodiscard]] bool surely_misses(dvec3 p) const {
        return std::ranges::any_of(sides, [p](const SidePlane& side) { return side.at(p) < -side.doubt; });
    }
};

/// Which span, counted by one thread, asked each triangle last.
struct Asked {
    std::vector<std::uint32_t> last_span;
    std::uint32_t span = 0;
    std::vector<std::size_t> doubtful;  ///< points of the span by whose side of some shadow rounding decides
};

/// The scene, and the exact test for points that rounding leaves open.
struct Sight final : Built {
    Sight(const Scene& of, const SceneFacts& its_facts) : Built(of, its_facts), exact(of) {}
    [[nodiscard]] std::size_t memory_bytes() const override { return exact.memory_bytes(); }
    const ExactSight exact;
};

/// The shadows of all triangles for one light.
class Shadows final : public Aimed {
public:
    Shadows(const Built& from, LightId at) : Aimed(from, at), cells_(scene(), source()) {}

    [[nodiscard]] std::size_t memory_bytes() const override { return cells_.memory_bytes(); }

    /// Sets s to 0 wherever a triangle hides the span from the light. Each triangle is asked once a span.
    void darken(const PointBatch& points, const Span& span, Asked& asked, std::span<float> s) const {
        const TriangleId own = points.triangle[span.first];
        ++asked.span;
        asked.doubtful.clear();
        cells_.visit(span.a, span.b, [&](std::span<const TriangleId> triangles) {
            for (const TriangleId t : triangles) {
                if (t == own || asked.last_span[t] == asked.span) continue;
                asked.last_span[t] = asked.span;
                darken_by(t, points, span, asked, s);
            }
        });
        std::ranges::sort(asked.doubtful);
        asked.doubtful.erase(std::unique(asked.doubtful.begin(), asked.doubtful.end()), asked.doubtful.end());
        for (const std::size_t i : asked.doubtful)
            if (s[i] != 0 && !as<Sight>(built).exact.is_lit(points, i, source())) s[i] = 0;
    }

    /// The first triangle that hides a position of triangle `own`.
    [[nodiscard]] TriangleId blocker(dvec3 p, TriangleId own) const {
        TriangleId found = kNoTriangle;
        cells_.visit(p, p, [&](std::span<const TriangleId> triangles) {
            for (const TriangleId t : triangles) {
                if (t == own || found != kNoTriangle) continue;
                if (const auto shadow = shadow_of(t, own); shadow && shadow->holds(p) && rises(t, own)) found = t;
            }
        });
        return found;
    }

private:
    /// Points lie beside the span's line by as much as its `shift`. Between the pixels that a shadow holds in spite of
    /// that and those that it cannot hold, each point is asked.
    void darken_by(TriangleId t, const PointBatch& points, const Span& span, Asked& asked, std::span<float> s) const {
        const std::optional<Shadow> shadow = shadow_of(t, points.triangle[span.first]);
        if (!shadow) return;
        Run sure{0, static_cast<double>(span.last - span.first)}, open = sure;
        for (const Shadow::SidePlane& side : shadow->sides) {
            // Divided by depth, its value is linear along the row.
            const double a = side.at(span.a) / span.depth_a, b = side.at(span.b) / span.depth_b;
            const double slack =
                (glm::length(side.normal) * span.shift + 4 * side.doubt) / std::min(span.depth_a, span.depth_b);
            open = open_above(-slack, a, b, span, open);
            if (open.first > open.last) return;
            sure = above(slack, a, b, span, sure);
        }
        if (!rises(t, points.triangle[span.first])) return;
        for (double k = open.first; k <= open.last; ++k) {
            const std::size_t i = span.first + static_cast<std::size_t>(k);
            if (s[i] == 0) continue;
            const bool is_sure = k >= sure.first && k <= sure.last;
            const dvec3 p      = is_sure ? dvec3(0) : exact_position(scene(), points, i);
            if (is_sure || shadow->surely_holds(p))
                s[i] = 0;
            else if (!shadow->surely_misses(p))
                asked.doubtful.push_back(i);
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

    /// The same and those where it is the limit, and up to one more at each end.
    static Run open_above(double limit, double a, double b, const Span& span, Run among) {
        const double pixels = static_cast<double>(span.last - span.first), cut = pixels * (a - limit) / (a - b);
        if (a < limit && b < limit) return {1, 0};
        if (a < limit) among.first = std::max(among.first, std::floor(cut));
        if (b < limit) among.last = std::min(among.last, std::ceil(cut));
        return among;
    }

    /// Whether triangle t may hide something of triangle `own`.
    [[nodiscard]] bool rises(TriangleId t, TriangleId own) const {
        return rises_over(scene(), t, own, side_of_light(scene(), source(), own));
    }

    /// For positions of triangle `own`. None for a triangle that the light sees edge-on.
    [[nodiscard]] std::optional<Shadow> shadow_of(TriangleId t, TriangleId own) const {
        const bool infinite = source().kind == LightKind::directional;
        const dvec3 corner[3]{dvec3(scene().vertex(t, 0)), dvec3(scene().vertex(t, 1)), dvec3(scene().vertex(t, 2))};
        const dvec3 end    = infinite ? -dvec3(source().direction) : dvec3(source().position);
        const dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
        const int facing   = side_of_light(scene(), source(), t);
        if (facing == 0) return std::nullopt;
        const double turn = facing > 0 ? -1 : 1;
        Shadow shadow;
        // Coordinates are known up to some roundings of this, and so is each factor of the values.
        const double size = size_of(scene(), t) + size_of(scene(), own) + (infinite ? 0 : sum_of_magnitudes(end));
        const double area = sum_of_magnitudes(corner[1] - corner[0]) * sum_of_magnitudes(corner[2] - corner[0]);
        // First, since it rules out most.
        shadow.sides[0] = {turn * normal, corner[0], dvec3(0), kRounding * size * area};
        for (std::size_t k = 0; k < 3; ++k) {
            // From a corner, since a far light is known less well than the corners' distance; from the same one for the
            // triangle on the edge's other side, so that no point is between the two.
            dvec3 p = corner[k], q = corner[(k + 1) % 3];
            double sign = turn;
            if (comes_before(q, p)) std::swap(p, q), sign = -turn;
            const dvec3 to_light = infinite ? end : end - p;
            const double factor  = sum_of_magnitudes(to_light) + (infinite ? 0 : size);
            shadow.sides[k + 1]  = {sign * glm::cross(q - p, to_light), p, sign * (q - p),
                                    kRounding * size * sum_of_magnitudes(q - p) * factor};
        }
        return shadow;
    }

    static constexpr double kRounding = 0x1p-46;

    const LightCells cells_;
};

class ScanLine final : public MethodWith<NoOptions, Sight, Shadows, Spans> {
public:
    explicit ScanLine(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only) return {How::not_at_all, "Spans have edges, and no penumbra: no area lights."};
        return {How::to_rounding, "The ends of shadows on each span, in double."};
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const auto& shadows = as<Shadows>(aimed);
        const auto& spans   = as<Spans>(looked);
        parallel_ranges(spans.rows(), 16, [&](std::size_t begin, std::size_t end) {
            Asked asked{std::vector<std::uint32_t>(aimed.scene().triangles.size(), 0), 0, {}};
            for (std::size_t y = begin; y < end; ++y)
                spans.for_each(aimed.light, y, [&](const Span& span) {
                    std::fill_n(out.s.begin() + static_cast<std::ptrdiff_t>(span.first), span.last - span.first + 1,
                                1.0f);
                    shadows.darken(looked.points, span, asked, out.s);
                });
        });
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const PointBatch& points = looked.points;
        blame_each(aimed, looked, blockers, [&](std::size_t i) {
            return as<Shadows>(aimed).blocker(exact_position(aimed.scene(), points, i), points.triangle[i]);
        });
    }
};

}  // namespace

extern const MethodInfo scan_line{
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
    .shown      = true,
    .create     = create<ScanLine>};

}  // namespace umbra
