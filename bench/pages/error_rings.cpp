#include "umbra/bench/pages/error_rings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "umbra/bench/pages/pixel_groups.h"

namespace umbra {
namespace {

constexpr std::size_t kMostRings = 24;

/// 0xrrggbb
unsigned number_of(const ErrorColour& entry) {
    unsigned rgb = 0;
    std::from_chars(entry.srgb.data() + 1, entry.srgb.data() + entry.srgb.size(), rgb, 16);
    return rgb;
}

unsigned colour_at(const Image& image, std::size_t pixel) {
    unsigned rgb = 0;
    for (std::size_t c = 0; c < 3; ++c)
        rgb = rgb << 8 | static_cast<unsigned>(std::floor(double(image.at(pixel, c)) * 255 + 0.5));
    return rgb;
}

}  // namespace

ErrorRings error_rings(const Image& image) {
    ErrorRings found;
    if (image.pixels() == 0 || image.channels.size() < 3) return found;
    std::set<unsigned> colours;
    for (const ErrorColour& entry : kErrorPalette)
        if (entry.interior) colours.insert(number_of(entry));

    unsigned last    = 0;  // neighbours are mostly alike
    bool is_interior = colours.contains(last);
    auto groups      = pixel_groups(image.width, image.height, std::max(4, image.width / 40), [&](std::size_t i) {
        if (const unsigned colour = colour_at(image, i); colour != last)
            last = colour, is_interior = colours.contains(colour);
        found.points += is_interior;
        return is_interior;
    });
    std::size_t easy = 0;  // points
    std::erase_if(groups, [&](const PixelGroup& g) {
        const bool large = g.pixels * 2000 >= image.pixels();
        if (large) easy += g.pixels;
        return large;
    });
    if (2 * easy > found.points) return found;
    std::stable_sort(groups.begin(), groups.end(),
                     [](const PixelGroup& a, const PixelGroup& b) { return a.pixels > b.pixels; });
    if (groups.size() > kMostRings) groups.resize(kMostRings);
    const double margin = image.width / 64.0;
    for (const PixelGroup& g : groups)
        found.rings.push_back(
            {g.x0 - margin, g.y0 - margin, g.x1 + 1 - g.x0 + 2 * margin, g.y1 + 1 - g.y0 + 2 * margin});
    return found;
}

std::vector<const ErrorColour*> classes_on(const Image& image) {
    std::set<unsigned> colours;
    if (image.channels.size() >= 3)
        for (std::size_t i = 0; i < image.pixels(); ++i)
            if (i == 0 || colour_at(image, i) != colour_at(image, i - 1)) colours.insert(colour_at(image, i));
    std::vector<const ErrorColour*> found;
    for (const ErrorColour& entry : kErrorPalette)
        if (colours.contains(number_of(entry))) found.push_back(&entry);
    return found;
}

}  // namespace umbra
