// Kernels of percentage-closer filtering: which samples of a map are compared with a point, and their weights.
//
// William Reeves, David Salesin, Robert Cook. Rendering Antialiased Shadows with Depth Maps. 1987
// Ignacio Castano. Shadow Mapping Summary, Part 1. 2013 (castano3, castano5, castano7)
// Helmut Vogel. A Better Way to Construct the Sunflower Head. 1979 (disc)
// Jorge Jimenez. Next Generation Post Processing in Call of Duty: Advanced Warfare. 2014 (gradient noise)
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// Castano's kernels are products of two profiles: 1 2 1, 1 3 4 3 1, 1 5 12 16 12 5 1. Between two samples the profile
/// is the linear mean of itself in both places. Graphics hardware takes 4, 9 or 16 bilinear comparisons for them, with
/// weights whose sums are 16, 144, 2704.
enum class Kernel : std::uint8_t {
    grid,  ///< all samples of a square alike
    disc,  ///< the samples at points spread evenly over a disk
    castano3,
    castano5,
    castano7
};

/// By what angle the points of a disc are rotated about the receiver.
enum class Rotation : std::uint8_t {
    none,
    noise,    ///< one that its position in the map decides, evenly distributed, and no two alike
    gradient  ///< one that its pixel decides: those of any 3 x 3 pixels are spread over the full turn
};

inline constexpr double kCastanoThree[] = {1, 2, 1}, kCastanoFive[] = {1, 3, 4, 3, 1},
                        kCastanoSeven[] = {1, 5, 12, 16, 12, 5, 1};

/// The profile of one of Castano's kernels; of the others none.
[[nodiscard]] constexpr std::span<const double> profile(Kernel kernel) {
    switch (kernel) {
        case Kernel::castano3: return kCastanoThree;
        case Kernel::castano5: return kCastanoFive;
        case Kernel::castano7: return kCastanoSeven;
        case Kernel::grid:
        case Kernel::disc: break;
    }
    return {};
}

/// The reach of a kernel's samples from its middle: Castano's have their own, the others `radius`.
[[nodiscard]] constexpr int kernel_radius(Kernel kernel, int radius) {
    const int samples = static_cast<int>(profile(kernel).size());
    return samples > 0 ? samples / 2 : radius;
}

struct Filter {
    int radius    = 0;      ///< kernel_radius; grid: (2 radius + 1)^2 samples; disc: of radius + 1/2 samples
    bool bilinear = false;  ///< grid: the square moves with the point, its border samples count by how much
                            ///< of them it covers; disc: a comparison is the bilinear mean of four
    Kernel kernel = Kernel::grid;
    std::span<const dvec2> points{};  ///< of disc, in the unit disk

    /// Only the sample is asked that the point lies in.
    [[nodiscard]] bool is_one_sample() const { return kernel == Kernel::grid && radius == 0 && !bilinear; }
};

/// n points spread evenly over the unit disk.
[[nodiscard]] std::vector<dvec2> even_disk(int n);

/// The cosine and sine of Rotation::noise for a position in a map, in samples.
[[nodiscard]] dvec2 noise_turn(double x, double y);

/// The cosine and sine of Rotation::gradient for a pixel.
[[nodiscard]] dvec2 gradient_turn(double x, double y);

/// q turned about the origin by an angle of this cosine and sine.
[[nodiscard]] inline dvec2 turned(dvec2 q, dvec2 turn) {
    return {turn.x * q.x - turn.y * q.y, turn.y * q.x + turn.x * q.y};
}

/// The samples of a kernel that is a square and not too wide: x + i, y + j for i, j < side, of weight
/// across[i] * down[j].
struct SquareKernel {
    static constexpr int kMostRadius = 16;
    static constexpr int kMostInRow  = 36;  ///< at least 2 kMostRadius + 2, in fours
    int x = 0, y = 0, side = 0;
    double across[kMostInRow], down[kMostInRow];
    double whole = 0;  ///< sum of the weights
};

