// Comparing a surface point with a depth map: where it lies there, how far it is moved towards the light first (the
// bias), and which samples are asked (the filter).
#pragma once

#include <optional>

#include "shadows/light_views.h"

namespace umbra {

/// What a sample is compared with.
enum class BiasMode : std::uint8_t {
    automatic,       ///< the nearer of the point and its plane at the sample, by half a sample's width and gradient
    receiver_plane,  ///< the point's plane at the sample
    manual           ///< the point
};

/// The first and the last move the point in widths of a sample there, `slope` in depth gradients of its plane.
struct Bias {
    BiasMode mode        = BiasMode::automatic;
    double constant      = 0;
    double slope         = 0;
    double normal_offset = 0;
};

struct Filter {
    int radius    = 0;  ///< (2 radius + 1)^2 samples
    bool bilinear = false;
};

/// A surface point's triangle, exact in double.
struct Facet {
    dvec3 a, ab, ac;
    dvec3 normal;  ///< unit, on the side of the batch's normal
};

/// The receiver in one map: where the point lies, and its triangle's plane r(x, y) there.
struct Receiver {
    double x, y;      ///< samples
    double r;         ///< nearness of the point
    double r_x, r_y;  ///< nearness of its plane, a sample
    double bias;      ///< nearness added to all comparisons
};

/// The receiver in a view, or nothing where the view does not cover it.
[[nodiscard]] std::optional<Receiver> receive(const View& view, const Facet& facet, dvec3 p, const Bias& bias,
                                              const Filter& filter);

/// PCF: the share of the samples about the point that are not blocked, never a comparison with filtered depth.
[[nodiscard]] float lit_share(const DepthMap& map, const Receiver& receiver, BiasMode mode, const Filter& filter);

/// Of those samples that lit_share finds blocked, the one nearest to the point; none where it finds none.
[[nodiscard]] std::optional<ivec2> blocked_sample(const DepthMap& map, const Receiver& receiver, BiasMode mode,
                                                  const Filter& filter);

}  // namespace umbra
