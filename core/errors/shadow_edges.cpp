#include "umbra/core/errors/shadow_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace umbra {
namespace {

/// A pair of neighbours between which S passes 1/2.
struct Piece {
    dvec2 at;       ///< pixels, centres at whole numbers
    ivec2 towards;  ///< the light: one step along an axis
};

/// Where S is 1/2 between two values on its two sides, as a fraction of the distance.
double crossing(float a, float b) {
    return (0.5 - static_cast<double>(a)) / (static_cast<double>(b) - static_cast<double>(a));
}

bool crosses(float a, float b) { return (a < 0.5f) != (b < 0.5f); }

/// Calls body(i, j, x, y, below) for each pair of 4-neighbours of one surface that are compared.
template <class Body>
void for_each_pair(const PointBatch& points, const ClassPlane& classes, const Body& body) {
    const int width = points.raster->width, height = points.raster->height;
    const auto pair = [&](std::size_t i, std::size_t j, int x, int y, bool below) {
        if (is_drawn(classes[j])) body(i, j, x, y, below);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            if (!is_drawn(classes[i])) continue;
            if (x + 1 < width) pair(i, i + 1, x, y, false);
            if (y + 1 < height) pair(i, i + static_cast<std::size_t>(width), x, y, true);
        }
}

std::vector<Piece> boundary(const PointBatch& points, const ClassPlane& classes, const std::vector<float>& s) {
    std::vector<Piece> pieces;
    for_each_pair(points, classes, [&](std::size_t i, std::size_t j, int x, int y, bool below) {
        if (!crosses(s[i], s[j]) || !one_surface(points, i, j)) return;
        const double t   = crossing(s[i], s[j]);
        const int uphill = s[j] > s[i] ? 1 : -1;
        pieces.push_back(below ? Piece{{x, y + t}, {0, uphill}} : Piece{{x + t, y}, {uphill, 0}});
    });
    return pieces;
}

/// Pieces by the pixel that they lie in, for searching around a position.
class Pieces {
public:
    Pieces(std::vector<Piece> pieces, int width, int height)
        : width_(width), height_(height), pieces_(std::move(pieces)), begin_(std::size_t(width) * height + 1, 0) {
        std::sort(pieces_.begin(), pieces_.end(),
                  [&](const Piece& a, const Piece& b) { return pixel(a.at) < pixel(b.at); });
        for (const Piece& p : pieces_) ++begin_[pixel(p.at) + 1];
        for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    }

    /// From `from` to the nearest piece that does not have the light on the other side; beyond kFarthest, infinite.
    [[nodiscard]] double distance(const Piece& from) const {
        const ivec2 middle(from.at), reach(static_cast<int>(kFarthest) + 1);
        const ivec2 low  = glm::max(middle - reach, ivec2(0));
        const ivec2 high = glm::min(middle + reach, ivec2(width_ - 1, height_ - 1));
        double nearest   = std::numeric_limits<double>::infinity();
        for (int y = low.y; y <= high.y; ++y)
            for (std::uint32_t k = begin_[pixel({low.x, y})]; k < begin_[pixel({high.x, y}) + 1]; ++k) {
                const ivec2 t = pieces_[k].towards;
                if (t.x * from.towards.x + t.y * from.towards.y < 0) continue;
                const double d = glm::length(pieces_[k].at - from.at);
                if (d <= kFarthest) nearest = std::min(nearest, d);
            }
        return nearest;
    }

private:
    [[nodiscard]] std::size_t pixel(dvec2 at) const {
        return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(at.x);
    }
    int width_, height_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> begin_;  ///< of each pixel's run of pieces, and the end of the last
};

/// Length of the line S = 1/2 by straight pieces through each square of four neighbouring centres.
/// [William Lorensen, Harvey Cline, Marching Cubes, 1987, in two dimensions]
double length_of_half_level(const PointBatch& points, const ClassPlane& classes, const std::vector<float>& s) {
    const auto width                       = static_cast<std::size_t>(points.raster->width),
               height                      = static_cast<std::size_t>(points.raster->height);
    constexpr std::array<dvec2, 4> kCorner = {dvec2(0, 0), dvec2(1, 0), dvec2(1, 1), dvec2(0, 1)};
    double length                          = 0;
    for (std::size_t y = 0; y + 1 < height; ++y)
        for (std::size_t x = 0; x + 1 < width; ++x) {
            const std::size_t i                     = y * width + x;
            const std::array<std::size_t, 4> corner = {i, i + 1, i + width + 1, i + width};
            std::array<dvec2, 4> at;
            std::size_t found = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t a = corner[k], b = corner[(k + 1) % 4];
                if (crosses(s[a], s[b])) at[found++] = glm::mix(kCorner[k], kCorner[(k + 1) % 4], crossing(s[a], s[b]));
            }
            if (found == 0) continue;
            const bool whole = std::ranges::all_of(corner, [&](std::size_t c) { return is_drawn(classes[c]); });
            if (!whole || !one_surface(points, corner[0], corner[2]) || !one_surface(points, corner[1], corner[3]))
                continue;
            for (std::size_t k = 0; k < found; k += 2) length += glm::length(at[k + 1] - at[k]);
        }
    return length;
}

}  // namespace

double pixel_span(const PointBatch& points, std::size_t i) {
    const CameraFrame& f = *points.raster;
    const double span    = 2 * std::max(f.half_width / f.width, f.half_height / f.height);
    return f.projection == Projection::perspective ? span * f.project(dvec3(points.position(i))).z : span;
}

bool one_surface(const PointBatch& points, std::size_t i, std::size_t j) {
    const dvec3 way(dvec3(points.position(j)) - dvec3(points.position(i)));
    const double off =
        std::max(std::abs(glm::dot(way, dvec3(points.normal(i)))), std::abs(glm::dot(way, dvec3(points.normal(j)))));
    return off <= std::max(pixel_span(points, i), pixel_span(points, j));
}

std::optional<EdgeDisplacement> edge_displacement(const PointBatch& points, const ClassPlane& classes,
                                                  const VisibilityPlane& s, const VisibilityPlane& reference) {
    const std::vector<Piece> truth = boundary(points, classes, reference.s);
    const Pieces found(boundary(points, classes, s.s), points.raster->width, points.raster->height);
    EdgeDisplacement e;
    e.pieces = truth.size();
    std::vector<double> distances;
    for (const Piece& piece : truth) {
        const double d = found.distance(piece);
        if (std::isfinite(d))
            distances.push_back(d);
        else
            ++e.unmatched;
    }
    if (truth.empty()) return {};
    if (distances.empty()) return e;
    std::sort(distances.begin(), distances.end());
    for (const double d : distances) e.mean += d / static_cast<double>(distances.size());
    e.p95 = distances[(distances.size() - 1) * 95 / 100];
    e.max = distances.back();
    return e;
}

std::optional<PenumbraWidth> penumbra_width(const PointBatch& points, const ClassPlane& classes,
                                            const VisibilityPlane& s, const VisibilityPlane& reference) {
    const double length = length_of_half_level(points, classes, reference.s);
    if (length < 1) return {};
    const auto width = [&](const std::vector<float>& plane) {
        double area = 0;
        for (std::size_t i = 0; i < plane.size(); ++i)
            if (is_drawn(classes[i])) area += static_cast<double>(plane[i]) * (1 - static_cast<double>(plane[i]));
        return 6 * area / length;
    };
    return PenumbraWidth{width(s.s), width(reference.s)};
}

}  // namespace umbra
