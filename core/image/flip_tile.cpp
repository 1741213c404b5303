#include "umbra/core/image/flip_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/math.h"

namespace umbra::flip {
namespace {

// The constants of the 2020 paper.
constexpr double kColourExponent = 0.7;    // q_c
constexpr double kKnee           = 0.4;    // p_c: this fraction of the largest colour difference ...
constexpr double kKneeError      = 0.95;   // p_t: ... is mapped to this error
constexpr double kFeatureWidth   = 0.082;  // w, degrees of visual angle; the exponent q_f is 0.5, a square root

// -- Filters

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

/// A term of a sensitivity in space: a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees of visual angle.
struct Term {
    double a, b;
};
constexpr double kWidest = 0.04;  // the largest b below: all channels are filtered with its radius

template <std::size_t N>
std::array<Filters::Pass, N> sensitivity(const std::array<Term, N>& terms, double pixels_per_degree) {
    const int radius  = int(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * pixels_per_degree));
    const auto kernel = [&](double b) {
        return gaussian(radius, kPi * kPi / (b * pixels_per_degree * pixels_per_degree));
    };
    double total = 0;  // of the two-dimensional filter
    for (const auto& [a, b] : terms) {
        const double sum = sum_of(kernel(b));
        total += a * std::sqrt(kPi / b) * sum * sum;
    }
    std::array<Filters::Pass, N> passes;
    for (std::size_t k = 0; k < N; ++k) {
        const auto& [a, b] = terms[k];
        passes[k]          = {scaled(kernel(b), a * std::sqrt(kPi / b) / total), kernel(b)};
    }
    return passes;
}

/// Pixels of a row that are filtered at once: sums enough for a processor that adds eight numbers in a cycle and waits
/// four for the result.
constexpr int kBlock = 32;
using Floats         = Lanes<float>;

std::size_t whole_blocks(int width) { return static_cast<std::size_t>((width + kBlock - 1) / kBlock * kBlock); }

/// Adds weight * from[0 .. 7]. By reference: processors differ in how they return eight floats.
void add_weighted(Floats& sum, float weight, const float* from) {
    Floats lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    sum += weight * lanes;
}

/// A block of sums of kernel[k] * in[k * step]; `in` is where the kernel's first weight goes.
void filter(const float* in, std::size_t step, const Kernel& kernel, float* out) {
    Floats a{}, b{}, c{}, d{};
    for (const float weight : kernel) {
        add_weighted(a, weight, in), add_weighted(b, weight, in + kLanes);
        add_weighted(c, weight, in + 2 * kLanes), add_weighted(d, weight, in + 3 * kLanes);
        in += step;
    }
    std::memcpy(out, &a, sizeof a), std::memcpy(out + kLanes, &b, sizeof b);
    std::memcpy(out + 2 * kLanes, &c, sizeof c), std::memcpy(out + 3 * kLanes, &d, sizeof d);
}

// -- Colours

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

/// The float next to the root for t in [2^-7, 2], or the one after: a guess from the exponent, and two steps after
/// Halley, each of which makes three times as many digits right.
[[gnu::always_inline]] inline float cube_root(float t) {
    const float third = static_cast<float>(std::bit_cast<std::int32_t>(t)) * (1.0f / 3);
    const float guess = std::bit_cast<float>(static_cast<std::int32_t>(third + 709921077.0f));
    const float cube  = guess * guess * guess;
    const double near = guess * ((cube + 2 * t) / (2 * cube + t));
    const double wide = t, of_near = near * near * near;
    return static_cast<float>(near * ((of_near + 2 * wide) / (2 * of_near + wide)));
}

[[gnu::always_inline]] inline float lab_curve(float t) {
    constexpr float kDelta = 6.0f / 29, kLinear = kDelta * kDelta * kDelta;
    const float root = cube_root(std::max(t, kLinear));
    return t > kLinear ? root : t / (3 * kDelta * kDelta) + 4.0f / 29;
}

struct Lab {
    float l, a, b;
};

/// L*a*b* with Hunt's effect: colours are less colourful where there is less light.
[[gnu::always_inline]] inline Lab hunt_lab(const mat3& m, float r, float g, float b) {
    const float x = lab_curve(m[0][0] * r + m[1][0] * g + m[2][0] * b);
    const float y = lab_curve(m[0][1] * r + m[1][1] * g + m[2][1] * b);
    const float z = lab_curve(m[0][2] * r + m[1][2] * g + m[2][2] * b);
    const float l = 116 * y - 16;
    return {l, 0.01f * l * 500 * (x - y), 0.01f * l * 200 * (y - z)};
}

/// HyAB: city block between lightness and chroma, which suits large differences better than a Euclidean distance.
[[gnu::always_inline]] inline float hyab(float dl, float da, float db) {
    return std::abs(dl) + std::sqrt(da * da + db * db);
}

// -- Powers, for loops over lanes. With std::pow these would be calls, and its last bits differ between libraries.

/// The logarithm to base 2 of a normal number above 0, within 1e-11.
[[gnu::always_inline]] inline double log_2(double x) {
    constexpr std::uint64_t kMantissa = 0x000fffffffffffff;
    constexpr double kShift           = 0x1p52;  // a whole number in the last bits of kShift + it
    constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcd;
    // x = m 2^e, m in [sqrt(1/2), sqrt(2))
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) - kSqrtHalf;
    const std::uint64_t from = (bits + (std::uint64_t{1024} << 52)) >> 52;  // e + 1024
    const double e           = std::bit_cast<double>(from | std::bit_cast<std::uint64_t>(kShift)) - (kShift + 1024);
    const double m           = std::bit_cast<double>((bits & kMantissa) + kSqrtHalf);
    const double s = (m - 1) / (m + 1), q = s * s;
    const double series =
        1 + q * (1.0 / 3 + q * (1.0 / 5 + q * (1.0 / 7 + q * (1.0 / 9 + q * (1.0 / 11 + q * (1.0 / 13))))));
    return e + 2.885390081777927 * s * series;
}

