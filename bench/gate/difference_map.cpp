#include "umbra/bench/gate/difference_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "umbra/bench/pages/pixel_groups.h"

namespace umbra {
namespace {

// ColorBrewer's RdBu without its light middle, so that no difference looks like an equal pixel.
constexpr vec3 kBlue = vec3(0x67, 0xa9, 0xcf) / 255.0f, kDarkBlue = vec3(0x05, 0x30, 0x61) / 255.0f;
constexpr vec3 kRed = vec3(0xef, 0x8a, 0x62) / 255.0f, kDarkRed = vec3(0x67, 0x00, 0x1f) / 255.0f;
constexpr vec3 kNotFinite  = vec3(0xff, 0xd7, 0x00) / 255.0f;
constexpr float kGroundMin = 0.86f;  // grey of black pixels of A
constexpr int kCell        = 16;     // pixels: differing pixels in neighbouring cells are one group
constexpr int kRinged      = 24;     // pixels: groups up to this size are ringed

/// B - A of the channel where it is largest; NaN where a value is not finite in one image only, or where the integers
/// alone differ.
float signed_difference(const Image& a, const Image& b, std::size_t i) {
    float largest = 0;
    for (std::size_t c = 0; c < a.channels.size(); ++c) {
        const float x = a.at(i, c), y = b.at(i, c);
        if (x == y || (std::isnan(x) && std::isnan(y))) continue;
        if (!std::isfinite(x) || !std::isfinite(y)) return std::numeric_limits<float>::quiet_NaN();
        if (std::abs(y - x) > std::abs(largest)) largest = y - x;
    }
    if (largest == 0)
        for (const auto& [name, in_a] : a.integers)
            if (in_a[i] != b.integers.at(name)[i]) return std::numeric_limits<float>::quiet_NaN();
    return largest;
}

/// The smallest of 1, 2, 5 times a power of ten that is not below x; 0 for 0.
double round_up(double x) {
    if (x <= 0) return 0;
    const double power = std::pow(10, std::floor(std::log10(x)));
    for (const double step : {1.0, 2.0, 5.0})
        if (x <= step * power * (1 + 1e-6)) return step * power;
    return 10 * power;
}

vec3 colour_of(float difference, double range) {
    if (std::isnan(difference)) return kNotFinite;
    const auto t = static_cast<float>(std::abs(double(difference)) / range);
    return difference < 0 ? glm::mix(kBlue, kDarkBlue, t) : glm::mix(kRed, kDarkRed, t);
}

bool is_small(const PixelGroup& group) { return group.x1 - group.x0 < kRinged && group.y1 - group.y0 < kRinged; }

void set(Image& picture, std::size_t i, vec3 colour) {
    for (std::size_t c = 0; c < 3; ++c) picture.at(i, c) = colour[int(c)];
}

/// A black ring with white borders; differing pixels stay visible.
void draw_ring(Image& picture, const PixelGroup& group, const std::vector<float>& difference) {
    const double cx = 0.5 * (group.x0 + group.x1), cy = 0.5 * (group.y0 + group.y1);
    const double radius = 0.5 * std::hypot(group.x1 - group.x0, group.y1 - group.y0) + 8;
    const auto reach    = int(radius) + 3;
    for (int y = std::max(int(cy) - reach, 0); y <= std::min(int(cy) + reach, picture.height - 1); ++y)
        for (int x = std::max(int(cx) - reach, 0); x <= std::min(int(cx) + reach, picture.width - 1); ++x) {
            const std::size_t i = std::size_t(y) * std::size_t(picture.width) + std::size_t(x);
            const double off    = std::abs(std::hypot(x - cx, y - cy) - radius);
            if (off < 2 && difference[i] == 0) set(picture, i, vec3(off < 1 ? 0.0f : 1.0f));
        }
}

}  // namespace

DifferenceMap difference_map(const Image& a, const Image& b, bool linear, std::size_t layer) {
    std::vector<float> difference(a.pixels());
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels(); ++i) {
        difference[i] = signed_difference(a, b, i);
        if (!std::isnan(difference[i])) largest = std::max(largest, std::abs(double(difference[i])));
    }
    DifferenceMap map{shown_picture(a, linear, layer), round_up(largest)};
    for (std::size_t i = 0; i < a.pixels(); ++i) {
        const vec3 shown(map.picture.at(i, 0), map.picture.at(i, 1), map.picture.at(i, 2));
        const float grey = kGroundMin + (1 - kGroundMin) * glm::dot(shown, vec3(0.2126f, 0.7152f, 0.0722f));
        set(map.picture, i, difference[i] == 0 ? vec3(grey) : colour_of(difference[i], map.range));
    }
    for (const PixelGroup& group :
         pixel_groups(a.width, a.height, kCell, [&](std::size_t i) { return difference[i] != 0; }))
        if (is_small(group)) draw_ring(map.picture, group, difference);
    return map;
}

Image shown_picture(const Image& image, bool linear, std::size_t layer) {
    const std::array<std::size_t, 3> from = layers(image).at(layer).channels;
    Image shown(image.width, image.height, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float x     = image.at(i, from[c]);
            const float valid = std::isnan(x) ? 0 : std::clamp(x, 0.0f, 1.0f);
            shown.at(i, c)    = linear ? srgb_from_linear(valid) : valid;
        }
    return shown;
}

}  // namespace umbra
