// Four numbers at a time, in the compiler's vectors. They are handed on by reference: without AVX, their calling
// convention is not settled.
#pragma once

#include <cstdint>

namespace umbra {

inline constexpr int kFour = 4;
using FourDoubles          = double __attribute__((vector_size(kFour * sizeof(double))));
using FourFloats           = float __attribute__((vector_size(kFour * sizeof(float))));
using FourWords            = std::uint32_t __attribute__((vector_size(kFour * sizeof(std::uint32_t))));
using FourInts             = std::int32_t __attribute__((vector_size(kFour * sizeof(std::int32_t))));
using FourMasks            = std::int64_t __attribute__((vector_size(kFour * sizeof(double))));  ///< all bits, or none

/// To the nearest whole numbers, of numbers below 2^51.
inline void round_four(const FourDoubles& v, FourDoubles& whole) {
    constexpr double kShift = 0x1.8p52;
    whole                   = (v + kShift) - kShift;
}

}  // namespace umbra
