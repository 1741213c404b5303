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
// Xuemei Zhang, Brian Wandell. A Spatial Extension of CIELAB for Digital Color Image Reproduction. 1997
// Saeedeh Abasi, Mohammad Amani Tehran, Mark Fairchild. Distance Metrics for Very Large Color Differences. 2019
// Krzysztof Narkowicz. ACES Filmic Tone Mapping Curve. 2015
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "umbra/core/base/parallel.h"
#include "umbra/core/image/metrics.h"

namespace umbra {
namespace {

// The constants of the 2020 paper.
constexpr double kColourExponent  = 0.7;    // q_c
constexpr double kKnee            = 0.4;    // p_c: this share of the largest colour difference ...
constexpr double kKneeError       = 0.95;   // p_t: ... is mapped to this error
constexpr double kFeatureExponent = 0.5;    // q_f
constexpr double kFeatureWidth    = 0.082;  // w, degrees of visual angle

struct Plane {
    int width = 0, height = 0;
    std::vector<float> data;
    Plane(int w, int h) : width(w), height(h), data(std::size_t(w) * std::size_t(h)) {}
    float* row(int y) { return data.data() + std::size_t(y) * std::size_t(width); }
    [[nodiscard]] const float* row(int y) const { return data.data() + std::size_t(y) * std::size_t(width); }
};
using Planes = std::array<Plane, 3>;

// -- Filters: odd length, centred, applied with the border pixels repeated

using Kernel = std::vector<float>;

Kernel gaussian(int radius, double per_square) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) kernel.push_back(float(std::exp(-per_square * i * i)));
    return kernel;
}

double sum_of(const Kernel& kernel) {
    double sum = 0;
    for (const float w : kernel) sum += w;
    return sum;
}

Kernel scaled(Kernel kernel, double factor) {
    for (float& w : kernel) w = float(w * factor);
    return kernel;
}

/// Positive weights add up to 1, negative ones to -1.
Kernel balanced(Kernel kernel) {
    double positive = 0, negative = 0;
    for (const float w : kernel) (w > 0 ? positive : negative) += w;
    for (float& w : kernel) w = float(w > 0 ? w / positive : -w / negative);
    return kernel;
}

template <class Body>
void for_rows(int height, const Body& body) {
    parallel_ranges(std::size_t(height), 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) body(int(y));
    });
}

Plane filter_rows(const Plane& in, const Kernel& kernel) {
    Plane out(in.width, in.height);
    const int radius = int(kernel.size()) / 2;
    for_rows(in.height, [&](int y) {
        std::vector<float> padded(std::size_t(in.width + 2 * radius));
        for (int x = -radius; x < in.width + radius; ++x)
            padded[std::size_t(x + radius)] = in.row(y)[std::clamp(x, 0, in.width - 1)];
        float* const sum = out.row(y);
        for (std::size_t k = 0; k < kernel.size(); ++k)
            for (int x = 0; x < in.width; ++x) sum[x] += kernel[k] * padded[std::size_t(x) + k];
    });
    return out;
}

Plane filter_columns(const Plane& in, const Kernel& kernel) {
    Plane out(in.width, in.height);
    const int radius = int(kernel.size()) / 2;
    for_rows(in.height, [&](int y) {
        float* const sum = out.row(y);
        for (int k = -radius; k <= radius; ++k) {
            const float weight      = kernel[std::size_t(k + radius)];
            const float* const from = in.row(std::clamp(y + k, 0, in.height - 1));
            for (int x = 0; x < in.width; ++x) sum[x] += weight * from[x];
        }
    });
    return out;
}

// -- Colour spaces