/// The samples of a filter other than a disc about `at`, in samples; its radius is at most kMostRadius.
inline SquareKernel square_kernel(dvec2 at, const Filter& filter) {
    const auto below = [](double v) { return static_cast<int>(std::floor(v)); };
    const int radius = filter.radius;
    SquareKernel square;
    if (filter.kernel == Kernel::grid && !filter.bilinear) {
        square.x = below(at.x) - radius, square.y = below(at.y) - radius;
        square.side = 2 * radius + 1;
        for (int k = 0; k < square.side; ++k) square.across[k] = square.down[k] = 1;
        square.whole = square.side * square.side;
        return square;
    }
    const std::span<const double> heights = profile(filter.kernel);
    const int last                        = 2 * radius + 1;
    // The weight of sample k of a row, where the kernel lies `part` of a sample beyond its own samples.
    const auto weight = [&](int k, double part) {
        const auto height  = [&](int at_k) { return heights.empty() ? 1 : heights[static_cast<std::size_t>(at_k)]; };
        const double here  = k < last ? height(k) : 0;
        const double there = k > 0 ? height(k - 1) : 0;
        return here + part * (there - here);
    };
    const int x = below(at.x - 0.5), y = below(at.y - 0.5);
    const double fx = at.x - 0.5 - x, fy = at.y - 0.5 - y;
    square.x = x - radius, square.y = y - radius;
    square.side = last + 1;
    for (int k = 0; k <= last; ++k) square.across[k] = weight(k, fx), square.down[k] = weight(k, fy);
    double sum = heights.empty() ? last : 0;
    for (const double height : heights) sum += height;
    square.whole = sum * sum;
    return square;
}

/// Calls body(i, j, weight) for each sample that the filter asks for about `at`, in samples, with a disc turned by
/// `turn`. Samples may lie outside the map, and those of a disc come several times. Returns the sum of the weights.
template <class Body>
double for_each_sample(dvec2 at, dvec2 turn, const Filter& filter, const Body& body) {
    if (filter.kernel == Kernel::grid && filter.radius > SquareKernel::kMostRadius) {
        // Weights differ in its border alone.
        const dvec2 from = glm::floor(filter.bilinear ? at - 0.5 : at), part = at - 0.5 - from;
        const int side    = 2 * filter.radius + (filter.bilinear ? 2 : 1);
        const auto weight = [&](int k, double of) {
            return !filter.bilinear ? 1.0 : k == 0 ? 1 - of : k == side - 1 ? of : 1.0;
        };
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i)
                body(static_cast<int>(from.x) - filter.radius + i, static_cast<int>(from.y) - filter.radius + j,
                     weight(i, part.x) * weight(j, part.y));
        const double width = 2 * filter.radius + 1;
        return width * width;
    }
    if (filter.kernel != Kernel::disc) {
        const SquareKernel square = square_kernel(at, filter);
        for (int j = 0; j < square.side; ++j)
            for (int i = 0; i < square.side; ++i) body(square.x + i, square.y + j, square.across[i] * square.down[j]);
        return square.whole;
    }
    const auto below    = [](double v) { return static_cast<int>(std::floor(v)); };
    const double radius = filter.radius + 0.5;
    for (const dvec2 point : filter.points) {
        const dvec2 q = at + radius * turned(point, turn);
        if (!filter.bilinear) {
            body(below(q.x), below(q.y), 1.0);
            continue;
        }
        const int x = below(q.x - 0.5), y = below(q.y - 0.5);
        const double fx = q.x - 0.5 - x, fy = q.y - 0.5 - y;
        body(x, y, (1 - fx) * (1 - fy));
        body(x + 1, y, fx * (1 - fy));
        body(x, y + 1, (1 - fx) * fy);
        body(x + 1, y + 1, fx * fy);
    }
    return static_cast<double>(filter.points.size());
}

}  // namespace umbra
