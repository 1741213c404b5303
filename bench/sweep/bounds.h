// Upper bounds of errors: what a setting's error in a view that was not measured exceeds in one case of twenty.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "umbra/bench/sweep/metrics.h"

namespace umbra {

/// The share of cases in which a bound is meant to hold.
inline constexpr double kConfidence = 0.95;

/// A setting that leaves more of the points undefined is on no front and is not recommended: what it leaves undefined
/// has no error.
inline constexpr double kMostLeftOut = 0.01;

/// The largest fraction of the points that a view of them has left undefined; 0 of cells that do not say.
[[nodiscard]] double most_undefined(std::span<const Cell> views);

/// Why a setting is on no front and not recommended, from cells of some of its views; empty where it may be.
[[nodiscard]] std::string why_unfit(std::span<const Cell> views);

/// The largest share of wrong points that `wrong` of `of` points leave possible (Clopper and Pearson 1934, one-sided):
/// of 0 wrong points about 3 / of.
[[nodiscard]] double upper_share(std::uint64_t wrong, std::uint64_t of);

/// What a view leaves possible: the measured error, or what its count or its number of points leaves possible, as in
/// upper_bound, and the half width of the reference. Nothing where it was not judged, and where its value is the least
/// that it may be.
[[nodiscard]] std::optional<double> possible_error(const Metric& metric, const Cell& cell);

/// The largest share of further views that may be beyond a limit where none of `views` is, which were drawn alike and
/// had no part in the choice: 1 - (1 - kConfidence)^(1 / views), about 3 / views. The k-th setting that is tried on
/// them, after k - 1 that were beyond, has 1 - kConfidence divided by k.
[[nodiscard]] double share_beyond(int views, std::size_t tried = 1);

/// From cells of one setting in several views, each of which has its own random numbers and, where the reference is
/// sampled, its own sample of points:
///
///  - a setting that serves `exactly` is off by the reference's half width alone, by proof;
///  - a view's share of points is the largest that its count leaves possible (upper_share); an error of S_j is the
///    measured one, or, where that is 0, what 0 wrong points of as many leave possible if they are wrong by all of S_j;
///    the half width of the reference is added;
///  - over the views, the upper prediction bound for one more: logarithms are taken to be normally distributed,
///    Student's t with the views less one as degrees of freedom. It is no less than the largest error measured.
///
/// Nothing where a view was not judged, where a value is the least that it may be (is_at_least), where there are fewer
/// than two views, and where the method failed or does not serve.
[[nodiscard]] std::optional<double> upper_bound(const Metric& metric, std::span<const Cell> views);

}  // namespace umbra
