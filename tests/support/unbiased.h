// Is a sampling method right on average? A test with a stated rate of false alarms, where a tolerance would be a guess.
#pragma once

#include <functional>
#include <span>

#include "umbra/bench/lab/run.h"

namespace umbra {

/// The penumbra's points are taken in groups of similar S_j and position. One run with one seed gives each group a mean
/// residual s - expected; runs with different seeds are independent, whatever the points of one run have to do with
/// each other. Where the method is unbiased, the mean of K of these over its standard error follows Student's t with
/// K - 1 degrees of freedom. [Student, The Probable Error of a Mean, 1908]
///
/// Groups are of like S_j, so that a penumbra that is too narrow (too dark on one side, too bright on the other) is
/// seen as one that is displaced is. Points with less than 1/32 of the light seen, or hidden, are left out: too few
/// samples fall there for sums of them to be normally distributed.
struct BiasTest {
    int groups = 0;         ///< 0: nothing to test
    double p   = 1;         ///< chance that an unbiased method shows anywhere what the worst group shows, at most
                            ///< (Bonferroni: that group's own, times the number of groups)
    double bias       = 0;  ///< mean residual of the worst group
    double expected   = 0;  ///< its mean S_j
    double resolution = 0;  ///< standard error of a group's mean residual, median over groups
};

/// An unbiased method is refused once in a million tests.
inline constexpr double kFalseAlarm = 1e-6;

/// Asks for `seeds` planes. Undefined points are left out.
[[nodiscard]] BiasTest bias_test(const VisibilityPlane& expected, int seeds,
                                 const std::function<VisibilityPlane(int seed)>& sample);

/// The method's planes of one light by seed, for bias_test. The arguments must outlive the function.
[[nodiscard]] std::function<VisibilityPlane(int seed)> seeded_planes(const MethodChoice& choice, const Scene& scene,
                                                                     const SceneFacts& facts, const PointBatch& points,
                                                                     LightId light);

}  // namespace umbra
