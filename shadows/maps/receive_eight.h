// Where eight surface points lie in a depth map, and whether one sample there blocks them: `receive` and `lit_share` in
// loops over lanes, the same bits.
#pragma once

#include "umbra/shadows/maps/depth_lookup.h"

namespace umbra {

/// Eight surface points: the point, and the normal of its triangle, as `receive` takes them. Lanes may be unset.
struct FacetPoints8 {
    double px[8]{}, py[8]{}, pz[8]{};
    double nx[8]{}, ny[8]{}, nz[8]{};

    void set(int k, dvec3 p, dvec3 normal) {
        px[k] = p.x, py[k] = p.y, pz[k] = p.z;
        nx[k] = normal.x, ny[k] = normal.y, nz[k] = normal.z;
    }
    [[nodiscard]] dvec3 point(int k) const { return {px[k], py[k], pz[k]}; }
    [[nodiscard]] dvec3 normal(int k) const { return {nx[k], ny[k], nz[k]}; }
};

/// The receivers of those lanes that a view covers.
struct Receivers8 {
    double x[8], y[8], r[8], r_x[8], r_y[8], bias[8], slack[8], most[8], snapping[8];
    unsigned covered = 0;  ///< bit k: lane k was asked for, and is there

    [[nodiscard]] Receiver lane(int k) const {
        return {x[k], y[k], r[k], r_x[k], r_y[k], bias[k], slack[k], most[k], snapping[k]};
    }
};

/// `receive` of each lane k whose bit of `which` is set.
[[nodiscard]] Receivers8 receive_eight(const MapView& view, const FacetPoints8& points, unsigned which,
                                       const Bias& bias, const Filter& filter);

/// Bit k: lane k is covered, and `lit_share` is 1 there, with a filter of one sample in a view without midpoints.
[[nodiscard]] unsigned lit_lanes(const MapView& view, const Receivers8& receivers, BiasMode mode);

}  // namespace umbra
