// The difference of two images as a picture in which every differing pixel can be found.
#pragma once

#include "umbra/core/image/image.h"

namespace umbra {

/// sRGB, as an 8-bit file holds it. B - A of the channel with the largest difference at each pixel: red where B is
/// larger, blue where it is smaller, on one scale that ends at +-`range`, 1, 2 or 5 times a power of ten. Even the
/// smallest difference has a colour that equal pixels, which show A in light grey, have not. Yellow: not finite in one
/// image only, or other whole numbers. Groups of differing pixels that are at most 24 pixels wide and high, and lie
/// apart from others, have a ring around them.
struct DifferenceMap {
    Image picture;
    double range = 0;  ///< 0 where no finite values differ
};

/// Both images have the same size and channels, in the same order. `linear`: they hold scene-linear light, else sRGB.
/// `layer`: the one of layers(a) that the grey is of.
[[nodiscard]] DifferenceMap difference_map(const Image& a, const Image& b, bool linear, std::size_t layer = 0);

/// A layer of the image for a screen: sRGB, clamped.
[[nodiscard]] Image shown_picture(const Image& image, bool linear, std::size_t layer = 0);

}  // namespace umbra
