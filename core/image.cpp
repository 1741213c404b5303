#include "core/image.h"

#include <cmath>

namespace umbra {

// In double: 1.055f - 0.055f falls short of 1, and white must be white.

float srgb_from_linear(float x) {
    const double v = std::abs(double(x));
    return std::copysign(float(v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055), x);
}

float linear_from_srgb(float x) {
    const double v = std::abs(double(x));
    return std::copysign(float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)), x);
}

}  // namespace umbra
