#include "umbra/shadows/scanline/light_cells.h"

#include <algorithm>

#include "umbra/shadows/geometry/clipped_polygon.h"

namespace umbra::scanline {
namespace {

constexpr double kWide = 1e-9;  ///< boxes are widened by far more than rounding, relative to a face

std::size_t cells_along(const Scene& scene, int faces) {
    const double wanted = std::sqrt(static_cast<double>(scene.triangles.size()) / faces);
    return static_cast<std::size_t>(std::clamp(2 * wanted, 8.0, 1024.0));
}

}  // namespace

LightCells::LightCells(const Scene& scene, const Light& light)
    : infinite_(light.kind == LightKind::directional),
      faces_(infinite_ ? 1 : 6),
      side_(cells_along(scene, faces_)),
      from_(light.position) {
    if (infinite_) {
        const Box box     = bounds(scene);
        const dvec3 along = glm::normalize(dvec3(light.direction));
        const Axes axes   = axes_across(along);
        from_             = 0.5 * (dvec3(box.min) + dvec3(box.max));
        double size       = 0.5 * glm::length(dvec3(box.max) - dvec3(box.min)) * (1 + 4 * kWide);
        if (!(size > 0)) size = 1;
        across_[0] = axes.u / size, across_[1] = axes.v / size, across_[2] = along / size;
    }
    first_.assign(static_cast<std::size_t>(faces_) * side_ * side_ + 1, 0);
    const auto each = [&](const auto& put) {
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            if (!scene.blocks(t)) continue;
            const std::array<dvec3, 3> corners{seen(dvec3(scene.vertex(t, 0))), seen(dvec3(scene.vertex(t, 1))),
                                               seen(dvec3(scene.vertex(t, 2)))};
            for (int face = 0; face < faces_; ++face)
                if (const auto part = outline(face, corners))
                    for (int y = column(part->low.y); y <= column(part->high.y); ++y)
                        for (int x = column(part->low.x); x <= column(part->high.x); ++x) put(cell(face, x, y), t);
        }
    };
    each([&](std::size_t c, TriangleId) { ++first_[c + 1]; });
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    triangles_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    each([&](std::size_t c, TriangleId t) { triangles_[next[c]++] = t; });
}

dvec3 LightCells::seen(dvec3 p) const {
    const dvec3 d = p - from_;
    return infinite_ ? dvec3(glm::dot(d, across_[0]), glm::dot(d, across_[1]), 1) : d;
}

template <std::size_t N>
std::optional<LightCells::Coverage> LightCells::outline(int face, const std::array<dvec3, N>& corners) const {
    ClippedPolygon<dvec3, N + 4> part;
    for (const dvec3& corner : corners) part.add(infinite_ ? corner : in_cube_face(face, corner));
    if (!infinite_) {
        const auto cut = [&](const auto& side) { part.template cut<CutFrom::first>(side, N == 2); };
        cut([](dvec3 p) { return p.z * (1 + kWide) - p.x; });
        cut([](dvec3 p) { return p.z * (1 + kWide) + p.x; });
        cut([](dvec3 p) { return p.z * (1 + kWide) - p.y; });
        cut([](dvec3 p) { return p.z * (1 + kWide) + p.y; });
    }
    if (part.count == 0) return std::nullopt;
    Coverage found;
    for (std::size_t k = 0; k < part.count; ++k) {
        const dvec3 p = part.corners[k];
        // In the light itself all directions meet.
        const dvec2 q = p.z > 0 ? dvec2(p) / p.z : dvec2(0);
        if (!(p.z > 0)) found.low = dvec2(-1), found.high = dvec2(1);
        found.low  = glm::min(found.low, q);
        found.high = glm::max(found.high, q);
        if (k == 0) found.from = q;
        found.to = q;
    }
    found.low -= kWide, found.high += kWide;
    return found;
}

int LightCells::column(double x) const {
    const auto cells = static_cast<double>(side_);
    return static_cast<int>(std::clamp((x + 1) / 2 * cells, 0.0, cells - 1));
}

/// Where a segment is within a row, widened by a little.
std::pair<double, double> LightCells::across(const Coverage& segment, int row) const {
    const double step = segment.to.y - segment.from.y;
    if (std::abs(step) < kWide) return {segment.low.x, segment.high.x};
    const double cells = static_cast<double>(side_), low = 2 * row / cells - 1 - kWide,
                 high = low + 2 / cells + 2 * kWide;
    const auto at     = [&](double y) {
        const double t = std::clamp((y - segment.from.y) / step, 0.0, 1.0);
        return segment.from.x + t * (segment.to.x - segment.from.x);
    };
    const auto [a, b]  = std::minmax({at(low), at(high)});
    const double slack = kWide * (1 + std::abs((segment.to.x - segment.from.x) / step));
    return {std::max(segment.low.x, a - slack), std::min(segment.high.x, b + slack)};
}

template std::optional<LightCells::Coverage> LightCells::outline(int, const std::array<dvec3, 2>&) const;

}  // namespace umbra::scanline
