#include "umbra/core/errors/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// The penumbra whose S is known, and a method's answers to it with 8 seeds, plus `offset`.
struct Measured {
    Noise noise;
    double predicted;  ///< of independent samples: sqrt of the mean of S (1 - S) / N
};
Measured measure(const std::string& method, int samples, float offset) {
    static const KnownScene known      = known_scene("penumbra_of_half_plane");
    static const PointBatch points     = primary(known.scene);
    static const VisibilityPlane truth = by_formula(known, points, 0);
    NoiseMeter meter(points.size());
    ClassPlane classes;
    for (int seed = 1; seed <= 8; ++seed) {
        MethodCase run(method + ",samples=" + std::to_string(samples) + ",seed=" + std::to_string(seed), known.scene);
        run.prepare(0);
        VisibilityPlane s = run.visibility(points, 0);
        for (float& v : s.s) v += offset;
        meter.add(s.s);
        classes = error_classes(points, 0, s, truth, kAreaTolerance);
    }
    double variance = 0, n = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (is_compared(classes[i])) variance += truth.s[i] * (1 - truth.s[i]) / static_cast<float>(samples), ++n;
    return {meter.result(classes, truth), std::sqrt(variance / n)};
}

TEST(Noise, OfRandomSamplesIsThatOfTheBinomialDistribution) {
    for (const int samples : {4, 16, 64}) {
        const Measured m = measure("ray_traced:sampler=random", samples, 0);
        EXPECT_EQ(m.noise.runs, 8);
        EXPECT_NEAR(m.noise.rms, m.predicted, 0.03 * m.predicted) << samples;
        EXPECT_LT(m.noise.bias, 0.15 * m.noise.rms) << samples;
    }
}

TEST(Noise, ABiasIsFoundBeneathNoiseOfItsOwnSize) {
    const Measured plain = measure("ray_traced:sampler=random", 16, 0),
                   off   = measure("ray_traced:sampler=random", 16, 0.05f);
    EXPECT_GT(plain.noise.rms, 0.03);
    EXPECT_NEAR(off.noise.bias, 0.05, 0.002);
    EXPECT_NEAR(off.noise.rms, plain.noise.rms, 1e-6) << "an offset is no noise";
}

TEST(Noise, BetterSamplersHaveLessOfItAndNoBiasEither) {
    const Measured random = measure("ray_traced:sampler=random", 16, 0),
                   sobol  = measure("ray_traced:sampler=sobol", 16, 0);
    EXPECT_LT(sobol.noise.rms, 0.6 * random.noise.rms);
    EXPECT_LT(sobol.noise.bias, 0.003);
}

TEST(Noise, EqualRunsHaveNone) {
    NoiseMeter meter(2);
    for (int run = 0; run < 3; ++run) meter.add({0.3f, 0.7f});
    VisibilityPlane truth(2);
    truth.s         = {0.2f, 0.5f};
    const Noise one = meter.result({ErrorClass::right, ErrorClass::undefined}, truth);
    EXPECT_EQ(one.rms, 0);
    EXPECT_NEAR(one.bias, 0.1, 1e-7);
    EXPECT_EQ(meter.result({ErrorClass::away, ErrorClass::undefined}, truth).bias, 0);
}

}  // namespace
}  // namespace umbra
