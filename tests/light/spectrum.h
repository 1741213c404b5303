// Light by wavelength, and what RGB makes of it: the error of RGB(k) RGB(I) against RGB(k I).
//
// A renderer that works in RGB multiplies colours; light and surfaces multiply wavelength by wavelength. The two agree
// where the light is the white that colours are taken under, or where a surface reflects all wavelengths alike.
#pragma once

#include <array>

#include "umbra/core/base/math.h"

namespace umbra {

/// Samples from 380 to 770 nm, 5 nm apart. Of a light: power by wavelength, in any unit. Of a surface: the share of it
/// that is reflected, [0, 1].
struct Spectrum {
    static constexpr int kFirst = 380, kLast = 770, kStep = 5;  ///< nm
    static constexpr std::size_t kSamples = std::size_t(kLast - kFirst) / kStep + 1;
    std::array<double, kSamples> at{};

    [[nodiscard]] static double wavelength(std::size_t i) { return kFirst + kStep * double(i); }
};

[[nodiscard]] Spectrum operator*(const Spectrum& a, const Spectrum& b);

/// The same share of every wavelength.
[[nodiscard]] Spectrum constant_spectrum(double value);

/// exp(-((wavelength - centre) / width)^2 / 2), nm: a band of a filter, a paint, or a lamp. Throws
/// std::invalid_argument unless width > 0.
[[nodiscard]] Spectrum band(double centre, double width);

/// Planck's law, 1 at 560 nm, for a temperature in kelvin above 0: 2856 is near incandescent lamps, 6504 near daylight.
/// [Max Planck, Ueber das Gesetz der Energieverteilung im Normalspectrum, 1901]
[[nodiscard]] Spectrum black_body(double kelvin);

/// CIE 1931 tristimulus values for the 2 degree observer, from analytic fits to its colour matching functions:
/// integrals over the wavelength in nm. [Chris Wyman, Peter-Pike Sloan, Peter Shirley, Simple Analytic Approximations
/// to the CIE XYZ Color Matching Functions, 2013]
[[nodiscard]] dvec3 xyz(const Spectrum& light);

/// Linear sRGB in which `white` is (1, 1, 1): tristimulus values by sRGB's matrix, each channel divided by that of
/// `white`. Values may be below 0, where a colour is purer than sRGB can show.
/// [IEC 61966-2-1, 1999]
[[nodiscard]] dvec3 rgb(const Spectrum& light, const Spectrum& white);

/// What a surface looks like under a light, and what a renderer in RGB makes of it; both linear, relative to `white`.
struct SpectralColour {
    dvec3 spectral;  ///< RGB(k I)
    dvec3 product;   ///< RGB(k white) RGB(I), channel by channel
};
[[nodiscard]] SpectralColour spectral_colour(const Spectrum& reflectance, const Spectrum& light, const Spectrum& white);

}  // namespace umbra