// linear sRGB to CIE XYZ (IEC 61966-2-1 primaries, D65), and the white that it gives
constexpr double kXyzFromRgb[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                      {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                      {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
constexpr double white(int row) { return kXyzFromRgb[row][0] + kXyzFromRgb[row][1] + kXyzFromRgb[row][2]; }

/// Linear RGB to XYZ / white, one row a component.
const mat3& white_from_rgb() {
    static const mat3 m = [] {
        mat3 product(1);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                product[column][row] = float(kXyzFromRgb[row][column] / white(row));
        return product;
    }();
    return m;
}
const mat3& rgb_from_white() {
    static const mat3 m = mat3(glm::inverse(glm::dmat3(white_from_rgb())));
    return m;
}

/// Opponent space, linear in light (unlike L*a*b*), so that filters may run in it.
vec3 ycxcz_from_white(vec3 t) { return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)}; }
vec3 white_from_ycxcz(vec3 c) {
    const float y = (c.x + 16) / 116;
    return {y + c.y / 500, y, y - c.z / 200};
}

float lab_curve(float t) {
    constexpr float kDelta = 6.0f / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29;
}

/// L*a*b* with Hunt's effect: colours are less colourful where there is less light.
vec3 hunt_lab(vec3 rgb) {
    const vec3 t = white_from_rgb() * rgb;
    const vec3 f{lab_curve(t.x), lab_curve(t.y), lab_curve(t.z)};
    const float lightness = 116 * f.y - 16;
    return {lightness, 0.01f * lightness * 500 * (f.x - f.y), 0.01f * lightness * 200 * (f.y - f.z)};
}

/// HyAB: city block between lightness and chroma, which suits large differences better than a Euclidean distance.
float hyab(vec3 a, vec3 b) {
    const vec3 d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// -- The two pipelines

Planes ycxcz_planes(int width, int height, const std::vector<vec3>& rgb) {
    Planes planes{Plane(width, height), Plane(width, height), Plane(width, height)};
    for_rows(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            const vec3 c =
                ycxcz_from_white(white_from_rgb() * rgb[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
            for (int k = 0; k < 3; ++k) planes[std::size_t(k)].row(y)[x] = c[k];
        }
    });
    return planes;
}

/// The contrast sensitivity of the eye, a low pass filter for each channel: in space a sum of Gaussians
/// a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees of visual angle.
struct Sensitivity {
    struct Term {
        double a, b;
    };
    std::vector<Term> terms;
};
const std::array<Sensitivity, 3>& sensitivities() {
    static const std::array<Sensitivity, 3> all{Sensitivity{{{1, 0.0047}}}, Sensitivity{{{1, 0.0053}}},
                                                Sensitivity{{{34.1, 0.04}, {13.5, 0.025}}}};
    return all;
}
constexpr double kWidest = 0.04;  // the largest b above: all channels are filtered with its radius

/// Pixels that the filters of contrast sensitivity reach.
int colour_radius(double pixels_per_degree) {
    return int(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * pixels_per_degree));
}

Plane as_seen(const Plane& channel, const Sensitivity& sensitivity, double pixels_per_degree) {
    const int radius = colour_radius(pixels_per_degree);
    double total     = 0;  // of the two-dimensional filter
    for (const auto& [a, b] : sensitivity.terms) {
        const double sum = sum_of(gaussian(radius, kPi * kPi / (b * pixels_per_degree * pixels_per_degree)));
        total += a * std::sqrt(kPi / b) * sum * sum;
    }
    Plane seen(channel.width, channel.height);
    for (const auto& [a, b] : sensitivity.terms) {
        const Kernel kernel = gaussian(radius, kPi * kPi / (b * pixels_per_degree * pixels_per_degree));
        const Plane part = filter_columns(filter_rows(channel, scaled(kernel, a * std::sqrt(kPi / b) / total)), kernel);
        for (std::size_t i = 0; i < seen.data.size(); ++i) seen.data[i] += part.data[i];
    }
    return seen;
}

/// What of the picture reaches the eye, in Hunt-adjusted L*a*b*.
std::vector<vec3> perceived(const Planes& ycxcz, double pixels_per_degree) {
    const Plane y  = as_seen(ycxcz[0], sensitivities()[0], pixels_per_degree);
    const Plane cx = as_seen(ycxcz[1], sensitivities()[1], pixels_per_degree);
    const Plane cz = as_seen(ycxcz[2], sensitivities()[2], pixels_per_degree);
    std::vector<vec3> lab(y.data.size());
    parallel_ranges(lab.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const vec3 rgb = rgb_from_white() * white_from_ycxcz({y.data[i], cx.data[i], cz.data[i]});
            lab[i]         = hunt_lab(glm::clamp(rgb, 0.0f, 1.0f));
        }
    });
    return lab;
}

/// Strength of edges and of points at each pixel, from first and second derivatives of a Gaussian.
struct Features {
    std::vector<float> edges, points;
};
double feature_sigma(double pixels_per_degree) { return 0.5 * kFeatureWidth * pixels_per_degree; }

/// Pixels that the filters of edges and points reach.
int feature_radius(double pixels_per_degree) { return int(std::ceil(3 * feature_sigma(pixels_per_degree))); }

