// The power of a cosine that gives a specular lobe its width.
#pragma once

#include <cmath>
#include <cstdint>

namespace umbra {

/// Whether lobe_power multiplies: n is a whole number that is not large.
[[nodiscard]] inline bool is_whole_power(float n) { return n >= 0 && n <= 4096 && n == std::floor(n); }

/// x^n of `lanes` numbers in [0, 1], n a whole power: by squaring, off by at most 2 n roundings of a double. 0^0 is 1.
template <int lanes>
void whole_power(double* x, float n) {
    double base[lanes];
    for (int k = 0; k < lanes; ++k) base[k] = x[k], x[k] = 1;
    for (auto rest = static_cast<std::uint32_t>(n); rest != 0; rest >>= 1) {
        if ((rest & 1) != 0)
            for (int k = 0; k < lanes; ++k) x[k] *= base[k];
        for (int k = 0; k < lanes; ++k) base[k] *= base[k];
    }
}

/// x^n, x in [0, 1], n >= 0: whole_power where n is one, which takes a fraction of the time of std::pow.
[[nodiscard]] inline double lobe_power(double x, float n) {
    if (!is_whole_power(n)) return std::pow(x, static_cast<double>(n));
    whole_power<1>(&x, n);
    return x;
}

}  // namespace umbra
