// Bounds of the lit fraction, P(occluder depth >= d), from a few moments of depth: the means of powers, or of
// exponentials, of the depths in a filter.
//
// Except where a floor, a bias or a cut is asked for, every bound errs to one side: a filter that keeps moments may let
// light through that the depths themselves block (a light leak), and never blocks light that they let through.
//
// William Donnelly, Andrew Lauritzen. Variance Shadow Maps. 2006 (vsm)
// Thomas Annen, Tom Mertens, Hans-Peter Seidel, Eddy Flerackers, Jan Kautz. Exponential Shadow Maps. 2008 (esm)
// Marco Salvi. Rendering Filtered Shadows with Exponential Shadow Maps. ShaderX6. 2008 (esm)
// Andrew Lauritzen, Michael McCool. Layered Variance Shadow Maps. 2008 (evsm2, evsm4)
// Christoph Peters, Reinhard Klein. Moment Shadow Mapping. 2015 (msm)
// Christoph Peters, Cedrick Muenstermann, Nico Wetzstein, Reinhard Klein. Improved Moment Shadow Maps for Translucent
// Occluders, Soft Shadows and Single Scattering. 2017 (the moments that the bias moves towards)
// Baoguang Yang, Zhao Dong, Jieqing Feng, Hans-Peter Seidel, Jan Kautz. Variance Soft Shadow Mapping. 2010 (the depth
// of blockers)
#pragma once

#include <array>
#include <cstdint>

namespace umbra {

/// Moments of a depth z in [0, 1]. All work on x = 2 z - 1, where numbers are finer in the middle:
///   vsm    x, x^2
///   esm    exp(c x)
///   evsm2  exp(c x) and its square
///   evsm4  those, and -exp(-d x) and its square: the least of two bounds
///   msm    x, x^2, x^3, x^4
enum class MomentKind : std::uint8_t { vsm, esm, evsm2, evsm4, msm };

/// As many as the kind keeps; the rest are 0.
using Moments = std::array<double, 4>;
[[nodiscard]] int moment_count(MomentKind kind);  ///< 1 to 4

/// How moments are made and read.
struct MomentBound {
    MomentKind kind = MomentKind::evsm4;
    double positive = 40;     ///< c, > 0: exp(2 c) and exp(-2 c) must be numbers of the precision that they are kept in
    double negative = 5;      ///< d, likewise
    double min_variance = 0;  ///< of z, for vsm and evsm: no variance is taken as less, >= 0
    double moment_bias  = 0;  ///< of msm: weight of other moments that are mixed in, [0, 1]
};

/// The moments of one depth, z in [0, 1] or beyond.
[[nodiscard]] Moments moments_of(const MomentBound& bound, double z);

/// An upper bound of P(depth >= z), [0, 1], from the means of moments; z in [0, 1e6].
[[nodiscard]] double lit_bound(const MomentBound& bound, const Moments& means, double z);

/// The mean depth of the samples before z, [0, z], where the fraction `lit` of all is taken to lie at z and all have
/// this mean depth; z where none lies before it. [Yang and others 2010]
[[nodiscard]] double occluder_depth(double lit, double mean_depth, double z);

/// Chebyshev's inequality of one side (Cantelli): the largest P(X >= value) of all distributions with this mean and
/// mean square; 1 where value <= mean. A variance below `least_variance` >= 0 is taken as that.
[[nodiscard]] double chebyshev(double mean, double mean_square, double value, double least_variance);

/// Hamburger's moment problem with four moments of X: the least P(X < value) of all distributions that have them. Exact
/// for X of at most two values, and for three of which `value` is one. Moments that no distribution has, by rounding,
/// are taken as those of the nearest with two values.
[[nodiscard]] double hamburger(const Moments& means, double value);

}  // namespace umbra