/// 2^x for x in [-1000, 1000], with a relative error below 1e-11.
[[gnu::always_inline]] inline double exp_2(double x) {
    constexpr double kRound = 0x1.8p52;
    const double shifted    = x + kRound;  // the whole number next to x in its last bits
    const double f          = (x - (shifted - kRound)) * 0.6931471805599453;
    const double series =
        1 +
        f * (1 + f * (1.0 / 2 +
                      f * (1.0 / 6 +
                           f * (1.0 / 24 +
                                f * (1.0 / 120 +
                                     f * (1.0 / 720 + f * (1.0 / 5040 + f * (1.0 / 40320 + f * (1.0 / 362880)))))))));
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(series) + (std::bit_cast<std::uint64_t>(shifted) << 52));
}

/// x^e for x in [0, 1e30], e in [-1, 3]: 0^e is 0 for e above 0, else 1.
[[gnu::always_inline]] inline double power(double x, double e) {
    const double log   = std::clamp(e * log_2(std::max(x, 1e-300)), -1000.0, 1000.0);
    const double value = exp_2(log);
    return x > 0 ? value : e > 0 ? 0.0 : 1.0;
}

/// The largest colour difference that a display can show, green against blue, lies at 1. Most of [0, 1] is given to the
/// differences below the knee, since those above it are large in any case.
struct ErrorScale {
    float largest, knee;
    ErrorScale() {
        const mat3& m   = white_from_rgb();
        const Lab green = hunt_lab(m, 0, 1, 0), blue = hunt_lab(m, 0, 0, 1);
        largest = float(power(hyab(green.l - blue.l, green.a - blue.a, green.b - blue.b), kColourExponent));
        knee    = float(kKnee) * largest;
    }
};

/// Narkowicz' fit of the ACES curve, exposed as the ACES reference is: x is multiplied by 0.6 first.
struct Aces {
    static constexpr double kScale = 0.6, kA = 2.51, kB = 0.03, kC = 2.43, kD = 0.59, kE = 0.14;
};

}  // namespace

Filters::Filters(double pixels_per_degree) {
    y                  = sensitivity(std::array<Term, 1>{{{1, 0.0047}}}, pixels_per_degree)[0];
    cx                 = sensitivity(std::array<Term, 1>{{{1, 0.0053}}}, pixels_per_degree)[0];
    cz                 = sensitivity(std::array<Term, 2>{{{34.1, 0.04}, {13.5, 0.025}}}, pixels_per_degree);
    const double sigma = 0.5 * kFeatureWidth * pixels_per_degree;
    const int radius   = int(std::ceil(3 * sigma));
    smooth             = gaussian(radius, 1 / (2 * sigma * sigma));
    first = smooth, second = smooth;
    for (int i = -radius; i <= radius; ++i) {
        first[std::size_t(i + radius)] *= float(-i);
        second[std::size_t(i + radius)] *= float(i * i / (sigma * sigma) - 1);
    }
    smooth = scaled(smooth, 1 / sum_of(smooth));
    first  = balanced(first);
    second = balanced(second);
    reach  = std::max(int(y.row.size()), int(smooth.size())) / 2;
}

