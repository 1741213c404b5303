// FLIP: how visible is the difference, to a person who flips between two pictures?
//
//   picture -> YCxCz -> what the eye resolves (contrast sensitivity) -> L*a*b*, Hunt -> colour difference  dC
//                  \--> luminance -> edges, points                               -> feature difference dF
//   FLIP = dC ^ (1 - dF)
//
// This work is based on:
// Pontus Andersson, Jim Nilsson, Tomas Akenine-Moeller, Magnus Oskarsson, Kalle Astroem, Mark Fairchild. FLIP: A
//   Difference Evaluator for Alternating Images. 2020
// Pontus Andersson, Jim Nilsson, Peter Shirley, Tomas Akenine-Moeller. Visualizing Errors in Rendered High Dynamic
//   Range Images. 2021
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"
#include "umbra/core/image/flip_tile.h"
#include "umbra/core/image/metrics.h"

namespace umbra {
namespace {

// -- Tiles: a pixel whose surroundings are the same in both pictures has no error

constexpr int kTile = 96;

struct Tile {
    int left, top, width, height;
};

/// The buffers of one thread, kept from tile to tile.
struct Desk {
    std::array<flip::Part, 2> linear, shown;
    flip::Workspace workspace;
    std::array<flip::Seen, 2> seen;
    std::vector<float> errors;
};

/// The tile and its surroundings, of a picture whose pixel i is `colour(i)`.
template <class Colour>
void cut(const Colour& colour, int width, int height, const Tile& tile, int reach, flip::Part& part) {
    part.resize(tile.width, tile.height, reach);
    for (int y = -reach; y < tile.height + reach; ++y) {
        const std::size_t row = std::size_t(std::clamp(tile.top + y, 0, height - 1)) * std::size_t(width);
        for (int x = -reach; x < tile.width + reach; ++x) {
            const vec3 c         = colour(row + std::size_t(std::clamp(tile.left + x, 0, width - 1)));
            const std::size_t at = part.at(x, y);
            part.rgb[0][at] = c.x, part.rgb[1][at] = c.y, part.rgb[2][at] = c.z;
        }
    }
}

/// Whether `same` holds for all pixels of the tile and around it.
template <class Same>
bool all_of(const Same& same, int width, int height, const Tile& tile, int reach) {
    const int right  = std::min(tile.left + tile.width + reach, width);
    const int bottom = std::min(tile.top + tile.height + reach, height);
    for (int y = std::max(tile.top - reach, 0); y < bottom; ++y)
        for (int x = std::max(tile.left - reach, 0); x < right; ++x)
            if (!same(std::size_t(y) * std::size_t(width) + std::size_t(x))) return false;
    return true;
}

/// FLIP of each pixel, the largest of several exposures: `expose(k, desk)` makes `shown` out of `linear`, which has the
/// pictures `reference(i)` and `test(i)`. Tiles with all that their pixels' filters reach are computed apart, with the
/// same values to the last bit; those without a difference, where `same(i)` for all pixels, are 0 and not computed.
template <class Same, class Reference, class Test, class Expose>
std::vector<float> error_map(int width, int height, const Same& same, const Reference& reference, const Test& test,
                             int exposures, const Expose& expose, double pixels_per_degree) {
    const flip::Filters filters(pixels_per_degree);
    const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
    std::vector<float> map(std::size_t(width) * std::size_t(height));
    parallel_ranges(std::size_t(across) * std::size_t(down), 1, [&](std::size_t begin, std::size_t end) {
        static thread_local Desk desk;
        for (std::size_t n = begin; n < end; ++n) {
            const int left = int(n) % across * kTile, top = int(n) / across * kTile;
            const Tile tile{left, top, std::min(kTile, width - left), std::min(kTile, height - top)};
            if (all_of(same, width, height, tile, filters.reach)) continue;
            cut(reference, width, height, tile, filters.reach, desk.linear[0]);
            cut(test, width, height, tile, filters.reach, desk.linear[1]);
            desk.errors.resize(std::size_t(tile.width));
            for (int k = 0; k < exposures; ++k) {
                expose(k, desk);
                for (std::size_t p = 0; p < 2; ++p) flip::see(filters, desk.shown[p], desk.workspace, desk.seen[p]);
                for (int y = 0; y < tile.height; ++y) {
                    flip::row_errors(desk.seen[0], desk.seen[1], y, desk.errors);
                    float* const worst = &map[std::size_t(tile.top + y) * std::size_t(width) + std::size_t(tile.left)];
                    for (std::size_t x = 0; x < desk.errors.size(); ++x) worst[x] = std::max(worst[x], desk.errors[x]);
                }
            }
        }
    });
    return map;
}

// -- Pooling

/// The value up to which the errors, in order, add up to `share` of their sum; `sorted` lacks those that are 0.
double weighted_quantile(const std::vector<float>& sorted, double sum, double share) {
    double below = 0;
    for (const float value : sorted) {
        below += value;
        if (below >= share * sum) return value;
    }
    return sorted.empty() ? 0 : sorted.back();
}

Flip pooled(std::vector<float> map) {
    std::vector<float> sorted;  // most errors are 0
    for (const float value : map)
        if (value > 0) sorted.push_back(value);
    parallel_sort(sorted.begin(), sorted.end());
    double sum = 0;
    for (const float value : sorted) sum += value;
    Flip flip;
    flip.mean            = sum / double(map.size());
    flip.weighted_median = weighted_quantile(sorted, sum, 0.5);
    flip.first_quartile  = weighted_quantile(sorted, sum, 0.25);
    flip.third_quartile  = weighted_quantile(sorted, sum, 0.75);
    flip.min             = sorted.size() == map.size() ? sorted.front() : 0;
    flip.max             = sorted.empty() ? 0 : sorted.back();
    flip.map             = std::move(map);
    return flip;
}

// -- Exposures of the high dynamic range variant

/// From the exposure at which the brightest pixel of the reference is just not burnt out to that at which its median
/// is.
struct Exposures {
    double start = 0, stop = 0;
    int count = 2;
};
Exposures find_exposures(const std::vector<vec3>& reference) {
    std::vector<float> luminance(reference.size());
    parallel_ranges(luminance.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            luminance[i] = flip::luminance(reference[i].x, reference[i].y, reference[i].z);
    });
    const auto middle = luminance.begin() + std::ptrdiff_t(luminance.size() / 2);
    std::nth_element(luminance.begin(), middle, luminance.end());
    // Black has no exposure that makes it bright.
    const double darkest = std::numeric_limits<float>::epsilon();
    const double median  = std::max(double(*middle), darkest);
    const double largest = std::max(double(*std::max_element(luminance.begin(), luminance.end())), darkest);
    const double bright  = flip::untoned(0.85);
    const Exposures range{std::log2(bright / largest), std::log2(bright / median), 0};
    return {range.start, range.stop, std::max(2, int(std::ceil(range.stop - range.start)))};
}

// -- Images

/// `value` of each channel of pixel i.
template <class Value>
auto colour_of(const Image& image, const Value& value) {
    return [&image, channels = colour_channels(image), value](std::size_t i) {
        return vec3(value(image.at(i, channels[0])), value(image.at(i, channels[1])), value(image.at(i, channels[2])));
    };
}

template <class Colour>
std::vector<vec3> colours(std::size_t pixels, const Colour& colour) {
    std::vector<vec3> rgb(pixels);
    parallel_ranges(pixels, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) rgb[i] = colour(i);
    });
    return rgb;
}

}  // namespace

