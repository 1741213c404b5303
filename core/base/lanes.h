// Lanes: numbers that one instruction takes together, and functions that use the widest instructions of the processor.
#pragma once

#include <cstddef>

namespace umbra {

inline constexpr int kLanes = 8;

/// N numbers with the operators of one: + - * /, comparisons (all bits of a lane, or none, in integers as wide as T),
/// & | ~ of integers, `mask ? a : b`, [k]. A scalar operand is that of all lanes. N: a power of two.
template <class T, std::size_t N = kLanes>
using Lanes [[gnu::vector_size(N * sizeof(T))]] = T;

/// The same for loops that compilers make vector code of: for doubles, where eight are more than most registers hold.
/// They need "unroll 1" where g++ would unroll the short loop first, and a loop should load the vectors that the one
/// before it stored: numbers that are stored one by one make such a load wait.
template <class T, std::size_t N = kLanes>
using LaneArray = T[N];

/// Lanes of doubles to the nearest whole numbers; numbers below 2^51. By reference: processors differ in how they pass
/// and return lanes.
template <class Doubles>
void round_lanes(const Doubles& v, Doubles& whole) {
    constexpr double kShift = 0x1.8p52;
    whole                   = (v + kShift) - kShift;
}

}  // namespace umbra

/// Before the definition of a function: it is compiled twice, with all that it calls and whose definition is seen, for
/// every processor of the architecture and for those with AVX2, of which the loader takes one when the program starts.
/// Same bits: multiplications and additions are not contracted. With -mavx2, under sanitizers and with other compilers
/// than GCC there is one version, which the compiler's options choose.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__) && defined(__OPTIMIZE__)
#define UMBRA_FOR_EACH_PROCESSOR [[gnu::target_clones("default", "arch=x86-64-v3"), gnu::flatten]]
#else
#define UMBRA_FOR_EACH_PROCESSOR
#endif
