// How a time or an error grows with a size: y = factor x^exponent, fitted, and where two such laws meet.
#pragma once

#include <optional>
#include <span>

#include "umbra/bench/base/statistics.h"

namespace umbra {

/// A straight line through the logarithms. Intervals are of 95 %; unbounded for fewer than three points.
struct PowerLaw {
    double exponent = 0, factor = 0;
    Interval exponent_interval;
    double r_squared = 0;  ///< of the logarithms, [0, 1]; 1 where all y are equal, as the line then holds exactly
    int points       = 0;
    Interval range;  ///< of x

    // What `crossing` needs of the fit: mean and sum of squared deviations of log x, variance of the residuals.
    double log_x_mean = 0, log_x_spread = 0, residual_variance = 0;

    [[nodiscard]] double at(double x) const;
};

/// Least squares of logarithms, with Student's t of n - 2 degrees of freedom (Boost.Math). Throws std::logic_error for
/// fewer than two points, for unequal lengths, for values that are not finite and positive, and where all x are equal.
[[nodiscard]] PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

/// Where two power laws have the same value. The interval holds every x at which the two fits do not differ at 95 %;
/// 0 and infinity where no bound can be given.
struct Crossing {
    double x = 0;
    Interval interval;
};

/// Nothing where the exponents are equal, or where x is not a finite positive double. The interval is that of the root
/// of a difference of two regression lines; its degrees of freedom are those of the fit that has fewer.
/// [Edgar Fieller, Some Problems in Interval Estimation, 1954]
[[nodiscard]] std::optional<Crossing> crossing(const PowerLaw& a, const PowerLaw& b);

}  // namespace umbra