Flip flip_ldr(const Image& reference, const Image& test, double pixels_per_degree) {
    check_same_size(reference, test, "flip");
    const auto as_it_is = [](float x) { return x; };
    const auto bounded  = [](float x) { return x > 0 ? std::min(x, 1.0f) : 0.0f; };  // NaN: 0
    const auto a = colour_of(reference, as_it_is), b = colour_of(test, as_it_is);
    const auto same   = [&](std::size_t i) { return a(i) == b(i); };
    const auto decode = [](int, Desk& desk) {
        std::swap(desk.shown, desk.linear);
        for (flip::Part& part : desk.shown)
            for (std::vector<float>& plane : part.rgb) flip::decode_srgb(plane);
    };
    return pooled(error_map(reference.width, reference.height, same, colour_of(reference, bounded),
                            colour_of(test, bounded), 1, decode, pixels_per_degree));
}

Flip flip_hdr(const Image& reference, const Image& test, double pixels_per_degree) {
    check_same_size(reference, test, "flip");
    const auto light          = [](float x) { return x > 0 ? std::min(x, 1e15f) : 0.0f; };  // NaN: 0
    const std::vector<vec3> a = colours(reference.pixels(), colour_of(reference, light));
    const std::vector<vec3> b = colours(test.pixels(), colour_of(test, light));
    const Exposures exposures = find_exposures(a);
    const auto same           = [&](std::size_t i) { return a[i] == b[i]; };
    const auto tone           = [&](int k, Desk& desk) {
        const double exposure = exposures.start + (exposures.stop - exposures.start) * k / (exposures.count - 1);
        const float factor    = float(std::exp2(exposure));
        for (std::size_t p = 0; p < 2; ++p) {
            desk.shown[p].resize(desk.linear[p].width, desk.linear[p].height, desk.linear[p].reach);
            for (std::size_t c = 0; c < 3; ++c) flip::tone(desk.linear[p].rgb[c], factor, desk.shown[p].rgb[c]);
        }
    };
    Flip flip           = pooled(error_map(
                  reference.width, reference.height, same, [&](std::size_t i) { return a[i]; },
                  [&](std::size_t i) { return b[i]; }, exposures.count, tone, pixels_per_degree));
    flip.start_exposure = exposures.start;
    flip.stop_exposure  = exposures.stop;
    flip.exposures      = exposures.count;
    return flip;
}

}  // namespace umbra
