// Times of methods over one family of growing scenes, the power laws that they follow, and where two of them cross.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/power_law.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/bench/studies/motion/growth_family.h"
#include "umbra/bench/studies/motion/growth_theory.h"

namespace umbra {

struct GrowthOptions {
    TurnOptions turns{.rounds = 6, .budget_ms = 8000};  ///< at each size
    double longest_ms = 10000;  ///< a method whose phases take longer together is left out of larger sizes
    std::function<void(const std::string&)> progress{};  ///< may be empty
};

/// One method at one size.
struct GrowthPoint {
    double x = 0;
    TurnTimes times;
    double noise_bar = 0;
};

/// One method over the sizes that it ran at.
struct GrowthSeries {
    MethodChoice choice;  ///< without the parameter that grows
    std::vector<GrowthPoint> points{};
    std::string left_out{};  ///< why it has no points, or none beyond its last; empty: it has them all

    /// Milliseconds of what a quantity stands for, one a round.
    [[nodiscard]] static std::vector<double> rounds(const GrowthPoint& point, Quantity quantity);
};

struct GrowthRun {
    const GrowthFamily* family = nullptr;
    std::vector<double> sizes;
    std::vector<GrowthSeries> series;
};

/// Sizes up to `up_to`. Each method runs at each size in turns with the others. Throws what the family throws.
[[nodiscard]] GrowthRun run_growth(const GrowthFamily& family, const std::vector<MethodChoice>& choices, double up_to,
                                   const GrowthOptions& options);

/// A power law through the least times of the rounds, which other programs on the machine distort least, at the largest
/// sizes: those from a hundredth of the largest on, where the time is at least kShortest; memory likewise, in bytes.
/// Nothing for fewer than three points.
[[nodiscard]] std::optional<PowerLaw> fit_growth(const GrowthSeries& series, Quantity quantity);
/// Below this, milliseconds, clocks and waking threads are measured.
inline constexpr double kShortest = 0.05;

}  // namespace umbra
