// Differences between two pictures.
#pragma once

#include "core/image.h"

namespace umbra {

/// Over all values of all channels that both images have (callers check sizes and channels first).
/// Values that are not finite in either image count in `not_finite` and in nothing else.
struct ImageError {
    double mae = 0, rmse = 0, max = 0;
    double psnr   = 0;  ///< dB against a peak of 1; infinite where equal
    double mean_a = 0, mean_b = 0;
    struct Worst {
        int x = 0, y = 0, channel = 0;
    } worst;                     ///< where max is
    std::size_t differing  = 0;  ///< pixels with any difference
    std::size_t not_finite = 0;
};
[[nodiscard]] ImageError image_error(const Image& a, const Image& b);

/// Structural similarity of the luminance, Gaussian window 11x11, sigma 1.5, K1 0.01, K2 0.03, range 1; mean over all
/// full windows (over one window that is the image, where it is smaller than 11). 1 where equal.
/// [Zhou Wang, Alan Bovik, Hamid Sheikh, Eero Simoncelli, Image Quality Assessment: From Error Visibility to Structural
/// Similarity, 2004]
[[nodiscard]] double ssim(const Image& a, const Image& b);

/// FLIP, version 1.6's definition and default viewing conditions (67 pixels per degree). `map` is per pixel in [0, 1].
/// LDR takes sRGB-encoded values in [0, 1]; HDR takes scene-linear values, exposures found from `reference` (ACES).
/// One-channel images are taken as grey.
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
