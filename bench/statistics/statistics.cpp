#include "umbra/bench/statistics/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "umbra/core/base/random_bits.h"

namespace umbra {
namespace {

constexpr int kResamples                = 2000;
constexpr std::uint64_t kSeed           = 20260131;
constexpr std::size_t kFewestToResample = 5;
constexpr double kUnbounded             = std::numeric_limits<double>::infinity();

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

/// The percentiles 2.5 and 97.5 of `of(medians)` over resamples of all samples: of each on its own, or of the same
/// indices in all of them.
Interval resampled(const std::vector<std::vector<double>>& samples, bool together,
                   const std::function<double(std::span<const double> medians)>& of) {
    std::vector<double> results(kResamples), medians(samples.size()), drawn;
    std::uint64_t counter = kSeed;
    for (double& result : results) {
        const std::uint64_t first = counter;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (samples[k].empty()) throw std::logic_error("bootstrap of no values");
            if (together) counter = first;
            drawn.resize(samples[k].size());
            // The high bits scaled to an index: a distribution of the standard library would differ between libraries.
            for (double& d : drawn) d = samples[k][((mixed_bits(counter++) >> 32) * samples[k].size()) >> 32];
            medians[k] = median_of(drawn);
        }
        result = of(medians);
    }
    std::sort(results.begin(), results.end());
    constexpr std::size_t tail = kResamples / 40;  // 2.5 %
    return {results[tail], results[kResamples - 1 - tail]};
}

}  // namespace

double median(std::span<const double> values) {
    if (values.empty()) throw std::logic_error("median of no values");
    std::vector<double> copy(values.begin(), values.end());
    return median_of(copy);
}

Interval bootstrap_interval(const std::vector<std::vector<double>>& samples,
                            const std::function<double(std::span<const double> medians)>& of) {
    return resampled(samples, false, of);
}

Ratio ratio_of_medians(const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b,
                       std::span<const double> weights) {
    std::vector<std::vector<double>> samples = a;
    samples.insert(samples.end(), b.begin(), b.end());
    const auto quotient = [&](std::span<const double> of) {
        double above = 0, below = 0;
        for (std::size_t k = 0; k < weights.size(); ++k)
            above += weights[k] * of[k], below += weights[k] * of[weights.size() + k];
        return above / below;
    };
    std::vector<double> medians;
    for (const std::vector<double>& sample : samples) {
        if (sample.size() != samples.front().size()) throw std::logic_error("samples that are no pairs");
        medians.push_back(median(sample));
    }
    const std::size_t pairs = samples.front().size();
    Ratio ratio{quotient(medians), {0, kUnbounded}, static_cast<int>(pairs)};
    if (!std::isfinite(ratio.median) || !(ratio.median > 0)) return {};
    if (!ratio.has_interval()) return ratio;
    Interval found{ratio.median, ratio.median};
    const auto holds = [&](double value) { found = {std::min(found.low, value), std::max(found.high, value)}; };
    if (pairs >= kFewestToResample) {
        const Interval drawn = resampled(samples, true, quotient);
        holds(drawn.low), holds(drawn.high);
    }
    for (std::size_t i = 0; i < pairs && pairs < kFewestToResample; ++i) {
        for (std::size_t k = 0; k < samples.size(); ++k) medians[k] = samples[k][i];
        holds(quotient(medians));
    }
    ratio.interval = found;
    return ratio;
}

Ratio paired_ratio(std::span<const double> a, std::span<const double> b) {
    const std::vector<double> of = ratios(a, b);
    if (of.empty()) return {};
    Ratio ratio{median(of), {}, static_cast<int>(of.size())};
    if (!ratio.has_interval()) {
        ratio.interval = {0, kUnbounded};
        return ratio;
    }
    const auto [least, largest] = std::minmax_element(of.begin(), of.end());
    ratio.interval              = {*least, *largest};
    if (of.size() >= kFewestToResample)
        ratio.interval = bootstrap_interval({of}, [](std::span<const double> medians) { return medians[0]; });
    return ratio;
}

double noise_bar(const Ratio& same_with_itself) {
    if (!same_with_itself.has_interval()) return kUnbounded;
    return std::max({0.0, same_with_itself.interval.high - 1, 1 / same_with_itself.interval.low - 1});
}

bool differs(const Ratio& ratio, double noise_bar) {
    if (ratio.pairs == 0) return false;
    const bool excludes_1 = ratio.interval.low > 1 || ratio.interval.high < 1;
    return excludes_1 && std::max(ratio.median, 1 / ratio.median) - 1 > noise_bar;
}

}  // namespace umbra
