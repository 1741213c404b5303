// Many problems in one figure: the geometric mean, and the performance profile.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace umbra {

/// Throws std::logic_error where there is none, or one is not positive. Infinity where one is infinite.
[[nodiscard]] double geometric_mean(std::span<const double> values);

/// For each solver, in which fraction of the problems its cost is within a factor of the best solver's.
/// [Elizabeth Dolan, Jorge More, Benchmarking Optimization Software with Performance Profiles, 2002]
class PerformanceProfile {
public:
    /// `costs[solver][problem]`: positive; NaN or infinite where the solver does not solve the problem. Problems that
    /// no solver solves are left out. Throws std::logic_error where the solvers' lengths differ or a cost is not
    /// positive.
    explicit PerformanceProfile(const std::vector<std::vector<double>>& costs);

    [[nodiscard]] std::size_t problems() const { return problems_; }
    /// To the best solver of each problem, ascending; infinite where it does not solve it.
    [[nodiscard]] const std::vector<double>& ratios(std::size_t solver) const { return ratios_[solver]; }
    /// Fraction of the problems, [0, 1], that `solver` solves within `factor` (at least 1) of the best; 0 without any.
    [[nodiscard]] double fraction(std::size_t solver, double factor) const;

private:
    std::vector<std::vector<double>> ratios_;  ///< [solver]
    std::size_t problems_ = 0;
};

}  // namespace umbra