void Part::resize(int w, int h, int r) {
    width = w, height = h, reach = r;
    stride = whole_blocks(w) + 2 * static_cast<std::size_t>(r);
    for (auto& plane : rgb) plane.resize(stride * static_cast<std::size_t>(h + 2 * r));
}

UMBRA_FOR_EACH_PROCESSOR void see(const Filters& filters, const Part& part, Workspace& workspace, Seen& seen) {
    // Opponent space, linear in light (unlike L*a*b*), so that filters may run in it.
    const std::size_t stride = part.stride, all_rows = static_cast<std::size_t>(part.height + 2 * part.reach);
    const mat3 m = white_from_rgb(), back = rgb_from_white();
    for (auto& plane : workspace.ycxcz) plane.resize(part.rgb[0].size());
    for (std::size_t row = 0; row < all_rows; ++row) {
        const std::size_t at = row * stride, count = static_cast<std::size_t>(part.width + 2 * part.reach);
        const float* const r       = &part.rgb[0][at];
        const float* const g       = &part.rgb[1][at];
        const float* const b       = &part.rgb[2][at];
        float* __restrict const y  = &workspace.ycxcz[0][at];
        float* __restrict const cx = &workspace.ycxcz[1][at];
        float* __restrict const cz = &workspace.ycxcz[2][at];
        for (std::size_t x = 0; x < count; ++x) {
            const float t0 = m[0][0] * r[x] + m[1][0] * g[x] + m[2][0] * b[x];
            const float t1 = m[0][1] * r[x] + m[1][1] * g[x] + m[2][1] * b[x];
            const float t2 = m[0][2] * r[x] + m[1][2] * g[x] + m[2][2] * b[x];
            y[x] = 116 * t1 - 16, cx[x] = 500 * (t0 - t1), cz[x] = 200 * (t1 - t2);
        }
    }

    // Along rows. Edges and points are found in luminance, [0, 1]: (Y + 16) / 116.
    const std::size_t across = whole_blocks(part.width), reach = static_cast<std::size_t>(part.reach);
    const std::size_t colour = reach - filters.y.row.size() / 2, feature = reach - filters.smooth.size() / 2;
    auto& [y, cx, cz0, cz1, smooth, first, second] = workspace.rows;
    for (auto& plane : workspace.rows) plane.resize(across * all_rows);
    std::vector<float>& luminance = workspace.luminance;
    luminance.resize(stride);
    for (std::size_t row = 0; row < all_rows; ++row) {
        const float* const in_y  = &workspace.ycxcz[0][row * stride];
        const float* const in_cx = &workspace.ycxcz[1][row * stride];
        const float* const in_cz = &workspace.ycxcz[2][row * stride];
        for (std::size_t x = 0; x < stride; ++x) luminance[x] = (in_y[x] + 16) / 116;
        for (std::size_t x = 0; x < across; x += kBlock) {
            const std::size_t to = row * across + x;
            filter(in_y + x + colour, 1, filters.y.row, &y[to]);
            filter(in_cx + x + colour, 1, filters.cx.row, &cx[to]);
            filter(in_cz + x + colour, 1, filters.cz[0].row, &cz0[to]);
            filter(in_cz + x + colour, 1, filters.cz[1].row, &cz1[to]);
            filter(&luminance[x + feature], 1, filters.smooth, &smooth[to]);
            filter(&luminance[x + feature], 1, filters.first, &first[to]);
            filter(&luminance[x + feature], 1, filters.second, &second[to]);
        }
    }

    // Along columns, and the eye's response.
    seen.stride = across;
    for (auto* plane : {&seen.lightness, &seen.a, &seen.b, &seen.edges, &seen.points})
        plane->resize(across * static_cast<std::size_t>(part.height));
    for (std::size_t row = 0; row < static_cast<std::size_t>(part.height); ++row)
        for (std::size_t x = 0; x < across; x += kBlock) {
            const std::size_t of_colour = (row + colour) * across + x, of_feature = (row + feature) * across + x;
            float seen_y[kBlock], seen_cx[kBlock], seen_cz[kBlock], seen_cz1[kBlock], edge_x[kBlock], edge_y[kBlock],
                point_x[kBlock], point_y[kBlock];
            filter(&y[of_colour], across, filters.y.column, seen_y);
            filter(&cx[of_colour], across, filters.cx.column, seen_cx);
            filter(&cz0[of_colour], across, filters.cz[0].column, seen_cz);
            filter(&cz1[of_colour], across, filters.cz[1].column, seen_cz1);
            filter(&first[of_feature], across, filters.smooth, edge_x);
            filter(&smooth[of_feature], across, filters.first, edge_y);
            filter(&second[of_feature], across, filters.smooth, point_x);
            filter(&smooth[of_feature], across, filters.second, point_y);
            const std::size_t to        = row * across + x;
            float* __restrict lightness = &seen.lightness[to];
            float* __restrict a         = &seen.a[to];
            float* __restrict b         = &seen.b[to];
            float* __restrict edges     = &seen.edges[to];
            float* __restrict points    = &seen.points[to];
#pragma GCC unroll 1
            for (int k = 0; k < kBlock; ++k) {
                const float t1 = (seen_y[k] + 16) / 116, t0 = t1 + seen_cx[k] / 500,
                            t2    = t1 - (seen_cz[k] + seen_cz1[k]) / 200;
                const float red   = back[0][0] * t0 + back[1][0] * t1 + back[2][0] * t2;
                const float green = back[0][1] * t0 + back[1][1] * t1 + back[2][1] * t2;
                const float blue  = back[0][2] * t0 + back[1][2] * t1 + back[2][2] * t2;
                const Lab lab     = hunt_lab(m, std::clamp(red, 0.0f, 1.0f), std::clamp(green, 0.0f, 1.0f),
                                             std::clamp(blue, 0.0f, 1.0f));
                lightness[k] = lab.l, a[k] = lab.a, b[k] = lab.b;
                edges[k]  = std::sqrt(edge_x[k] * edge_x[k] + edge_y[k] * edge_y[k]);
                points[k] = std::sqrt(point_x[k] * point_x[k] + point_y[k] * point_y[k]);
            }
        }
}

