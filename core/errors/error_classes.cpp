#include "umbra/core/errors/error_classes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace umbra {
namespace {

constexpr double kBand = 1.5;  // pixels

void require_raster(const PointBatch& points, const VisibilityPlane& plane) {
    if (!points.raster) throw std::logic_error("visibility error: the batch has no raster");
    if (plane.s.size() != points.size() || plane.answer.size() != points.size() ||
        plane.half_width.size() != points.size())
        throw std::logic_error("visibility error: a plane is not of the batch's size");
}

/// The pixels within the band of the midpoint between pixel (x, y) and its right (or lower) neighbour.
void mark(std::vector<std::uint8_t>& band, int width, int height, int x, int y, bool below) {
    const double mid_x = x + (below ? 0 : 0.5), mid_y = y + (below ? 0.5 : 0);
    for (int py = std::max(0, y - 2); py <= std::min(height - 1, y + 2); ++py)
        for (int px = std::max(0, x - 2); px <= std::min(width - 1, x + 2); ++px)
            if (std::hypot(px - mid_x, py - mid_y) <= kBand)
                band[static_cast<std::size_t>(py) * static_cast<std::size_t>(width) + static_cast<std::size_t>(px)] = 1;
}

}  // namespace

std::vector<std::uint8_t> edge_band(const PointBatch& points, LightId light, const VisibilityPlane& reference,
                                    float tolerance) {
    require_raster(points, reference);
    const int width = points.raster->width, height = points.raster->height;
    std::vector<std::uint8_t> band(points.size(), 0);
    const auto drawn = [&](std::size_t i) { return points.asks(light, i) && reference.defined(i); };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            if (!drawn(i)) continue;
            const auto boundary_before = [&](std::size_t j) {
                return drawn(j) && std::abs(reference.s[i] - reference.s[j]) > tolerance / kBand;
            };
            if (x + 1 < width && boundary_before(i + 1)) mark(band, width, height, x, y, false);
            if (y + 1 < height && boundary_before(i + static_cast<std::size_t>(width)))
                mark(band, width, height, x, y, true);
        }
    return band;
}

ClassPlane error_classes(const PointBatch& points, LightId light, const VisibilityPlane& s,
                         const VisibilityPlane& reference, float tolerance, std::span<const std::uint8_t> judged) {
    require_raster(points, s);
    if (!judged.empty() && judged.size() != points.size())
        throw std::logic_error("visibility error: the mask of judged points is not of the batch's size");
    const auto band = edge_band(points, light, reference, tolerance);

    const auto class_of = [&](std::size_t i) {
        const Facing facing = points.facing[light][i];
        if (facing == Facing::none) return ErrorClass::no_surface;
        if (facing == Facing::away) return ErrorClass::away;
        if (facing == Facing::unshadowed) return ErrorClass::unshadowed;
        if (s.defined(i) && !judged.empty() && judged[i] == 0) return ErrorClass::not_judged;
        if (reference.answer[i] == Answer::on_boundary) return ErrorClass::on_boundary;
        if (!s.defined(i) || !reference.defined(i)) return ErrorClass::undefined;
        const double d       = static_cast<double>(s.s[i]) - static_cast<double>(reference.s[i]);
        const double allowed = static_cast<double>(tolerance) + static_cast<double>(reference.half_width[i]);
        if (std::abs(d) <= allowed) return ErrorClass::right;
        if (d < 0) return band[i] ? ErrorClass::false_shadow_edge : ErrorClass::false_shadow;
        return band[i] ? ErrorClass::false_light_edge : ErrorClass::false_light;
    };
    ClassPlane classes(points.size());
    for (std::size_t i = 0; i < classes.size(); ++i) classes[i] = class_of(i);
    return classes;
}

}  // namespace umbra
