// Noise and bias of a sampling method, separated by several runs.
#pragma once

#include <vector>

#include "umbra/core/errors/error_classes.h"

namespace umbra {

/// Root mean squares over the points, so that the expected squared error of one run is noise^2 + bias^2.
struct Noise {
    int runs    = 0;
    double rms  = 0;  ///< of one run about its own mean: sqrt of the mean variance, unbiased
    double bias = 0;  ///< of the mean of infinitely many runs against the reference
};

/// Takes the planes of runs that differ in nothing but their random numbers.
class NoiseMeter {
public:
    explicit NoiseMeter(std::size_t points) : mean_(points, 0.0), squares_(points, 0.0) {}

    void add(const std::vector<float>& s);

    /// Interior errors, `false_shadow`, `false_light` or `penumbra`, become `noise` where the mean of the runs is
    /// within `tolerance` and the reference's half width of the reference: random numbers made them. The mean of K runs
    /// is itself uncertain by noise / sqrt(K), so of strong noise a part stays in its class. At least one run.
    void mark(ClassPlane& classes, const VisibilityPlane& reference, float tolerance) const;

    /// Over the points that both planes define. For the mean M of K runs, (M - reference)^2 is expected to be bias^2 +
    /// variance / K; the second is subtracted with the variance found, and the rest is at least 0. So over n
    /// points, a bias below about noise / sqrt(K) (2 / n)^(1/4) cannot be distinguished from none. At least two runs.
    [[nodiscard]] Noise result(const ClassPlane& classes, const VisibilityPlane& reference) const;

private:
    int runs_ = 0;
    std::vector<double> mean_, squares_;  ///< of each point, and of its differences from that mean
};

}  // namespace umbra
