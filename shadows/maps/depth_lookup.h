// Comparing a surface point with a depth map: where it lies there, how far it is moved towards the light first (the
// bias), and which samples are asked (the filter).
#pragma once

#include <limits>
#include <optional>

#include "umbra/shadows/maps/kernels.h"
#include "umbra/shadows/maps/light_views.h"

namespace umbra {

/// The depth that a sample is compared with.
enum class BiasMode : std::uint8_t {
    automatic,       ///< the nearer of the point and its plane at the sample, and nearer still: see below
    receiver_plane,  ///< the point's plane at the sample
    manual           ///< the point
};

/// The automatic bias
///
/// A sample shows a surface up to half a sample beside the point. Where that is the point's own plane, its depth there
/// is known up to rounding (receiver_plane). Where the surface is curved or folded, the stored depth may lie above that
/// plane by as much as the surface rises in half a sample: with the fold's angle, the flatter the light falls the more.
/// So the automatic bias takes the nearer of plane and point and adds a width and a quarter of the gradient, and never
/// moves a sample by more than 16 widths from the plane: where light grazes, depth gradients are without bound, and a
/// bias that follows them lifts points out of the shadow of occluders just before them (hardware clamps its slope bias,
/// too). It follows:
///   - a plane has no acne at any slope, except for light below 1/16000 of a radian, where snapped corners shift its
///     depth by more than the limit;
///   - a shadow is detached by at most 16 widths of a sample (of a kernel, that many times as much) from the point's
///     plane. But that plane extends beyond the triangle, and where light grazes a small steep facet it may rise over
///     the facet's occluder: the wider the kernel, the sooner.
///
/// Daniel Holbert. Saying Goodbye to Shadow Acne. 2011; Hang Dou, Yajie Yan, Ethan Kerzner, Zeng Dai, Chris Wyman.
/// Adaptive Depth Bias for Shadow Maps. 2014; John Isidoro. Shadow Mapping: GPU-based Tips and Techniques. 2006.
inline constexpr double kMostAutomatic = 16;
/// For a nearest sample; a kernel of n by n samples, whose outermost are n times as far, has n times as much.
inline constexpr double kAutoWidth    = 1;     ///< in widths: what a hollow that turns by 45 degrees rises at its rim
inline constexpr double kAutoGradient = 0.25;  ///< in depth gradients: enough for nearly all points of scanned meshes
/// Positions and their distances from the light are rounded to this fraction of the coordinates and the distance.
inline constexpr double kPositionRounding = 8 * std::numeric_limits<double>::epsilon();

/// The first and the last move the point in widths of a sample there, `slope` in depth gradients of its plane.
struct Bias {
    BiasMode mode        = BiasMode::automatic;
    double constant      = 0;
    double slope         = 0;
    double normal_offset = 0;
};

/// A surface point's triangle, exact in double.
struct Facet {
    dvec3 a, ab, ac;
    dvec3 normal;  ///< unit, on the side of the batch's normal
};

/// The receiver in one map: where the point lies, and its triangle's plane r(x, y) there.
struct Receiver {
    double x, y;                 ///< samples
    double r;                    ///< nearness of the point
    double r_x, r_y;             ///< nearness of its plane, a sample
    double bias;                 ///< nearness added to all comparisons
    double slack = 0, most = 0;  ///< automatic: nearness added to the nearer of plane and point, most above the plane
    double snapping = 0;         ///< automatic: nearness by which its plane may be off in the map
    dvec2 turn{1, 0};            ///< cosine and sine of the angle that discs are rotated by
};

/// PCF: the fraction of the samples about the point that are not blocked, never a comparison with filtered depth. A
/// sample that has a midpoint is compared with the point's plane (manual: with the point) without slack: the surface
/// that casts is half of its body away. [Andrew Woo, The Shadow Depth Map Revisited, Graphics Gems III, 1992]
[[nodiscard]] float lit_share(const MapView& view, const Receiver& receiver, BiasMode mode, const Filter& filter);

/// PCSS: a search for blockers, and then PCF as wide as the penumbra that a light of this size has behind them.
struct SoftFilter {
    std::span<const dvec2> points{};  ///< in the unit disk, of the search and of the filter: even_disk
    double size   = 0;                ///< of the light: the radius of a disk of its area, world units, > 0
    double texels = 64;               ///< farthest from the point that a sample is taken
};

/// The fraction of an area light that reaches the receiver at `depth` along a perspective view, as if the light were a
/// disk that faces the point and all blockers lay at one depth, the mean of those that the search finds.
/// [Randima Fernando, Percentage-Closer Soft Shadows, 2005]
[[nodiscard]] float soft_share(const MapView& view, const Receiver& receiver, double depth, BiasMode mode,
                               const SoftFilter& filter);

/// The nearest to the point of the samples that lit_share finds blocked; none where it finds none.
[[nodiscard]] std::optional<ivec2> blocked_sample(const MapView& view, const Receiver& receiver, BiasMode mode,
                                                  const Filter& filter);

}  // namespace umbra
