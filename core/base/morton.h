// The Morton curve: an order of the cells of a grid, of squares or of cubes, in which neighbours are mostly near each
// other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace umbra {

/// Bit k of x becomes bit 2 k of the result; the bits between are 0.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint32_t x) {
    std::uint64_t b = x;
    b               = (b | b << 16) & 0x0000ffff0000ffffu;
    b               = (b | b << 8) & 0x00ff00ff00ff00ffu;
    b               = (b | b << 4) & 0x0f0f0f0f0f0f0f0fu;
    b               = (b | b << 2) & 0x3333333333333333u;
    return (b | b << 1) & 0x5555555555555555u;
}

/// Index of cell (x, y) on the curve: the bits of both in turn, x's lowest bit first. Cells below 2^16 give less than
/// 2^32. [G. M. Morton, A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing, 1966]
[[nodiscard]] constexpr std::uint64_t morton_code(std::uint32_t x, std::uint32_t y) {
    return spread_bits(x) | spread_bits(y) << 1;
}

struct MortonCell {
    std::uint8_t x = 0, y = 0;
};
/// The cells of a square in the order of the curve. kSide: cells along a side, a power of two, at most 256.
template <std::size_t kSide>
inline constexpr auto kMortonSquare = [] {
    std::array<MortonCell, kSide * kSide> cells;
    for (std::uint32_t y = 0; y < kSide; ++y)
        for (std::uint32_t x = 0; x < kSide; ++x)
            cells[morton_code(x, y)] = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)};
    return cells;
}();

/// Bit k of x, of the lowest 16, becomes bit 3 k of the result; the bits between are 0.
[[nodiscard]] constexpr std::uint64_t spread_bits_by_three(std::uint32_t x) {
    std::uint64_t b = x & 0xffffu;
    b               = (b | b << 16) & 0x0000ff0000ffu;
    b               = (b | b << 8) & 0x00f00f00f00fu;
    b               = (b | b << 4) & 0x0c30c30c30c3u;
    return (b | b << 2) & 0x249249249249u;
}

/// The same for cell (x, y, z) of a grid of cubes. Cells below 2^n give less than 2^(3 n), for n up to 16.
[[nodiscard]] constexpr std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return spread_bits_by_three(x) | spread_bits_by_three(y) << 1 | spread_bits_by_three(z) << 2;
}

}  // namespace umbra
