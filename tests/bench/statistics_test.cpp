// Statistics with known answers: by hand, from tables, or by what a planted defect would change.
#include "umbra/bench/base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "umbra/bench/base/pareto.h"
#include "umbra/bench/base/power_law.h"
#include "umbra/bench/base/profile.h"
#include "umbra/core/base/random_bits.h"

namespace umbra {
namespace {

using Values                 = std::vector<double>;
constexpr double kInfinite   = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// Numbers of a normal distribution by Box and Muller, from a counter.
class Normal {
public:
    explicit Normal(std::uint64_t seed) : counter_(seed << 32) {}
    double operator()() {
        const double radius = std::sqrt(-2 * std::log(uniform()));
        return radius * std::cos(2 * std::numbers::pi * uniform());
    }

private:
    double uniform() { return (static_cast<double>(mixed_bits(counter_++) >> 11) + 0.5) * 0x1p-53; }
    std::uint64_t counter_;
};

TEST(Median, IsTheMiddleOrTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(median(Values{7}), 7);
    EXPECT_EQ(median(Values{9, 1, 5}), 5);
    EXPECT_EQ(median(Values{8, 1, 2, 100}), 5);
    EXPECT_EQ(median(Values{2, 2, 2, 2}), 2);
    EXPECT_THROW((void)median(Values{}), std::logic_error);
}

/// A drift that slows both by the same factor leaves paired ratios alone; the ratio of the medians would move.
TEST(PairedRatio, ADriftOfTheMachineCancels) {
    Values a, b;
    for (int round = 0; round < 9; ++round) {
        const double speed = 1 + 0.5 * round;
        a.push_back(3 * speed);
        b.push_back(2 * speed);
    }
    std::reverse(a.begin() + 1, a.end());  // the medians stay, the pairs do not
    const Ratio unpaired = paired_ratio(a, b);
    std::reverse(a.begin() + 1, a.end());
    const Ratio paired = paired_ratio(a, b);
    EXPECT_DOUBLE_EQ(paired.median, 1.5);
    EXPECT_DOUBLE_EQ(paired.interval.low, 1.5);
    EXPECT_DOUBLE_EQ(paired.interval.high, 1.5);
    EXPECT_EQ(paired.pairs, 9);
    EXPECT_GT(unpaired.interval.high - unpaired.interval.low, 1);
}

TEST(PairedRatio, TakesTheFirstPairsAndLeavesOutWhatIsNoTime) {
    EXPECT_EQ(paired_ratio(Values{4, 6, 100}, Values{2, 3}).pairs, 2);
    EXPECT_EQ(paired_ratio(Values{4, 6, 100}, Values{2, 3}).median, 2);
    const Ratio ratio = paired_ratio(Values{4, 0, kNotANumber, kInfinite, 9}, Values{2, 1, 1, 1, 3});
    EXPECT_EQ(ratio.pairs, 2);
    EXPECT_EQ(ratio.median, 2.5);
    EXPECT_EQ(paired_ratio(Values{}, Values{1}).pairs, 0);
}

/// The least and the largest of five miss the median in 2 / 2^5 = 6 % of all cases, of six in 3 %.
TEST(PairedRatio, FewerThanSixPairsHaveNoInterval) {
    const Values ones(6, 1.0);
    for (std::size_t n = 1; n <= 5; ++n) {
        const Ratio few = paired_ratio(Values(n, 7), ones);
        EXPECT_EQ(few.pairs, int(n));
        EXPECT_EQ(few.median, 7);
        EXPECT_FALSE(few.has_interval()) << n;
        EXPECT_EQ(few.interval.low, 0);
        EXPECT_EQ(few.interval.high, kInfinite);
        EXPECT_EQ(few.coverage, 0);
        EXPECT_FALSE(differs(few, 0.05));
        EXPECT_EQ(noise_bar(few), kInfinite);
    }
    const Ratio six = paired_ratio(Values{3, 1, 6, 2, 5, 4}, ones);
    EXPECT_TRUE(six.has_interval());
    EXPECT_EQ(six.interval.low, 1);
    EXPECT_EQ(six.interval.high, 6);
    EXPECT_EQ(six.coverage, 31.0 / 32);
}

/// Sums of binomial coefficients by hand: of 8 the second least would cover 1 - 2 (1 + 8) / 256 = 93 %.
TEST(MedianRank, IsTheNarrowestThatCovers) {
    const auto is = [](std::size_t n, std::size_t k, double coverage) {
        EXPECT_EQ(median_rank(n).k, k) << n;
        EXPECT_NEAR(median_rank(n).coverage, coverage, 1e-12) << n;
    };
    is(0, 0, 0), is(1, 0, 0), is(5, 0, 0);
    is(6, 1, 1 - 2.0 / 64), is(7, 1, 1 - 2.0 / 128), is(8, 1, 1 - 2.0 / 256);
    is(9, 2, 1 - 2 * (1 + 9) / 512.0), is(10, 2, 1 - 2 * (1 + 10) / 1024.0);
    is(12, 3, 1 - 2 * (1 + 12 + 66) / 4096.0);
    is(16, 4, 1 - 2 * (1 + 16 + 120 + 560) / 65536.0);
    EXPECT_EQ(median_rank(30).k, 10u);
    EXPECT_NEAR(median_rank(30).coverage, 0.9572, 5e-5) << "from a table of the sign test";
    EXPECT_GE(median_rank(5000).coverage, 0.95);
    EXPECT_LT(median_rank(5000).coverage, 0.952);
}

/// Noise on a time: its median is `median`.
struct Noise {
    const char* name;
    std::function<double(Normal&)> draw;
    double median;
};

/// A view or a round in five is ten times as large: P(10 e^(0.05 z) < m) is 0, so that the median is where the normal
/// distribution reaches 0.5 / 0.8 = 0.625, at z = 0.318639.
std::vector<Noise> noises() {
    return {{"symmetric", [](Normal& normal) { return 10 + normal(); }, 10},
            {"skewed", [](Normal& normal) { return std::exp(normal()); }, 1},
            {"two modes",
             [](Normal& normal) {
                 const double low = std::exp(0.05 * normal());
                 return normal() < -0.841621 ? 10 * low : low;
             },
             std::exp(0.05 * 0.318639)}};
}

double standard_error(double share, double of) { return std::sqrt(share * (1 - share) / of); }

/// What is said, and what holds: of 3 to 30 rounds the interval holds the true ratio as often as it states, within two
/// standard errors of all rounds together and four of each number of them.
TEST(PairedRatio, IntervalsHoldAsOftenAsTheyState) {
    constexpr int experiments = 4000;
    Normal normal(17);
    for (const Noise& noise : noises()) {
        double said = 0, holds = 0, variance = 0;
        for (std::size_t n = 3; n <= 30; ++n) {
            const Values truth(n, noise.median);
            Values times(n);
            int held = 0;
            Ratio ratio;
            for (int experiment = 0; experiment < experiments; ++experiment) {
                for (double& ms : times) ms = noise.draw(normal);
                ratio = paired_ratio(times, truth);
                held += ratio.has_interval() && ratio.interval.low <= 1 && 1 <= ratio.interval.high;
            }
            EXPECT_EQ(ratio.has_interval(), n >= 6) << n;
            EXPECT_NEAR(held / double(experiments), ratio.coverage, 4 * standard_error(ratio.coverage, experiments))
                << noise.name << ", " << n;
            if (n >= 6) {
                EXPECT_GE(ratio.coverage, 0.95);
            }
            said += ratio.coverage;
            holds += held / double(experiments);
            variance += std::pow(standard_error(ratio.coverage, experiments), 2);
        }
        EXPECT_NEAR(holds, said, 2 * std::sqrt(variance)) << noise.name;
    }
}

/// Two equal programs on a machine that drifts, and a control that is ten times as quiet: of 3 to 30 rounds they are
/// called different at most as often as the intervals miss.
TEST(PairedRatio, EqualProgramsAreSeldomCalledDifferent) {
    constexpr int experiments = 2000;
    Normal normal(8);
    for (const double width : {0.1, 1.0})
        for (const std::size_t n : {3u, 4u, 5u, 6u, 7u, 10u, 20u, 30u}) {
            int alarms = 0;
            Values a(n), b(n), control(n), again(n);
            for (int experiment = 0; experiment < experiments; ++experiment) {
                for (std::size_t i = 0; i < n; ++i) {
                    const double speed = 1 + 0.2 * double(i);
                    const auto time    = [&](double noise) { return speed * std::exp(noise * normal()); };
                    a[i] = time(width), b[i] = time(width);
                    control[i] = time(width / 10), again[i] = time(width / 10);
                }
                alarms += differs(paired_ratio(a, b), noise_bar(paired_ratio(again, control)));
            }
            const double most = 1 - std::max(median_rank(n).coverage, n < 6 ? 1.0 : 0.0);
            EXPECT_LE(alarms / double(experiments), most + 2 * standard_error(most, experiments)) << n;
        }
}

/// Of four and four values 1 of 70 orders has no inversion, of five and five 1, 1 and 2 of 252 have 0, 1 and 2.
TEST(RatioOfSamples, CoverageByHand) {
    const Values four{1, 2, 3, 4}, five{1, 2, 3, 4, 5};
    EXPECT_FALSE(ratio_of_samples(Values{1, 2, 3}, Values{1, 2, 3}).has_interval()) << "1 - 2 / 20 is 90 %";
    const Ratio least = ratio_of_samples(four, four);
    EXPECT_NEAR(least.coverage, 1 - 2.0 / 70, 1e-12);
    EXPECT_EQ(least.interval.low, 0.25);
    EXPECT_EQ(least.interval.high, 4);
    EXPECT_EQ(least.median, 1);
    EXPECT_EQ(least.pairs, 4);
    const Ratio third = ratio_of_samples(five, five);
    EXPECT_NEAR(third.coverage, 1 - 2 * 4.0 / 252, 1e-12);
    EXPECT_EQ(third.interval.low, 1.0 / 3) << "behind 1 / 5 and 1 / 4";
    EXPECT_EQ(third.interval.high, 3);
    EXPECT_NEAR(ratio_of_samples(five, five, 0.975).coverage, 1 - 2 * 2.0 / 252, 1e-12);
    EXPECT_THROW((void)ratio_of_samples(Values{}, four), std::logic_error);
    EXPECT_GE(ratio_of_samples(Values(1000, 2.0), Values(1000, 1.0)).coverage, 0.95);
}

TEST(RatioOfSamples, IntervalsHoldAsOftenAsTheyState) {
    constexpr int experiments = 2000;
    Normal normal(9);
    for (const Noise& noise : noises()) {
        double said = 0, holds = 0, variance = 0;
        for (const std::size_t n : {4u, 5u, 6u, 8u, 12u}) {
            Values a(n), b(n + 1);
            Ratio ratio;
            int held = 0;
            for (int experiment = 0; experiment < experiments; ++experiment) {
                for (double& ms : a) ms = 3 * noise.draw(normal);
                for (double& ms : b) ms = noise.draw(normal);
                ratio = ratio_of_samples(a, b);
                held += ratio.interval.low <= 3 && 3 <= ratio.interval.high;
            }
            EXPECT_GE(ratio.coverage, 0.95);
            said += ratio.coverage, holds += held / double(experiments);
            variance += std::pow(standard_error(ratio.coverage, experiments), 2);
        }
        EXPECT_NEAR(holds, said, 2 * std::sqrt(variance)) << noise.name;
    }
}

TEST(NoiseBar, IsTheFartherBoundOnTheLargerSide) {
    EXPECT_NEAR(noise_bar({1, {0.98, 1.05}, 7}), 0.05, 1e-12);
    EXPECT_NEAR(noise_bar({1, {0.8, 1.05}, 7}), 0.25, 1e-12);
    EXPECT_EQ(noise_bar({1, {1, 1}, 7}), 0);
    EXPECT_EQ(noise_bar({}), kInfinite);
}

TEST(NoiseBar, RanksNothingAboveThirtyPercent) {
    EXPECT_FALSE(is_too_noisy(0.3));
    EXPECT_TRUE(is_too_noisy(0.301));
    EXPECT_TRUE(is_too_noisy(noise_bar({}))) << "of too few rounds";
    EXPECT_TRUE(is_too_noisy(std::numeric_limits<double>::quiet_NaN())) << "unknown";
    EXPECT_TRUE(is_dearer(5.1, 4, 0.25));
    EXPECT_FALSE(is_dearer(5, 4, 0.25));
    EXPECT_FALSE(is_dearer(3, 4, 0));
}

TEST(Differs, NeedsBothTheIntervalAndTheBar) {
    EXPECT_TRUE(differs({1.2, {1.1, 1.3}, 7}, 0.05));
    EXPECT_TRUE(differs({0.5, {0.4, 0.6}, 7}, 0.05));
    EXPECT_FALSE(differs({1.2, {0.9, 1.3}, 7}, 0.05)) << "its interval holds 1";
    EXPECT_FALSE(differs({1.04, {1.02, 1.06}, 7}, 0.05)) << "within the noise bar";
    EXPECT_FALSE(differs({0.96, {0.94, 0.98}, 7}, 0.05)) << "within the noise bar, 1 / 0.96 = 1.042";
    EXPECT_FALSE(differs({}, 0.05));
    EXPECT_FALSE(differs({100, {90, 110}, 7}, noise_bar({}))) << "without a control nothing differs";
}

TEST(PowerLaw, ExactLawIsFound) {
    const Values x{1, 10, 100, 1000};
    Values y;
    for (const double v : x) y.push_back(3 * std::pow(v, 1.5));
    const PowerLaw law = fit_power_law(x, y);
    EXPECT_NEAR(law.exponent, 1.5, 1e-12);
    EXPECT_NEAR(law.factor, 3, 1e-11);
    EXPECT_NEAR(law.r_squared, 1, 1e-12);
    EXPECT_NEAR(law.exponent_interval.low, 1.5, 1e-6);
    EXPECT_NEAR(law.exponent_interval.high, 1.5, 1e-6);
    EXPECT_NEAR(law.at(50), 3 * std::pow(50, 1.5), 1e-9);
    EXPECT_EQ(law.points, 4);
}

/// log2 x = 0, 1, 2 and log2 y = 0, 1, 0.5: the slope is 1/4 and the residuals are -1/4, 1/2, -1/4, so that their
/// variance is 3/8 over one degree of freedom and the slope's error sqrt(3/8 / 2) = 0.4330. The table of Student's t
/// has 12.706 for one degree at 95 %.
TEST(PowerLaw, IntervalByHand) {
    const PowerLaw law = fit_power_law(Values{1, 2, 4}, Values{1, 2, std::sqrt(2)});
    EXPECT_NEAR(law.exponent, 0.25, 1e-12);
    EXPECT_NEAR(law.exponent_interval.high - law.exponent, 12.706 * std::sqrt(3.0 / 16), 1e-3);
    EXPECT_NEAR(law.exponent - law.exponent_interval.low, 12.706 * std::sqrt(3.0 / 16), 1e-3);
    EXPECT_NEAR(law.r_squared, 0.25, 1e-12) << "of the sum of squares 1/2, 3/8 remains";
}

TEST(PowerLaw, WhatCannotBeFitted) {
    EXPECT_EQ(fit_power_law(Values{1, 2}, Values{1, 2}).exponent_interval.high, kInfinite);
    EXPECT_THROW((void)fit_power_law(Values{1}, Values{1}), std::logic_error);
    EXPECT_THROW((void)fit_power_law(Values{1, 2}, Values{1}), std::logic_error);
    EXPECT_THROW((void)fit_power_law(Values{2, 2}, Values{1, 2}), std::logic_error);
    EXPECT_THROW((void)fit_power_law(Values{1, 2}, Values{0, 2}), std::logic_error);
    EXPECT_THROW((void)fit_power_law(Values{1, kNotANumber}, Values{1, 2}), std::logic_error);
}

/// 100 x^0.5 and x meet at 10^4.
TEST(Crossing, OfExactLaws) {
    const Values x{10, 100, 1000};
    Values slow, fast;
    for (const double v : x) {
        slow.push_back(v);
        fast.push_back(100 * std::sqrt(v));
    }
    const auto meeting = crossing(fit_power_law(x, slow), fit_power_law(x, fast));
    ASSERT_TRUE(meeting);
    EXPECT_NEAR(meeting->x, 1e4, 1e-6);
    EXPECT_NEAR(meeting->interval.low, 1e4, 1);
    EXPECT_NEAR(meeting->interval.high, 1e4, 1);
    EXPECT_FALSE(crossing(fit_power_law(x, slow), fit_power_law(x, slow))) << "parallel";
}

/// The interval of a crossing, here far beyond the measured sizes, holds the truth in 95 % of 400 experiments; its
/// degrees of freedom are the smaller fit's, which makes it wider than need be: 94 to 100 % (one standard deviation
/// is 1.1 %).
TEST(Crossing, IntervalCoversTheTruth) {
    Normal normal(11);
    const Values x{10, 30, 100, 300, 1000, 3000};
    int holds = 0, bounded = 0;
    for (int experiment = 0; experiment < 400; ++experiment) {
        Values a, b;
        for (const double v : x) {
            a.push_back(v * std::exp(0.1 * normal()));
            b.push_back(200 * std::sqrt(v) * std::exp(0.1 * normal()));
        }
        const auto meeting = crossing(fit_power_law(x, a), fit_power_law(x, b));  // at 40,000
        ASSERT_TRUE(meeting);
        holds += meeting->interval.low <= 4e4 && 4e4 <= meeting->interval.high;
        bounded += meeting->interval.high < 1e7;
    }
    EXPECT_GE(holds, 376);
    EXPECT_EQ(bounded, 400);
}

/// At both bounds the lines differ by 2.7764 standard errors: Student's t of four degrees of freedom, from the table.
TEST(Crossing, BoundsAreWhereTheDifferenceIsItsError) {
    const Values x{10, 30, 100, 300, 1000, 3000};
    const PowerLaw a   = fit_power_law(x, Values{11, 28, 104, 310, 950, 3100});
    const PowerLaw b   = fit_power_law(x, Values{650, 1050, 2100, 3300, 6600, 10400});
    const auto meeting = crossing(a, b);
    ASSERT_TRUE(meeting);
    EXPECT_LT(meeting->interval.low, meeting->x);
    EXPECT_GT(meeting->interval.high, meeting->x);
    for (const double bound : {meeting->interval.low, meeting->interval.high}) {
        double variance = 0;
        for (const PowerLaw& law : {a, b}) {
            const double off = std::log(bound) - law.log_x_mean;
            variance += law.residual_variance * (1.0 / 6 + off * off / law.log_x_spread);
        }
        EXPECT_NEAR(std::abs(std::log(a.at(bound) / b.at(bound))) / std::sqrt(variance), 2.7764, 1e-4);
    }
}

/// Exponents that do not differ cross nowhere that can be said.
TEST(Crossing, IsUnboundedWhereTheExponentsDoNotDiffer) {
    const Values x{1, 2, 4, 8};
    const auto meeting =
        crossing(fit_power_law(x, Values{1, 2.4, 3.5, 9}), fit_power_law(x, Values{1.2, 2.1, 4.4, 8.5}));
    ASSERT_TRUE(meeting);
    EXPECT_EQ(meeting->interval.low, 0);
    EXPECT_EQ(meeting->interval.high, kInfinite);
}

using Front = std::vector<std::size_t>;

TEST(Pareto, FrontByHand) {
    const std::vector<CostError> points{{5, 0.1}, {1, 0.9}, {3, 0.3}, {4, 0.3}, {2, 0.95}, {9, 0}, {10, 0}};
    EXPECT_EQ(pareto_front(points), (Front{1, 2, 0, 5}));
}

TEST(Pareto, TiesStayAndWhatIsNotFiniteGoes) {
    const std::vector<CostError> points{{2, 0.5}, {1, 1}, {2, 0.5}, {kNotANumber, 0}, {0.5, kInfinite}, {1, 2}};
    EXPECT_EQ(pareto_front(points), (Front{1, 0, 2}));
    EXPECT_TRUE(pareto_front({}).empty());
}

/// The definition, asked of every pair.
TEST(Pareto, AgreesWithTheDefinition) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        std::vector<CostError> points;
        for (std::uint64_t i = 0; i < 40; ++i)  // few values, so that there are ties of all kinds
            points.push_back({static_cast<double>(mixed_bits(seed * 1000 + i) % 8),
                              static_cast<double>(mixed_bits(seed * 1000 + i + 500) % 8)});
        Front wanted;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (std::none_of(points.begin(), points.end(), [&](const CostError& p) {
                    return p.cost <= points[i].cost && p.error <= points[i].error &&
                           (p.cost < points[i].cost || p.error < points[i].error);
                }))
                wanted.push_back(i);
        Front found = pareto_front(points);
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end(),
                                   [&](std::size_t a, std::size_t b) { return points[a].cost < points[b].cost; }));
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, wanted) << seed;
    }
}

