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

void NoiseMeter::mark(ClassPlane& classes, const VisibilityPlane& reference, float tolerance) const {
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        const ErrorClass c = classes[i];
        if (c != ErrorClass::false_shadow && c != ErrorClass::false_light && c != ErrorClass::penumbra) continue;
        const double allowed = static_cast<double>(tolerance) + static_cast<double>(reference.half_width[i]);
        if (std::abs(mean_[i] - static_cast<double>(reference.s[i])) <= allowed) classes[i] = ErrorClass::noise;
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
