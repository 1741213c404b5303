// Lafortune's lobes fitted to samples of a reflectance, measured or generated.
//
// This work is based on:
// Eric Lafortune, Sing-Choong Foo, Kenneth Torrance, Donald Greenberg. Non-Linear Approximation of Reflectance
// Functions. 1997
// Donald Marquardt. An Algorithm for Least-Squares Estimation of Nonlinear Parameters. 1963
#pragma once

#include <span>

#include "umbra/core/scene/materials.h"

namespace umbra {

/// What a surface sends of a light with I_j = 1 (see `reflected`), per channel. Directions are unit, in the frame of
/// LafortuneLobe, z > 0.
struct ReflectanceSample {
    dvec3 l{0, 0, 1}, v{0, 0, 1};
    dvec3 value{0};
};

struct LafortuneFit {
    Material material;   ///< k_d, O_d = 1, k_s = 0, and the lobes; tangent (1, 0, 0)
    double rms     = 0;  ///< root mean square of the differences, over samples and channels
    bool converged = false;
};

/// The 3 + 13 n parameters of n lobes, k_d and of each lobe k_s, C and the exponent, by least squares from a fixed
/// start: mirroring lobes of exponents 4, 16, 64 and so on. A local minimum: with more lobes than the samples have,
/// some are of no use. Throws std::invalid_argument for fewer numbers in the samples than parameters, or lobes outside
/// 0 to 8.
[[nodiscard]] LafortuneFit fit_lafortune(std::span<const ReflectanceSample> samples, int lobes);

}  // namespace umbra