Features find_features(const Plane& y, double pixels_per_degree) {
    const double sigma = feature_sigma(pixels_per_degree);
    const int radius   = feature_radius(pixels_per_degree);
    Kernel smooth      = gaussian(radius, 1 / (2 * sigma * sigma));
    Kernel first = smooth, second = smooth;
    for (int i = -radius; i <= radius; ++i) {
        first[std::size_t(i + radius)] *= float(-i);
        second[std::size_t(i + radius)] *= float(i * i / (sigma * sigma) - 1);
    }
    smooth = scaled(smooth, 1 / sum_of(smooth));
    first  = balanced(first);
    second = balanced(second);

    Plane luminance = y;  // [0, 1]
    for (float& value : luminance.data) value = (value + 16) / 116;
    const Plane smooth_rows = filter_rows(luminance, smooth);
    const Plane edge_x      = filter_columns(filter_rows(luminance, first), smooth);
    const Plane edge_y      = filter_columns(smooth_rows, first);
    const Plane point_x     = filter_columns(filter_rows(luminance, second), smooth);
    const Plane point_y     = filter_columns(smooth_rows, second);

    Features features{std::vector<float>(y.data.size()), std::vector<float>(y.data.size())};
    for (std::size_t i = 0; i < y.data.size(); ++i) {
        features.edges[i]  = std::sqrt(edge_x.data[i] * edge_x.data[i] + edge_y.data[i] * edge_y.data[i]);
        features.points[i] = std::sqrt(point_x.data[i] * point_x.data[i] + point_y.data[i] * point_y.data[i]);
    }
    return features;
}

/// The largest colour difference that a display can show, green against blue, lies at 1. Most of [0, 1] is given to the
/// differences below the knee, since those above it are large in any case.
float colour_error(float distance) {
    static const float largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), float(kColourExponent));
    const float knee           = float(kKnee) * largest;
    const float d              = std::pow(distance, float(kColourExponent));
    return d < knee ? float(kKneeError) / knee * d
                    : float(kKneeError) + (d - knee) / (largest - knee) * float(1 - kKneeError);
}

/// FLIP of each pixel of a whole picture, for linear RGB in [0, 1].
std::vector<float> whole_error_map(int width, int height, const std::vector<vec3>& reference,
                                   const std::vector<vec3>& test, double pixels_per_degree) {
    const Planes a                = ycxcz_planes(width, height, reference);
    const Planes b                = ycxcz_planes(width, height, test);
    const std::vector<vec3> lab_a = perceived(a, pixels_per_degree);
    const std::vector<vec3> lab_b = perceived(b, pixels_per_degree);
    const Features features_a     = find_features(a[0], pixels_per_degree);
    const Features features_b     = find_features(b[0], pixels_per_degree);

    std::vector<float> map(reference.size());
    parallel_ranges(map.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const float colour  = colour_error(hyab(lab_a[i], lab_b[i]));
            const float feature = std::max(std::abs(features_a.edges[i] - features_b.edges[i]),
                                           std::abs(features_a.points[i] - features_b.points[i]));
            const float weight  = std::pow(feature / std::sqrt(2.0f), float(kFeatureExponent));
            map[i]              = std::clamp(std::pow(colour, 1 - weight), 0.0f, 1.0f);
        }
    });
    return map;
}

// -- Tiles: a pixel whose surroundings are the same in both pictures has no error

struct Rectangle {
    int left, top, right, bottom;  ///< the last two lie outside

    [[nodiscard]] int width() const { return right - left; }
    [[nodiscard]] int height() const { return bottom - top; }
};

/// Pixel i of each picture as linear RGB in [0, 1], asked for in any order and from any thread.
template <class Colour>
std::vector<vec3> cut(const Colour& colour, int width, const Rectangle& at) {
    std::vector<vec3> part;
    part.reserve(std::size_t(at.width()) * std::size_t(at.height()));
    for (int y = at.top; y < at.bottom; ++y)
        for (int x = at.left; x < at.right; ++x)
            part.push_back(colour(std::size_t(y) * std::size_t(width) + std::size_t(x)));
    return part;
}

/// Whether `same` holds for all pixels of the rectangle.
template <class Same>
bool all_of(const Same& same, int width, const Rectangle& at) {
    for (int y = at.top; y < at.bottom; ++y)
        for (int x = at.left; x < at.right; ++x)
            if (!same(std::size_t(y) * std::size_t(width) + std::size_t(x))) return false;
    return true;
}

