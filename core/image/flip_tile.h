// FLIP of a part of two pictures: the filters and the two pipelines of the 2020 paper, over planes of one channel each,
// in loops that compilers turn into vector code.
//
// This work is based on:
// Pontus Andersson, Jim Nilsson, Tomas Akenine-Moeller, Magnus Oskarsson, Kalle Astroem, Mark Fairchild. FLIP: A
//   Difference Evaluator for Alternating Images. 2020
// Xuemei Zhang, Brian Wandell. A Spatial Extension of CIELAB for Digital Color Image Reproduction. 1997
// Saeedeh Abasi, Mohammad Amani Tehran, Mark Fairchild. Distance Metrics for Very Large Color Differences. 2019
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace umbra::flip {

using Kernel = std::vector<float>;  ///< of odd length, centred

/// All filters are a pass along rows and one along columns.
struct Filters {
    explicit Filters(double pixels_per_degree);

    /// The contrast sensitivity of the eye, a low pass for each channel: Y, Cx, and the two terms of Cz.
    struct Pass {
        Kernel row, column;
    };
    Pass y, cx;
    std::array<Pass, 2> cz;
    /// A Gaussian, and its first and second derivatives, which find edges and points.
    Kernel smooth, first, second;
    int reach = 0;  ///< pixels to each side that the widest of them needs
};

/// A part of a picture, linear RGB in [0, 1], channel by channel: `width` x `height` pixels with `reach` more on each
/// side, rows of `stride` floats. Pixels beyond the picture's border repeat the border.
struct Part {
    int width = 0, height = 0, reach = 0;
    std::size_t stride = 0;
    std::array<std::vector<float>, 3> rgb;

    void resize(int w, int h, int r);
    /// The index of the pixel at (x, y) from the part's first one; both may be as low as -reach.
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y + reach) * stride + static_cast<std::size_t>(x + reach);
    }
};

/// A part as it reaches the eye, in Hunt-adjusted L*a*b*, and the strength of edges and points: a number a pixel, rows
/// of `stride`.
struct Seen {
    std::size_t stride = 0;
    std::vector<float> lightness, a, b, edges, points;
};

/// Memory that `see` works in, to be used again by one thread.
struct Workspace {
    std::array<std::vector<float>, 3> ycxcz;
    std::array<std::vector<float>, 7> rows;
    std::vector<float> luminance;
};

void see(const Filters& filters, const Part& part, Workspace& workspace, Seen& seen);

/// FLIP of the pixels of row `y`, as many as `errors` has; 0 exactly where all that is seen is the same.
void row_errors(const Seen& reference, const Seen& test, int y, std::span<float> errors);

/// A fit of the ACES curve, [0, 1], for each value times the exposure; both spans have one length. And where the curve
/// reaches y. [Krzysztof Narkowicz, ACES Filmic Tone Mapping Curve, 2015]
void tone(std::span<const float> values, float exposure, std::span<float> toned);
[[nodiscard]] double untoned(double y);

/// The luminance Y of linear RGB, 1 for white.
[[nodiscard]] float luminance(float r, float g, float b);

/// From sRGB's encoding, [0, 1], in place: linear_from_srgb of each value.
void decode_srgb(std::span<float> values);

}  // namespace umbra::flip
