#include "umbra/shadows/maps/receive_eight.h"

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

using Lanes = double[8];

/// A few points one by one, where the bias moves them first.
Receivers8 one_by_one(const MapView& view, const FacetPoints8& points, unsigned which, const Bias& bias,
                      const Filter& filter) {
    Receivers8 to;
    for (int k = 0; k < 8; ++k) {
        if ((which >> k & 1) == 0) continue;
        Facet facet{};
        facet.normal = points.normal(k);
        const auto r = receive(view, facet, points.point(k), bias, filter);
        if (!r) continue;
        to.covered |= 1u << k;
        to.x[k] = r->x, to.y[k] = r->y, to.r[k] = r->r, to.r_x[k] = r->r_x, to.r_y[k] = r->r_y, to.bias[k] = r->bias;
        to.slack[k] = r->slack, to.most[k] = r->most, to.snapping[k] = r->snapping;
    }
    return to;
}

}  // namespace

// Each line is one of `receive`.
Receivers8 receive_eight(const MapView& view, const FacetPoints8& points, unsigned which, const Bias& bias,
                         const Filter& filter) {
    if (bias.normal_offset > 0) return one_by_one(view, points, which, bias, filter);
    const LightFrame& f    = view.frame;
    const bool perspective = f.perspective;
    const auto dot         = [](dvec3 a, double x, double y, double z) { return a.x * x + a.y * y + a.z * z; };
    Lanes vx, vy, vz, ax, ay;
    int covered[8];
    for (int k = 0; k < 8; ++k) {
        const double x = points.px[k] - f.origin.x, y = points.py[k] - f.origin.y, z = points.pz[k] - f.origin.z;
        vx[k] = dot(f.x, x, y, z), vy[k] = dot(f.y, x, y, z), vz[k] = dot(f.z, x, y, z);
        const double over = perspective ? vz[k] : 1.0;
        ax[k]             = (vx[k] / over - f.centre.x) / f.half.x;
        ay[k]             = (vy[k] / over - f.centre.y) / f.half.y;
        const bool behind = perspective & (vz[k] <= 0);
        const int in_x = !(std::abs(ax[k]) > f.reach), in_y = !(std::abs(ay[k]) > f.reach);
        covered[k] = static_cast<int>(!behind) & in_x & in_y;
    }
    Receivers8 to;
    for (int k = 0; k < 8; ++k) to.covered |= covered[k] != 0 ? which & 1u << k : 0;
    if (to.covered == 0) return to;

    const double across = view.map.width(), down = view.map.height();
    const dvec2 sample   = 2.0 * f.half / dvec2(across, down);  // in window units
    const double widest  = std::max(sample.x, sample.y);
    const double depths  = f.far - f.near;
    const double samples = 2 * filter.radius + 1;
    const double from    = glm::length(f.origin);
    Lanes largest, per_depth;
    for (int k = 0; k < 8; ++k) {
        const double nx = dot(f.x, points.nx[k], points.ny[k], points.nz[k]),
                     ny = dot(f.y, points.nx[k], points.ny[k], points.nz[k]),
                     nz = dot(f.z, points.nx[k], points.ny[k], points.nz[k]);
        const double x = ax[k] < -4 ? -4 : ax[k], y = ay[k] < -4 ? -4 : ay[k];
        to.x[k] = ((x > 4 ? 4 : x) + 1) * 0.5 * across;
        to.y[k] = ((y > 4 ? 4 : y) + 1) * 0.5 * down;
        to.r[k] = perspective ? f.near * (f.far - vz[k]) / (vz[k] * depths) : (f.far - vz[k]) / depths;
        const double scale =
            perspective ? f.near * f.far / (depths * (nx * vx[k] + ny * vy[k] + nz * vz[k])) : 1 / (depths * nz);
        const bool finite      = std::abs(scale) <= std::numeric_limits<double>::max();
        to.r_x[k]              = finite ? scale * nx * sample.x : 0;
        to.r_y[k]              = finite ? scale * ny * sample.y : 0;
        per_depth[k]           = perspective ? f.near * f.far / (vz[k] * vz[k] * depths) : 1 / depths;
        const double width     = widest * (perspective ? vz[k] : 1.0);
        const double per_width = width * per_depth[k];
        const double rx = std::abs(to.r_x[k]), ry = std::abs(to.r_y[k]);
        const double gradient = rx < ry ? ry : rx, snapping = (rx + ry) / kSnapsPerSample;
        to.bias[k]     = bias.constant * per_width + bias.slope * gradient;
        to.slack[k]    = samples * (kAutoWidth * per_width + kAutoGradient * gradient) + snapping;
        to.most[k]     = samples * kMostAutomatic * per_width;
        to.snapping[k] = snapping;
        largest[k] =
            std::sqrt(dot({points.px[k], points.py[k], points.pz[k]}, points.px[k], points.py[k], points.pz[k])) +
            from + std::abs(vz[k]);
    }
    if (bias.mode == BiasMode::manual) {
        for (int k = 0; k < 8; ++k) to.slack[k] = to.most[k] = to.snapping[k] = 0;
        return to;
    }
    for (int k = 0; k < 8; ++k) {
        if ((to.covered >> k & 1) == 0) continue;
        to.bias[k] += view.map.quantum(to.r[k]) + kPositionRounding * largest[k] * per_depth[k];
        if (bias.mode == BiasMode::receiver_plane) to.bias[k] += to.snapping[k];
    }
    return to;
}

}  // namespace umbra
