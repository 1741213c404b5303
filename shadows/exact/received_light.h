// Irradiance: how much of the light that arrives at a surface point comes from one part of the light's plane.
//
//            c        A point q of the light, seen from p in the direction d = q - p, adds to the irradiance at p
//       .----+----.           cos(a) cos(b) / |d|^2 dA = (n . d) (m . d) / (|n| |m| |d|^4) dA,
//        '.   \b|m     with n and m the normals of the surface and of the light. In the light's plane m . d is the
//          '.  \|      same everywhere and dA a multiple of dx dy: up to a factor the weight is
//          d '. +             w(x, y) = h(x, y) / |d|^4,      h = n . d, linear: the height over the point's plane.
//              '.|n
//        --------p----  A disk that replaces a sphere subtends the same directions, so that the same holds.
//
// Where h > 0, nothing here cancels: the weight is positive, and it is summed by a Gauss rule over trapezoids that are
// split until they are small beside their distance from p. With L the half length of a line in such a piece and D >= 4
// L the distance of its middle, 1 / |d|^4 is analytic within D of the middle (|d|^2 vanishes at two complex points at
// exactly that distance). On the ellipse around the line whose half axes sum up to rho L = 6.24 L it exceeds its least
// value on the line by less than M = 1530. A polynomial of degree k then is off by less than 2 M rho^-k / (rho - 1) of
// it. A rule of 10 points is exact to degree 19, of which h and a trapezoid's width take 2: since both are positive, as
// are a rule's weights, the sum is off by less than twice 2e-11 of itself. For D >= 12 L 7 points do the same.
//
// This work is based on:
// Johann Lambert. Photometria. 1760
// Lloyd Trefethen. Is Gauss Quadrature Better than Clenshaw-Curtis? 2008
#pragma once

#include "umbra/shadows/exact/disk_caps.h"
#include "umbra/shadows/exact/horizon.h"

namespace umbra::exact_visibility {

/// A proven range.
struct Bracket {
    double low = 0, high = 0;
};

class ReceivedLight {
public:
    /// `horizon` in doubles; `sight` is read here alone.
    ReceivedLight(const Sight& sight, const Horizon<double>& horizon);

    /// False where so little is known of the distance to the light that nothing here is a bound, and once the pieces
    /// that were asked for had to be split more than kSplits times: parts of the light all but touch the point.
    [[nodiscard]] bool usable() const { return weight_error_ <= kUsable && splits_left_ > 0; }

    /// The integral of the weight over a trapezoid of the light that is before the horizon, in doubles; off by less
    /// than kQuadrature of itself from the rule. One thread at a time.
    [[nodiscard]] double of(const Trapezoid& piece) const { return usable() ? split(piece) : 0; }
    /// Over the caps that are visible, and those that are left open.
    [[nodiscard]] Bracket of(const DiskCaps& caps) const;

    /// At least as large as the weight at every point of the light.
    [[nodiscard]] double most() const { return most_; }
    /// Bound of the error of the weight, by its own rounding and by that of the positions, for an area of 1.
    [[nodiscard]] double weight_error() const { return weight_error_; }
    [[nodiscard]] double height_error() const { return height_error_; }

    static constexpr double kQuadrature = 1e-10;
    static constexpr double kUsable     = 1.0 / 16;  ///< so that first-order bounds hold with a factor of 2
    static constexpr int kSplits        = 1 << 12;   ///< some thousandths of a second

private:
    [[nodiscard]] dvec3 to(double x, double y) const { return centre_ + x * u_ + y * v_; }
    [[nodiscard]] double height(double x, double y) const { return std::max(0.0, horizon_.height(x, y)); }
    [[nodiscard]] double least_distance(bool round) const;
    [[nodiscard]] double split(const Trapezoid& piece) const;
    template <int kPoints>
    [[nodiscard]] double gauss(const Trapezoid& piece) const;
    [[nodiscard]] Bracket cap(int k, bool visible) const;

    dvec3 centre_, u_, v_;     ///< in a unit of length in which the largest component is 1
    Horizon<double> horizon_;  ///< in a unit in which no height exceeds 1
    double most_ = 0, weight_error_ = 0, height_error_ = 0;
    mutable int splits_left_ = kSplits;
};

/// Visible light over all light that arrives, given by brackets of both.
[[nodiscard]] Bracket fraction(const Bracket& visible, const Bracket& whole);

}  // namespace umbra::exact_visibility