/// FLIP of each pixel, for pictures whose pixel i is `reference(i)` and `test(i)`, linear RGB in [0, 1]. Tiles are cut
/// out with all that their pixels' filters reach, so that the values are those of whole_error_map to the last bit;
/// those without a difference are 0 and not computed, nor are their colours where `same(i)` says that they would be
/// alike.
template <class Same, class Reference, class Test>
std::vector<float> error_map(int width, int height, const Same& same, const Reference& reference, const Test& test,
                             double pixels_per_degree) {
    constexpr int kTile = 96;
    const int reach     = std::max(colour_radius(pixels_per_degree), feature_radius(pixels_per_degree));
    const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
    std::vector<float> map(std::size_t(width) * std::size_t(height));
    parallel_ranges(std::size_t(across) * std::size_t(down), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t tile = begin; tile < end; ++tile) {
            const int left = int(tile) % across * kTile, top = int(tile) / across * kTile;
            const Rectangle inside{left, top, std::min(left + kTile, width), std::min(top + kTile, height)};
            const Rectangle seen{std::max(left - reach, 0), std::max(top - reach, 0),
                                 std::min(inside.right + reach, width), std::min(inside.bottom + reach, height)};
            if (all_of(same, width, seen)) continue;
            const std::vector<vec3> a = cut(reference, width, seen), b = cut(test, width, seen);
            if (a == b) continue;
            const std::vector<float> part = whole_error_map(seen.width(), seen.height(), a, b, pixels_per_degree);
            for (int y = inside.top; y < inside.bottom; ++y)
                for (int x = inside.left; x < inside.right; ++x)
                    map[std::size_t(y) * std::size_t(width) + std::size_t(x)] =
                        part[std::size_t(y - seen.top) * std::size_t(seen.width()) + std::size_t(x - seen.left)];
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
    std::sort(sorted.begin(), sorted.end());
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

/// Narkowicz' fit of the ACES curve, exposed as the ACES reference is: x is multiplied by 0.6 first.
struct Aces {
    static constexpr double kScale = 0.6, kA = 2.51, kB = 0.03, kC = 2.43, kD = 0.59, kE = 0.14;
    static float toned(float x) {
        if (x > 100) return 1;  // the curve passes 1 long before; squares of larger values could overflow
        const float s = float(kScale) * x;
        return std::clamp(s * (float(kA) * s + float(kB)) / (s * (float(kC) * s + float(kD)) + float(kE)), 0.0f, 1.0f);
    }
    /// Where the curve reaches y: the larger root of (A - y C) s^2 + (B - y D) s - y E = 0.
    static double inverse(double y) {
        const double a = kA - y * kC, b = kB - y * kD, c = -y * kE;
        return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a) / kScale;
    }
};

/// From the exposure at which the brightest pixel of the reference is just not burnt out to that at which its median
/// is.
struct Exposures {
    double start = 0, stop = 0;
    int count = 2;
};
Exposures find_exposures(const std::vector<vec3>& reference) {
    std::vector<float> luminance(reference.size());
    parallel_ranges(luminance.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) luminance[i] = (white_from_rgb() * reference[i]).y;
    });
    const auto middle = luminance.begin() + std::ptrdiff_t(luminance.size() / 2);
    std::nth_element(luminance.begin(), middle, luminance.end());
    // Black has no exposure that makes it bright.
    const double darkest = std::numeric_limits<float>::epsilon();
    const double median  = std::max(double(*middle), darkest);
    const double largest = std::max(double(*std::max_element(luminance.begin(), luminance.end())), darkest);
    const double bright  = Aces::inverse(0.85);
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
    const auto light    = [](float x) { return x > 0 ? linear_from_srgb(std::min(x, 1.0f)) : 0.0f; };  // NaN: 0
    const auto a = colour_of(reference, as_it_is), b = colour_of(test, as_it_is);
    const auto same = [&](std::size_t i) { return a(i) == b(i); };
    return pooled(error_map(reference.width, reference.height, same, colour_of(reference, light),
                            colour_of(test, light), pixels_per_degree));
}

Flip flip_hdr(const Image& reference, const Image& test, double pixels_per_degree) {
    check_same_size(reference, test, "flip");
    const auto light          = [](float x) { return x > 0 ? std::min(x, 1e15f) : 0.0f; };  // NaN: 0
    const std::vector<vec3> a = colours(reference.pixels(), colour_of(reference, light));
    const std::vector<vec3> b = colours(test.pixels(), colour_of(test, light));
    const Exposures exposures = find_exposures(a);
    const auto same           = [&](std::size_t i) { return a[i] == b[i]; };

    std::vector<float> worst(a.size());
    for (int k = 0; k < exposures.count; ++k) {
        const double exposure = exposures.start + (exposures.stop - exposures.start) * k / (exposures.count - 1);
        const float factor    = float(std::exp2(exposure));
        const auto toned      = [factor](const std::vector<vec3>& rgb) {
            return [factor, &rgb](std::size_t i) {
                return vec3(Aces::toned(factor * rgb[i].x), Aces::toned(factor * rgb[i].y),
                                 Aces::toned(factor * rgb[i].z));
            };
        };
        const std::vector<float> map =
            error_map(reference.width, reference.height, same, toned(a), toned(b), pixels_per_degree);
        for (std::size_t i = 0; i < map.size(); ++i) worst[i] = std::max(worst[i], map[i]);
    }
    Flip flip           = pooled(std::move(worst));
    flip.start_exposure = exposures.start;
    flip.stop_exposure  = exposures.stop;
    flip.exposures      = exposures.count;
    return flip;
}

}  // namespace umbra
