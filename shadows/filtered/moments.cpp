#include "umbra/shadows/filtered/moments.h"

#include <algorithm>
#include <cmath>

namespace umbra {

int moment_count(MomentKind kind) {
    switch (kind) {
        case MomentKind::esm: return 1;
        case MomentKind::vsm:
        case MomentKind::evsm2: return 2;
        case MomentKind::evsm4:
        case MomentKind::msm: break;
    }
    return 4;
}

Moments moments_of(const MomentBound& bound, double z) {
    const double x = 2 * z - 1;
    if (bound.kind == MomentKind::vsm) return {x, x * x, 0, 0};
    if (bound.kind == MomentKind::msm) return {x, x * x, x * x * x, x * x * x * x};
    const double positive = std::exp(bound.positive * x);
    if (bound.kind == MomentKind::esm) return {positive, 0, 0, 0};
    if (bound.kind == MomentKind::evsm2) return {positive, positive * positive, 0, 0};
    const double negative = -std::exp(-bound.negative * x);
    return {positive, positive * positive, negative, negative * negative};
}

double chebyshev(double mean, double mean_square, double value, double least_variance) {
    if (value <= mean) return 1;
    const double variance = std::max(mean_square - mean * mean, least_variance);
    if (!(variance > 0)) return 0;
    const double beyond = value - mean;
    return variance / (variance + beyond * beyond);
}

double hamburger(const Moments& b, double value) {
    const double m        = b[0];
    const double variance = b[1] - m * m;
    if (!(variance > 0)) return value > m ? 1 : 0;
    // Moments about the mean, in standard deviations: 0, 1, skewness, kurtosis. `spare` is what the kurtosis has beyond
    // the least that goes with this skewness, which distributions of two values have.
    const double sigma = std::sqrt(variance);
    const double skew  = (b[2] - 3 * m * b[1] + 2 * m * m * m) / (variance * sigma);
    const double kurt  = (b[3] - 4 * m * b[2] + 6 * m * m * b[1] - 3 * m * m * m * m) / (variance * variance);
    const double spare = std::max(0.0, kurt - skew * skew - 1);
    const double s     = (value - m) / sigma;

    // The distribution with the least below s has s among its at most three values. Its others are the roots of
    // q x^2 + linear x + constant, and the orthogonal polynomials up to x^2 - skew x - 1 give what it has at s.
    const double q = s * s - skew * s - 1;
    if (q == 0) return s > 0 ? s * s / (1 + s * s) : 0;  // two values: s, and -1 / s
    const double at_s     = spare / (spare * (1 + s * s) + q * q);
    const double linear   = spare * s - q * skew;
    const double constant = spare - q;
    const double root     = std::sqrt(std::max(0.0, linear * linear - 4 * q * constant));
    const double larger   = -0.5 * (linear + std::copysign(root, linear));  // the sum that cancels nothing
    if (larger == 0) return 0;
    const double one = larger / q, other = constant / larger;
    const double low = std::min(one, other), high = std::max(one, other);
    if (s <= low) return 0;
    if (s > high) return std::clamp(1 - at_s, 0.0, 1.0);
    return std::clamp((at_s * s + (1 - at_s) * high) / (high - low), 0.0, 1.0);
}

namespace {

/// At one of two depths, as where a filter holds an occluder and the receiver, the bound of msm jumps: rounding would
/// say on which side. It is asked for that much before, in units of x.
constexpr double kBeforeDepth = 2e-6;

}  // namespace

double lit_bound(const MomentBound& bound, const Moments& means, double z) {
    const double x = 2 * z - 1;
    switch (bound.kind) {
        case MomentKind::vsm: return chebyshev(means[0], means[1], x, 4 * bound.min_variance);
        case MomentKind::esm: return std::min(1.0, means[0] * std::exp(-bound.positive * x));
        case MomentKind::msm: {
            // Towards these, of all distributions on [-1, 1], the fewest bits are lost. [Peters and others 2017]
            constexpr Moments kTowards{0, 0.375, 0, 0.375};
            Moments biased = means;
            for (std::size_t k = 0; k < biased.size(); ++k) biased[k] += bound.moment_bias * (kTowards[k] - means[k]);
            return 1 - hamburger(biased, x - kBeforeDepth);
        }
        case MomentKind::evsm2:
        case MomentKind::evsm4: break;
    }
    // A warped depth changes by 2 c times its own size a unit of z. exp(c x) in units of that at x, which may overflow;
    // exp(-d x) only becomes 0 there.
    const double shrink = std::exp(-bound.positive * x), slope = 2 * bound.positive;
    const double by_positive =
        chebyshev(means[0] * shrink, means[1] * shrink * shrink, 1, slope * slope * bound.min_variance);
    if (bound.kind == MomentKind::evsm2) return by_positive;
    const double warped = -std::exp(-bound.negative * x), change = 2 * bound.negative * warped;
    return std::min(by_positive, chebyshev(means[2], means[3], warped, change * change * bound.min_variance));
}

double occluder_depth(double lit, double mean_depth, double z) {
    return lit < 1 ? std::clamp((mean_depth - lit * z) / (1 - lit), 0.0, z) : z;
}

}  // namespace umbra
