#include "umbra/tests/light/spectrum.h"

#include <cmath>
#include <stdexcept>

namespace umbra {
namespace {

/// A Gaussian whose widths differ on its two sides, given as their reciprocals.
double lobe(double wavelength, double centre, double left, double right) {
    const double t = (wavelength - centre) * (wavelength < centre ? left : right);
    return std::exp(-0.5 * t * t);
}

/// The observer's response to one wavelength.
dvec3 response(double w) {
    return {0.362 * lobe(w, 442.0, 0.0624, 0.0374) + 1.056 * lobe(w, 599.8, 0.0264, 0.0323) -
                0.065 * lobe(w, 501.1, 0.0490, 0.0382),
            0.821 * lobe(w, 568.8, 0.0213, 0.0247) + 0.286 * lobe(w, 530.9, 0.0613, 0.0322),
            1.217 * lobe(w, 437.0, 0.0845, 0.0278) + 0.681 * lobe(w, 459.0, 0.0385, 0.0725)};
}

dvec3 linear_srgb(dvec3 c) {
    return {3.2406 * c.x - 1.5372 * c.y - 0.4986 * c.z, -0.9689 * c.x + 1.8758 * c.y + 0.0415 * c.z,
            0.0557 * c.x - 0.2040 * c.y + 1.0570 * c.z};
}

template <class Value>
Spectrum sampled(const Value& value) {
    Spectrum spectrum;
    for (std::size_t i = 0; i < Spectrum::kSamples; ++i) spectrum.at[i] = value(Spectrum::wavelength(i));
    return spectrum;
}

}  // namespace

Spectrum operator*(const Spectrum& a, const Spectrum& b) {
    Spectrum product;
    for (std::size_t i = 0; i < Spectrum::kSamples; ++i) product.at[i] = a.at[i] * b.at[i];
    return product;
}

Spectrum constant_spectrum(double value) {
    return sampled([&](double) { return value; });
}

Spectrum band(double centre, double width) {
    if (!(width > 0)) throw std::invalid_argument("band: expected a width above 0");
    return sampled([&](double w) { return std::exp(-0.5 * std::pow((w - centre) / width, 2)); });
}

Spectrum black_body(double kelvin) {
    if (!(kelvin > 0)) throw std::invalid_argument("black_body: expected a temperature above 0");
    constexpr double second = 1.438776877e7;  // second radiation constant, nm K
    const auto law          = [&](double w) { return std::pow(w, -5.0) / std::expm1(second / (w * kelvin)); };
    const double unit       = law(560);
    return sampled([&](double w) { return law(w) / unit; });
}

dvec3 xyz(const Spectrum& light) {
    dvec3 sum(0);
    for (std::size_t i = 0; i < Spectrum::kSamples; ++i) sum += light.at[i] * response(Spectrum::wavelength(i));
    return sum * double(Spectrum::kStep);
}

dvec3 rgb(const Spectrum& light, const Spectrum& white) { return linear_srgb(xyz(light)) / linear_srgb(xyz(white)); }

SpectralColour spectral_colour(const Spectrum& reflectance, const Spectrum& light, const Spectrum& white) {
    return {rgb(reflectance * light, white), rgb(reflectance * white, white) * rgb(light, white)};
}

}  // namespace umbra
