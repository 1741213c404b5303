// Well mixed bits out of a counter or an index.
#pragma once

#include <cstdint>

namespace umbra {

/// A bijection of 64-bit numbers whose results for 0, 1, 2, ... pass for random: the step and finaliser of SplitMix64.
/// [Guy Steele, Doug Lea, Christine Flood, Fast Splittable Pseudorandom Number Generators, 2014; Sebastiano Vigna's
/// constants]
[[nodiscard]] constexpr std::uint64_t mixed_bits(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

}  // namespace umbra
