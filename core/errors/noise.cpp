#include "umbra/core/errors/noise.h"

#include <algorithm>
#include <cmath>

namespace umbra {

/// One pass, without the cancellation of sums of squares [B. P. Welford, Note on a Method for Calculating Corrected
/// Sums of Squares and Products, 1962].
void NoiseMeter::add(const std::vector<float>& s) {
    ++runs_;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        const double off = static_cast<double>(s[i]) - mean_[i];
        mean_[i] += off / runs_;
        squares_[i] += off * (static_cast<double>(s[i]) - mean_[i]);
    }
}

Noise NoiseMeter::result(const ClassPlane& classes, const VisibilityPlane& reference) const {
    double variance = 0, squared = 0, points = 0;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        if (!is_compared(classes[i])) continue;
        const double off = mean_[i] - static_cast<double>(reference.s[i]);
        variance += squares_[i] / (runs_ - 1);
        squared += off * off;
        ++points;
    }
    if (points == 0) return {runs_, 0, 0};
    return {runs_, std::sqrt(variance / points), std::sqrt(std::max(0.0, (squared - variance / runs_) / points))};
}

}  // namespace umbra