UMBRA_FOR_EACH_PROCESSOR void row_errors(const Seen& reference, const Seen& test, int y, std::span<float> errors) {
    static const ErrorScale scale;
    const float largest = scale.largest, knee = scale.knee;
    const std::size_t at  = static_cast<std::size_t>(y) * reference.stride;
    const float *const l0 = &reference.lightness[at], *const l1 = &test.lightness[at];
    const float *const a0 = &reference.a[at], *const a1 = &test.a[at];
    const float *const b0 = &reference.b[at], *const b1 = &test.b[at];
    const float *const e0 = &reference.edges[at], *const e1 = &test.edges[at];
    const float *const p0 = &reference.points[at], *const p1 = &test.points[at];
    float* __restrict const out = errors.data();
    const std::size_t count     = errors.size();
    for (std::size_t x = 0; x < count; ++x) {
        const float distance = hyab(l0[x] - l1[x], a0[x] - a1[x], b0[x] - b1[x]);
        const float d        = float(power(distance, float(kColourExponent)));
        const float below    = float(kKneeError) / knee * d;
        const float above    = float(kKneeError) + (d - knee) / (largest - knee) * float(1 - kKneeError);
        const float colour   = d < knee ? below : above;
        const float feature  = std::max(std::abs(e0[x] - e1[x]), std::abs(p0[x] - p1[x]));
        const float weight   = std::sqrt(feature / std::sqrt(2.0f));
        out[x]               = std::clamp(float(power(colour, 1 - weight)), 0.0f, 1.0f);
    }
}

void tone(std::span<const float> values, float exposure, std::span<float> toned) {
    const float* const from    = values.data();
    float* __restrict const to = toned.data();
    const std::size_t count    = values.size();
    for (std::size_t i = 0; i < count; ++i) {
        // The curve passes 1 long before 100; squares of larger values could overflow.
        const float s = float(Aces::kScale) * std::min(exposure * from[i], 100.0f);
        to[i]         = std::clamp(s * (float(Aces::kA) * s + float(Aces::kB)) /
                                       (s * (float(Aces::kC) * s + float(Aces::kD)) + float(Aces::kE)),
                                   0.0f, 1.0f);
    }
}

double untoned(double y) {
    // The larger root of (A - y C) s^2 + (B - y D) s - y E = 0.
    const double a = Aces::kA - y * Aces::kC, b = Aces::kB - y * Aces::kD, c = -y * Aces::kE;
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a) / Aces::kScale;
}

float luminance(float r, float g, float b) {
    const mat3& m = white_from_rgb();
    return m[0][1] * r + m[1][1] * g + m[2][1] * b;
}

void decode_srgb(std::span<float> values) {
    float* __restrict const x = values.data();
    const std::size_t count   = values.size();
    for (std::size_t i = 0; i < count; ++i) {
        const double v = x[i], curve = power((v + 0.055) / 1.055, 2.4);
        x[i] = float(v <= 0.04045 ? v / 12.92 : curve);
    }
}

}  // namespace umbra::flip
