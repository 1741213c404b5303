// Medians, and ratios of times that were measured in pairs.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace umbra {

/// Throws std::logic_error where there is none. Of an even number: the mean of the middle two.
[[nodiscard]] double median(std::span<const double> values);

struct Interval {
    double low = 0, high = 0;
};

/// Of a_i / b_i. `pairs` is 0 where there is nothing to compare; the ratio then means nothing.
struct Ratio {
    double median = 1;
    Interval interval{1, 1};  ///< 95 %
    int pairs = 0;

    /// One pair has no interval: its bounds are 0 and infinity.
    [[nodiscard]] bool has_interval() const { return pairs > 1; }
};

/// The median of the paired ratios a_i / b_i over the first min(|a|, |b|) pairs, whose bootstrap interval takes the
/// percentiles 2.5 and 97.5 of the medians of 2000 resamples of the pairs. The seed is fixed: equal input gives equal
/// bits with every compiler. Pairs that are not both finite and positive are left out. The interval of two to four
/// pairs spans the least and the largest ratio and is not a 95 % interval (of n pairs, both lie on one side of the
/// true median with the probability 2^(1-n)); one pair has none.
///
/// Own code: the bootstrap is a loop, and neither Boost.Math nor another packaged library has one.
/// [Bradley Efron, Robert Tibshirani, An Introduction to the Bootstrap, 1993]
[[nodiscard]] Ratio paired_ratio(std::span<const double> a, std::span<const double> b);

/// The percentiles 2.5 and 97.5 of `of(medians)` over 2000 resamples, in each of which every sample is resampled on its
/// own; `medians` is one a sample. Deterministic as above. Throws std::logic_error where a sample is empty.
[[nodiscard]] Interval bootstrap_interval(const std::vector<std::vector<double>>& samples,
                                          const std::function<double(std::span<const double> medians)>& of);

/// sum_k weights[k] median(a[k]) over the same of b, samples of one length whose values with one index were measured
/// together; as paired_ratio, but its `median` is this ratio of medians. The interval always holds it. No pairs where
/// one of the sums is not positive. Throws std::logic_error where a sample is empty or lengths differ.
[[nodiscard]] Ratio ratio_of_medians(const std::vector<std::vector<double>>& a,
                                     const std::vector<std::vector<double>>& b, std::span<const double> weights);

/// How far from 1 the ratio of two runs of the same program may lie on this machine: the bound farthest from 1 of the
/// interval of its paired ratio, as a distance on the ratio's larger side (0.03: ratios from 1 / 1.03 to 1.03 say
/// nothing). Infinity where there are fewer than two pairs: then nothing can be said to differ.
[[nodiscard]] double noise_bar(const Ratio& same_with_itself);

/// Above this noise bar times are taken again, and nothing is chosen by times that it covers.
inline constexpr double kMostNoise = 0.3;

/// Whether the ratio says that two programs take different times: its interval excludes 1, and its median lies outside
/// the noise bar.
[[nodiscard]] bool differs(const Ratio& ratio, double noise_bar);

}  // namespace umbra
