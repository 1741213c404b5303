// Medians, and ratios of times with intervals that hold the true ratio as often as they state.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace umbra {

/// Throws std::logic_error where there is none. Of an even number: the mean of the middle two.
[[nodiscard]] double median(std::span<const double> values);

struct Interval {
    double low = 0, high = 0;
};
/// As records have it: low, high.
[[nodiscard]] inline std::vector<double> ends(const Interval& interval) { return {interval.low, interval.high}; }

/// What an interval states at least: the probability with which it holds the true value.
inline constexpr double kCoverage = 0.95;

/// Of values that were measured in pairs, or of two samples. `pairs` is 0 where there is nothing to compare; the ratio
/// then means nothing.
struct Ratio {
    double median = 1;
    Interval interval{0, std::numeric_limits<double>::infinity()};
    int pairs       = 0;
    double coverage = 0;  ///< the probability with which the interval holds the true ratio; 0 where there is none

    /// Without one, its bounds are 0 and infinity.
    [[nodiscard]] bool has_interval() const { return pairs > 0 && std::isfinite(interval.high); }
};

/// The interval from the k-th least to the k-th largest of n independent values holds the median of what they are drawn
/// from with the probability 1 - 2 sum_{i<k} C(n, i) / 2^n, whatever the distribution (more often, if it has steps).
struct MedianRank {
    std::size_t k   = 0;  ///< from 1, the largest that covers at least kCoverage; 0 where none does: of less than six
    double coverage = 0;
};
/// [William Thompson, On Confidence Ranges for the Median and Other Expectation Distributions for Populations of
/// Unknown Distribution Form, 1936]
[[nodiscard]] MedianRank median_rank(std::size_t n);

/// The median of the ratios a_i / b_i of the first min(|a|, |b|) pairs, with its interval by median_rank. Pairs that
/// are not both finite and positive are left out. Fewer than six have no interval.
[[nodiscard]] Ratio paired_ratio(std::span<const double> a, std::span<const double> b);

/// Of two samples whose values are no pairs: the median of all a_i / b_j, and the interval from the k-th least to the
/// k-th largest of them, which holds the factor between two distributions of one shape with at least the probability
/// `level`, whatever the shape; `pairs` is the size of the smaller sample. Samples of four and four values have an
/// interval at kCoverage, those of three have none. Of more than 200 values, the first 200 are taken. Throws
/// std::logic_error where a sample is empty.
///
/// Own code: neither Boost.Math nor another packaged library has the distribution of U.
/// [Henry Mann, Donald Whitney, On a Test of Whether One of Two Random Variables is Stochastically Larger than the
/// Other, 1947; Joseph Hodges, Erich Lehmann, Estimates of Location Based on Rank Tests, 1963]
[[nodiscard]] Ratio ratio_of_samples(std::span<const double> a, std::span<const double> b, double level = kCoverage);

/// How far from 1 the ratio of two runs of the same program may lie on this machine: the bound farthest from 1 of the
/// interval of its paired ratio, as a distance on the ratio's larger side (0.03: ratios from 1 / 1.03 to 1.03 say
/// nothing). Infinity where there is no interval: then nothing can be said to differ.
[[nodiscard]] double noise_bar(const Ratio& same_with_itself);

/// Above this noise bar times are taken again, and nothing is chosen by times that it covers.
inline constexpr double kMostNoise = 0.3;

/// Whether times vary too much to rank anything by them.
[[nodiscard]] inline bool is_too_noisy(double noise_bar) { return !(noise_bar <= kMostNoise); }

/// Whether the noise bar tells that a median of times is above another one.
[[nodiscard]] inline bool is_dearer(double dearer, double cheaper, double noise_bar) {
    return dearer > cheaper * (1 + noise_bar);
}

/// Whether the ratio says that two programs take different times: its interval excludes 1, and its median lies outside
/// the noise bar. Of equal programs it says so with at most the probability 1 - coverage.
[[nodiscard]] bool differs(const Ratio& ratio, double noise_bar);

}  // namespace umbra
