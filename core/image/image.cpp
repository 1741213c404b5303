#include "umbra/core/image/image.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace umbra {

std::array<std::size_t, 3> colour_channels(const Image& image) {
    std::array<std::size_t, 3> found{};
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto at = std::find(image.channels.begin(), image.channels.end(), names[c]);
        if (at == image.channels.end()) return {0, 0, 0};
        found[c] = std::size_t(at - image.channels.begin());
    }
    return found;
}

void check_same_size(const Image& a, const Image& b, std::string_view who) {
    if (a.width != b.width || a.height != b.height || a.data.empty() || b.data.empty())
        throw std::logic_error(std::string(who) + ": the images are empty or differ in size");
}

// In double: 1.055f - 0.055f falls short of 1, and white must be white.

float srgb_from_linear(float x) {
    const double v = std::abs(double(x));
    return std::copysign(float(v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055), x);
}

float linear_from_srgb(float x) {
    const double v = std::abs(double(x));
    return std::copysign(float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)), x);
}

}  // namespace umbra
