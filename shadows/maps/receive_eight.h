// Where surface points lie in a depth map, one or eight at a time with the same bits, and whether one sample there
// blocks eight: `lit_share` in loops over lanes.
#pragma once

#include "umbra/shadows/maps/depth_lookup.h"

namespace umbra {

/// Surface points: the point, and the normal of its triangle. Lanes may be unset.
template <std::size_t N>
struct FacetPoints {
    double px[N]{}, py[N]{}, pz[N]{};
    double nx[N]{}, ny[N]{}, nz[N]{};

    void set(int k, dvec3 p, dvec3 normal) {
        px[k] = p.x, py[k] = p.y, pz[k] = p.z;
        nx[k] = normal.x, ny[k] = normal.y, nz[k] = normal.z;
    }
    [[nodiscard]] dvec3 point(int k) const { return {px[k], py[k], pz[k]}; }
};
using FacetPoints8 = FacetPoints<8>;

/// The receivers of those lanes that a view covers.
template <std::size_t N>
struct LaneReceivers {
    double x[N], y[N], r[N], r_x[N], r_y[N], bias[N], slack[N], most[N], snapping[N];
    unsigned covered = 0;  ///< bit k: lane k was asked for, and is there

    [[nodiscard]] Receiver lane(int k) const {
        return {x[k], y[k], r[k], r_x[k], r_y[k], bias[k], slack[k], most[k], snapping[k]};
    }
};
using Receivers8 = LaneReceivers<8>;

/// The receiver in a view, or nothing where the view does not cover it.
[[nodiscard]] std::optional<Receiver> receive(const MapView& view, const Facet& facet, dvec3 p, const Bias& bias,
                                              const Filter& filter);

/// The receiver in the first of several views that covers the point, and which it is.
struct FoundReceiver {
    std::size_t view = 0;
    Receiver receiver;
};
[[nodiscard]] std::optional<FoundReceiver> receive(std::span<const MapView> views, const Facet& facet, dvec3 p,
                                                   const Bias& bias, const Filter& filter);

/// `receive` of each lane k whose bit of `which` is set.
[[nodiscard]] Receivers8 receive_eight(const MapView& view, const FacetPoints8& points, unsigned which,
                                       const Bias& bias, const Filter& filter);

/// Bit k: lane k is covered, and `lit_share` is 1 there, with a filter of one sample in a view without midpoints.
[[nodiscard]] unsigned lit_lanes(const MapView& view, const Receivers8& receivers, BiasMode mode);

}  // namespace umbra
