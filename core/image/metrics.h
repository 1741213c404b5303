// Differences between two pictures.
#pragma once

#include "umbra/core/image/image.h"

namespace umbra {

/// Over all values of the channels that both images have by name; the sizes must be equal. Sums are over the finite
/// values: one that is not finite in either image counts in `not_finite` instead, and in `unlike_not_finite` where the
/// two are not the same (NaN is the same as NaN).
struct ImageError {
    double mae = 0, rmse = 0, max = 0;
    double psnr   = 0;  ///< dB against a peak of 1; infinite where equal
    double mean_a = 0, mean_b = 0;
    struct Worst {
        int x = 0, y = 0, channel = 0;
    } worst;                     ///< where max is, the first of equals; channel is an index into a.channels
    std::size_t values     = 0;  ///< finite ones that were compared
    std::size_t differing  = 0;  ///< pixels with any difference, those of values that are not finite included
    std::size_t over       = 0;  ///< pixels with a difference above `threshold`, or of values that are not finite
    std::size_t not_finite = 0, unlike_not_finite = 0;
};
[[nodiscard]] ImageError image_error(const Image& a, const Image& b, double threshold = 0);

/// Structural similarity of the luminance (of the first channel where there is no R, G, B) of the values as they are.
/// Gaussian window 11x11, sigma 1.5, K1 0.01, K2 0.03, range 1; mean over all windows that lie wholly in the image, so
/// that nothing is made up beyond its border. Along a side shorter than 11 the window is as long as that side. 1 where
/// equal. Values that are not finite are taken as 0.
/// [Zhou Wang, Alan Bovik, Hamid Sheikh, Eero Simoncelli, Image Quality Assessment: From Error Visibility to Structural
/// Similarity, 2004]
[[nodiscard]] double ssim(const Image& a, const Image& b);

/// FLIP, version 1.6's definition and default viewing conditions (67 pixels per degree). `map` is per pixel in [0, 1].
/// LDR takes sRGB-encoded values in [0, 1]; HDR takes scene-linear values, exposures found from `reference` (ACES).
/// Images without R, G, B are taken as grey, by their first channel. NaN and negative values are taken as 0. Pooled
/// values are over all pixels; median and quartiles are weighted by the error itself, since most pixels of a good
/// picture have none. Differs from the reference implementation by less than 2e-5 on its own values of seven pairs.
/// [Pontus Andersson, Jim Nilsson, Tomas Akenine-Moeller, Magnus Oskarsson, Kalle Astroem, Mark Fairchild, FLIP: A
/// Difference Evaluator for Alternating Images, 2020; Andersson, Nilsson, Shirley, Akenine-Moeller, Visualizing Errors
/// in Rendered High Dynamic Range Images, 2021]
struct Flip {
    double mean = 0, weighted_median = 0, first_quartile = 0, third_quartile = 0, min = 0, max = 0;
    double start_exposure = 0, stop_exposure = 0;
    int exposures = 0;  ///< 0 for LDR
    std::vector<float> map;
};
[[nodiscard]] Flip flip_ldr(const Image& reference, const Image& test, double pixels_per_degree = 67.0206451);
[[nodiscard]] Flip flip_hdr(const Image& reference, const Image& test, double pixels_per_degree = 67.0206451);

}  // namespace umbra
