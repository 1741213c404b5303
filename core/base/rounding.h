// Magnitudes that bounds of rounding are stated in.
#pragma once

#include <cmath>

#include "umbra/core/base/math.h"

namespace umbra {

inline double sum_of_magnitudes(double x, double y, double z) { return std::abs(x) + std::abs(y) + std::abs(z); }
inline double sum_of_magnitudes(dvec3 v) { return sum_of_magnitudes(v.x, v.y, v.z); }

}  // namespace umbra
