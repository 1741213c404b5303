#include "umbra/bench/base/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace umbra {

double geometric_mean(std::span<const double> values) {
    if (values.empty()) throw std::logic_error("geometric mean of no values");
    double sum = 0;
    for (const double v : values) {
        if (!(v > 0)) throw std::logic_error("geometric mean of a value that is not positive");
        sum += std::log(v);
    }
    return std::exp(sum / static_cast<double>(values.size()));
}

PerformanceProfile::PerformanceProfile(const std::vector<std::vector<double>>& costs) : ratios_(costs.size()) {
    const std::size_t all = costs.empty() ? 0 : costs[0].size();
    for (const auto& solver : costs)
        if (solver.size() != all) throw std::logic_error("solvers of different numbers of problems");
    for (std::size_t p = 0; p < all; ++p) {
        double best = std::numeric_limits<double>::infinity();
        for (const auto& solver : costs) {
            if (solver[p] <= 0) throw std::logic_error("a cost that is not positive");
            if (solver[p] < best) best = solver[p];
        }
        if (!std::isfinite(best)) continue;
        ++problems_;
        for (std::size_t s = 0; s < costs.size(); ++s)
            ratios_[s].push_back(std::isfinite(costs[s][p]) ? costs[s][p] / best
                                                            : std::numeric_limits<double>::infinity());
    }
    for (auto& of : ratios_) std::sort(of.begin(), of.end());
}

double PerformanceProfile::fraction(std::size_t solver, double factor) const {
    const std::vector<double>& of = ratios_[solver];
    if (of.empty()) return 0;
    const auto within = std::upper_bound(of.begin(), of.end(), factor) - of.begin();
    return static_cast<double>(within) / static_cast<double>(of.size());
}

}  // namespace umbra
