#include "umbra/shadows/maps/receive_eight.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/lanes.h"

namespace umbra {
namespace {

// No loop has a branch: lanes that nobody asked for get some number.

template <bool perspective, std::size_t N>
LaneReceivers<N> receive_lanes(const MapView& view, const FacetPoints<N>& points, unsigned which, const Bias& bias,
                               const Filter& filter) {
    using Doubles       = LaneArray<double, N>;
    constexpr int count = N;
    const LightFrame& f = view.frame;
    const auto dot      = [](dvec3 a, double x, double y, double z) { return a.x * x + a.y * y + a.z * z; };
    Doubles vx, vy, vz, ax, ay;
    const auto find_place = [&](int k) {
        const double over = perspective ? vz[k] : 1.0;
        ax[k]             = (vx[k] / over - f.centre.x) / f.half.x;
        ay[k]             = (vy[k] / over - f.centre.y) / f.half.y;
    };
    int covered[N];
    for (int k = 0; k < count; ++k) {
        const double x = points.px[k] - f.origin.x, y = points.py[k] - f.origin.y, z = points.pz[k] - f.origin.z;
        vx[k] = dot(f.x, x, y, z), vy[k] = dot(f.y, x, y, z), vz[k] = dot(f.z, x, y, z);
        find_place(k);
        const bool behind = perspective && vz[k] <= 0;
        const int in_x = !(std::abs(ax[k]) > f.reach), in_y = !(std::abs(ay[k]) > f.reach);
        covered[k] = static_cast<int>(!behind) & in_x & in_y;
    }
    LaneReceivers<N> to;
    for (int k = 0; k < count; ++k) to.covered |= covered[k] != 0 ? which & 1u << k : 0;
    if (to.covered == 0) return to;

    Doubles width, nx, ny, nz;  // the width of a sample, in world units
    const double across = view.map.width(), down = view.map.height();
    const dvec2 sample  = 2.0 * f.half / dvec2(across, down);  // in window units
    const double widest = std::max(sample.x, sample.y);
    for (int k = 0; k < count; ++k) {
        width[k] = perspective ? widest * vz[k] : widest;
        nx[k]    = dot(f.x, points.nx[k], points.ny[k], points.nz[k]);
        ny[k]    = dot(f.y, points.nx[k], points.ny[k], points.nz[k]);
        nz[k]    = dot(f.z, points.nx[k], points.ny[k], points.nz[k]);
    }
    if (bias.normal_offset > 0)
        for (int k = 0; k < count; ++k) {
            // A plane seen head-on needs no offset, a grazing one all of it.
            const dvec3 v(vx[k], vy[k], vz[k]);
            const double cosine = perspective ? dot(v, nx[k], ny[k], nz[k]) / glm::length(v) : nz[k];
            const double by     = bias.normal_offset * width[k] * std::sqrt(std::max(0.0, 1 - cosine * cosine));
            vx[k] += by * nx[k], vy[k] += by * ny[k], vz[k] += by * nz[k];
            if (const bool moved_behind = vz[k] <= 0; perspective && moved_behind) to.covered &= ~(1u << k);
            find_place(k);
        }
    const double depths  = f.far - f.near;
    const double samples = 2 * filter.radius + 1;
    const double from    = glm::length(f.origin);
    const double near = f.near, far = f.far;
    const bool manual   = bias.mode == BiasMode::manual;
    const bool is_plane = bias.mode == BiasMode::receiver_plane;
    Doubles largest, per_depth, scale;
    for (int k = 0; k < count; ++k)
        scale[k] = perspective ? near * far / (depths * (nx[k] * vx[k] + ny[k] * vy[k] + nz[k] * vz[k]))
                               : 1 / (depths * nz[k]);
    for (int k = 0; k < count; ++k) {
        const bool finite = std::abs(scale[k]) <= std::numeric_limits<double>::max();
        const double r_x = scale[k] * nx[k] * sample.x, r_y = scale[k] * ny[k] * sample.y;
        to.r_x[k] = finite ? r_x : 0.0;
        to.r_y[k] = finite ? r_y : 0.0;
    }
    for (int k = 0; k < count; ++k) {
        const double x = ax[k] < -4 ? -4 : ax[k], y = ay[k] < -4 ? -4 : ay[k];
        to.x[k]                = ((x > 4 ? 4 : x) + 1) * 0.5 * across;
        to.y[k]                = ((y > 4 ? 4 : y) + 1) * 0.5 * down;
        to.r[k]                = perspective ? near * (far - vz[k]) / (vz[k] * depths) : (far - vz[k]) / depths;
        per_depth[k]           = perspective ? near * far / (vz[k] * vz[k] * depths) : 1 / depths;
        const double per_width = width[k] * per_depth[k];
        const double rx = std::abs(to.r_x[k]), ry = std::abs(to.r_y[k]);
        const double gradient = rx < ry ? ry : rx, snapping = (rx + ry) / kSnapsPerSample;
        to.bias[k]     = bias.constant * per_width + bias.slope * gradient;
        to.slack[k]    = samples * (kAutoWidth * per_width + kAutoGradient * gradient) + snapping;
        to.most[k]     = samples * kMostAutomatic * per_width;
        to.snapping[k] = snapping;
    }
    if (manual) {
        for (int k = 0; k < count; ++k) to.slack[k] = to.most[k] = to.snapping[k] = 0;
        return to;
    }
    for (int k = 0; k < count; ++k) {
        const double length =
            std::sqrt(points.px[k] * points.px[k] + points.py[k] * points.py[k] + points.pz[k] * points.pz[k]);
        largest[k] = length + from + std::abs(vz[k]);
    }
    for (int k = 0; k < count; ++k) {
        to.bias[k] += view.map.quantum(to.r[k]) + kPositionRounding * largest[k] * per_depth[k];
        to.bias[k] += is_plane ? to.snapping[k] : 0.0;
    }
    return to;
}

}  // namespace

std::optional<Receiver> receive(const MapView& view, const Facet& facet, dvec3 p, const Bias& bias,
                                const Filter& filter) {
    FacetPoints<1> point;
    point.set(0, p, facet.normal);
    const LaneReceivers<1> one = view.frame.perspective ? receive_lanes<true>(view, point, 1, bias, filter)
                                                        : receive_lanes<false>(view, point, 1, bias, filter);
    return one.covered != 0 ? std::optional(one.lane(0)) : std::nullopt;
}

std::optional<FoundReceiver> receive(std::span<const MapView> views, const Facet& facet, dvec3 p, const Bias& bias,
                                     const Filter& filter) {
    for (std::size_t v = 0; v < views.size(); ++v)
        if (const auto receiver = receive(views[v], facet, p, bias, filter)) return FoundReceiver{v, *receiver};
    return {};
}

UMBRA_FOR_EACH_PROCESSOR Receivers8 receive_eight(const MapView& view, const FacetPoints8& points, unsigned which,
                                                  const Bias& bias, const Filter& filter) {
    return view.frame.perspective ? receive_lanes<true>(view, points, which, bias, filter)
                                  : receive_lanes<false>(view, points, which, bias, filter);
}

UMBRA_FOR_EACH_PROCESSOR unsigned lit_lanes(const MapView& view, const Receivers8& p, BiasMode mode) {
    const bool manual = mode == BiasMode::manual, automatic = mode == BiasMode::automatic;
    LaneArray<double> x, y, bound;
    for (int k = 0; k < 8; ++k) {
        x[k] = std::floor(p.x[k]), y[k] = std::floor(p.y[k]);
        const double plane = p.r[k] + p.r_x[k] * (x[k] + 0.5 - p.x[k]) + p.r_y[k] * (y[k] + 0.5 - p.y[k]);
        const double above = p.r[k] - plane, eased = (above > 0 ? above : 0.0) + p.slack[k];
        const double by = p.most[k] < eased ? p.most[k] : eased;
        const double r  = (manual ? p.r[k] : automatic ? plane + by : plane) + p.bias[k];
        bound[k]        = r > 0 ? r : 0.0;  // behind all that casts, r is negative
    }
    const double width = view.map.width(), height = view.map.height();
    unsigned lit = p.covered;
    for (int k = 0; k < 8; ++k) {
        if ((p.covered >> k & 1) == 0 || x[k] < 0 || y[k] < 0 || x[k] >= width || y[k] >= height) continue;
        if (view.map.nearness(static_cast<int>(x[k]), static_cast<int>(y[k])) > bound[k]) lit &= ~(1u << k);
    }
    return lit;
}

}  // namespace umbra
