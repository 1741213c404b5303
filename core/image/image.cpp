#include "umbra/core/image/image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace umbra {
void spread_integers(Image& image) {
    if (!image.channels.empty()) return;
    for (const auto& integer : image.integers) image.channels.push_back(integer.first);
    image.data.resize(image.pixels() * image.channels.size());
    std::size_t c = 0;
    for (const auto& integer : image.integers) {
        for (std::size_t i = 0; i < image.pixels(); ++i)
            image.at(i, c) = float(double(integer.second[i]) / double(std::numeric_limits<std::uint32_t>::max()));
        ++c;
    }
}

std::vector<Layer> layers(const Image& image) {
    std::vector<Layer> found;
    const auto find = [&](const std::string& name) {
        return std::size_t(std::find(image.channels.begin(), image.channels.end(), name) - image.channels.begin());
    };
    for (std::size_t r = 0; r < image.channels.size(); ++r) {
        const std::string& name = image.channels[r];
        if (name != "R" && !name.ends_with(".R")) continue;
        const std::string prefix = name.substr(0, name.size() - 1);
        const std::array<std::size_t, 3> rgb{r, find(prefix + "G"), find(prefix + "B")};
        if (std::max(rgb[1], rgb[2]) == image.channels.size()) continue;
        found.insert(prefix.empty() ? found.begin() : found.end(),
                     {prefix.empty() ? "" : prefix.substr(0, prefix.size() - 1), rgb});
    }
    if (found.empty())
        for (std::size_t c = 0; c < image.channels.size(); ++c) found.push_back({image.channels[c], {c, c, c}});
    return found;
}

std::array<std::size_t, 3> colour_channels(const Image& image) { return layers(image).at(0).channels; }

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
