#include "umbra/bench/base/statistics.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace umbra {
namespace {

constexpr std::size_t kLargestSample = 200;

/// Reorders its argument.
double median_of(std::vector<double>& values) {
    const std::size_t half = values.size() / 2;
    const auto middle      = values.begin() + static_cast<std::ptrdiff_t>(half);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

std::vector<double> ratios(std::span<const double> a, std::span<const double> b) {
    std::vector<double> of;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (std::isfinite(a[i]) && std::isfinite(b[i]) && a[i] > 0 && b[i] > 0) of.push_back(a[i] / b[i]);
    return of;
}

/// From the k-th least to the k-th largest, k from 1.
Interval between(std::vector<double>& values, std::size_t k) {
    std::sort(values.begin(), values.end());
    return {values[k - 1], values[values.size() - k]};
}

/// How many of the C(a + b, a) orders of two samples have u inversions, u from 0 to a b: the coefficients of Gauss's
/// binomial, the product of (1 - q^(b + i)) / (1 - q^i).
std::vector<double> orders_by_inversions(std::size_t a, std::size_t b) {
    std::vector<double> count(a * b + 1);
    count[0] = 1;
    for (std::size_t i = 1; i <= a; ++i) {
        for (std::size_t u = count.size(); u-- > b + i;) count[u] -= count[u - b - i];
        for (std::size_t u = i; u < count.size(); ++u) count[u] += count[u - i];
    }
    return count;
}

}  // namespace

double median(std::span<const double> values) {
    if (values.empty()) throw std::logic_error("median of no values");
    std::vector<double> copy(values.begin(), values.end());
    return median_of(copy);
}

MedianRank median_rank(std::size_t n) {
    MedianRank rank;
    if (n == 0) return rank;
    const boost::math::binomial_distribution<double> below(static_cast<double>(n), 0.5);
    for (std::size_t k = 1; 2 * k <= n; ++k) {
        const double coverage = 1 - 2 * cdf(below, static_cast<double>(k - 1));
        if (coverage < kCoverage) break;
        rank = {k, coverage};
    }
    return rank;
}

Ratio paired_ratio(std::span<const double> a, std::span<const double> b) {
    std::vector<double> of = ratios(a, b);
    if (of.empty()) return {};
    Ratio ratio{.median = median_of(of), .pairs = static_cast<int>(of.size())};
    if (const MedianRank rank = median_rank(of.size()); rank.k > 0) {
        ratio.interval = between(of, rank.k);
        ratio.coverage = rank.coverage;
    }
    return ratio;
}

Ratio ratio_of_samples(std::span<const double> a, std::span<const double> b, double level) {
    if (a.empty() || b.empty()) throw std::logic_error("ratio of no values");
    a = a.first(std::min(a.size(), kLargestSample));
    b = b.first(std::min(b.size(), kLargestSample));
    std::vector<double> all;
    for (const double x : a)
        for (const double y : b) all.push_back(x / y);
    Ratio ratio{.median = median_of(all), .pairs = static_cast<int>(std::min(a.size(), b.size()))};
    const std::vector<double> count = orders_by_inversions(a.size(), b.size());
    double orders = 1, tail = 0;
    std::size_t rank = 0;
    for (std::size_t i = 1; i <= a.size(); ++i) orders *= static_cast<double>(b.size() + i) / static_cast<double>(i);
    for (std::size_t k = 1; 2 * k <= all.size(); ++k) {
        tail += count[k - 1] / orders;
        if (1 - 2 * tail < level) break;
        ratio.coverage = 1 - 2 * tail;
        rank           = k;
    }
    if (rank > 0) ratio.interval = between(all, rank);
    return ratio;
}

double noise_bar(const Ratio& same_with_itself) {
    if (!same_with_itself.has_interval()) return std::numeric_limits<double>::infinity();
    return std::max({0.0, same_with_itself.interval.high - 1, 1 / same_with_itself.interval.low - 1});
}

bool differs(const Ratio& ratio, double noise_bar) {
    if (ratio.pairs == 0) return false;
    const bool excludes_1 = ratio.interval.low > 1 || ratio.interval.high < 1;
    return excludes_1 && std::max(ratio.median, 1 / ratio.median) - 1 > noise_bar;
}

}  // namespace umbra
