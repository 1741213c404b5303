#include "umbra/bench/base/power_law.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace umbra {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The factor on a standard error of a 95 % interval.
double student_t(int degrees) {
    return quantile(complement(boost::math::students_t_distribution<double>(degrees), 0.025));
}

std::vector<double> logarithms(std::span<const double> values) {
    std::vector<double> logs;
    for (const double v : values) {
        if (!(std::isfinite(v) && v > 0)) throw std::logic_error("a power law of a value that is not positive");
        logs.push_back(std::log(v));
    }
    return logs;
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

}  // namespace

double PowerLaw::at(double x) const { return factor * std::pow(x, exponent); }

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
    if (x.size() != y.size() || x.size() < 2) throw std::logic_error("a power law of fewer than two points");
    const std::vector<double> u = logarithms(x), v = logarithms(y);
    const double u_mean = mean(u), v_mean = mean(v);
    double uu = 0, uv = 0, vv = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
        uu += (u[i] - u_mean) * (u[i] - u_mean);
        uv += (u[i] - u_mean) * (v[i] - v_mean);
        vv += (v[i] - v_mean) * (v[i] - v_mean);
    }
    if (uu == 0) throw std::logic_error("a power law of equal sizes");

    PowerLaw law;
    law.points       = static_cast<int>(u.size());
    law.range        = {std::ranges::min(x), std::ranges::max(x)};
    law.exponent     = uv / uu;
    law.factor       = std::exp(v_mean - law.exponent * u_mean);
    law.log_x_mean   = u_mean;
    law.log_x_spread = uu;
    double residuals = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
        const double off = v[i] - v_mean - law.exponent * (u[i] - u_mean);
        residuals += off * off;
    }
    law.r_squared         = vv == 0 ? 1 : std::clamp(1 - residuals / vv, 0.0, 1.0);
    law.exponent_interval = {-kInfinite, kInfinite};
    if (law.points < 3) return law;
    law.residual_variance = residuals / (law.points - 2);
    const double width    = student_t(law.points - 2) * std::sqrt(law.residual_variance / uu);
    law.exponent_interval = {law.exponent - width, law.exponent + width};
    return law;
}

std::optional<Crossing> crossing(const PowerLaw& a, const PowerLaw& b) {
    const double slope = a.exponent - b.exponent;
    const double root  = (std::log(b.factor) - std::log(a.factor)) / slope;
    const double x     = std::exp(root);
    if (slope == 0 || !std::isfinite(x) || x <= 0) return std::nullopt;

    const int degrees = std::min(a.points, b.points) - 2;
    if (degrees < 1) return Crossing{x, {0, kInfinite}};
    const double t2 = std::pow(student_t(degrees), 2);
    // With w = u - root the difference of the lines is slope w and its variance q0 + 2 q1 w + q2 w^2. They do not
    // differ where (slope w)^2 <= t^2 (q0 + 2 q1 w + q2 w^2).
    double q0 = 0, q1 = 0, q2 = 0;
    for (const PowerLaw* law : {&a, &b}) {
        const double from_mean = root - law->log_x_mean, s2 = law->residual_variance;
        q0 += s2 * (1.0 / law->points + from_mean * from_mean / law->log_x_spread);
        q1 += s2 * from_mean / law->log_x_spread;
        q2 += s2 / law->log_x_spread;
    }
    const double square = slope * slope - t2 * q2;
    if (square <= 0) return Crossing{x, {0, kInfinite}};  // the exponents do not differ
    const double half = std::sqrt(t2 * t2 * q1 * q1 + square * t2 * q0);
    return Crossing{x, {std::exp(root + (t2 * q1 - half) / square), std::exp(root + (t2 * q1 + half) / square)}};
}

}  // namespace umbra