TEST(Profile, GeometricMean) {
    EXPECT_NEAR(geometric_mean(Values{1, 4, 16}), 4, 1e-12);
    EXPECT_NEAR(geometric_mean(Values{0.5, 2}), 1, 1e-12) << "half and twice cancel; the arithmetic mean says 1.25";
    EXPECT_EQ(geometric_mean(Values{1, kInfinite}), kInfinite);
    EXPECT_THROW((void)geometric_mean(Values{}), std::logic_error);
    EXPECT_THROW((void)geometric_mean(Values{1, 0}), std::logic_error);
}

/// Three problems, of which the second solver leaves one unsolved; nobody solves the fourth.
TEST(Profile, PerformanceProfileByHand) {
    const PerformanceProfile profile({{1, 6, 4, kNotANumber}, {2, 3, kInfinite, kNotANumber}});
    EXPECT_EQ(profile.problems(), 3u);
    EXPECT_EQ(profile.ratios(0), (Values{1, 1, 2}));
    EXPECT_EQ(profile.ratios(1), (Values{1, 2, kInfinite}));
    EXPECT_DOUBLE_EQ(profile.fraction(0, 1), 2.0 / 3);
    EXPECT_DOUBLE_EQ(profile.fraction(0, 2), 1);
    EXPECT_DOUBLE_EQ(profile.fraction(1, 1.99), 1.0 / 3);
    EXPECT_DOUBLE_EQ(profile.fraction(1, 1e300), 2.0 / 3);
    EXPECT_THROW(PerformanceProfile({{1, 2}, {1}}), std::logic_error);
    EXPECT_THROW(PerformanceProfile({{1, 0}}), std::logic_error);
}

}  // namespace
}  // namespace umbra
