// Lanes: numbers that one instruction takes together.
#pragma once

#include <cstddef>

namespace umbra {

inline constexpr std::size_t kLanes = 8;

/// N numbers with the operators of one: + - * /, comparisons (all bits of a lane, or none, in integers as wide as T),
/// & | ~ of integers, `mask ? a : b`, [k]. A scalar operand is that of all lanes. N: a power of two.
template <class T, std::size_t N = kLanes>
using Lanes [[gnu::vector_size(N * sizeof(T))]] = T;

}  // namespace umbra
