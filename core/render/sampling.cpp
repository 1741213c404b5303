// This work is based on:
// Art Owen. Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences. 1995
// Brent Burley. Practical Hash-based Owen Scrambling. 2020
// Nathan Vegdahl. Building a Better LK Hash. 2021
// Martin Roberts. The Unreasonable Effectiveness of Quasirandom Sequences. 2018
// Peter Shirley, Kenneth Chiu. A Low Distortion Map Between Disk and Square. 1997
#include "umbra/core/render/sampling.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "umbra/core/base/lanes.h"

namespace umbra {
namespace {

constexpr std::uint32_t kGolden = 0x9e3779b9u;  // 2^32 / golden ratio: steps that visit all words evenly

/// A bijection of words whose every output bit depends on every input bit [Chris Wellons, Prospecting for Hash
/// Functions, 2018].
constexpr std::uint32_t mix(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

constexpr std::uint32_t reversed(std::uint32_t x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
    x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
    return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
}

/// Nested uniform scrambling of a word whose bits are reversed: each bit is flipped or not by a hash of the seed and
/// the bits below it, since additions and multiplications carry upwards only.
constexpr std::uint32_t owen_scrambled(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// The upper 24 bits as a fraction, [0, 1).
float fraction(std::uint32_t x) { return static_cast<float>(static_cast<std::int32_t>(x >> 8)) * 0x1p-24f; }

/// A sum of two fractions may round up to 1.
constexpr float kBelowOne = 1 - 0x1p-24f;

}  // namespace

SampleSet::SampleSet(Sampler sampler, int count, std::uint32_t seed) : sampler_(sampler), count_(count), seed_(seed) {
    if (count < 1) throw std::invalid_argument("a sample set needs samples");
    const auto blocks = static_cast<std::size_t>(count + 7) / 8;
    if (sampler == Sampler::stratified || sampler == Sampler::regular) {
        // Rows as high as the fraction of the samples that they hold, so that the cells have equal areas for any count.
        cells_.resize(blocks);
        const int rows = std::max(1, static_cast<int>(std::lround(std::sqrt(count))));
        int i          = 0;
        for (int row = 0; row < rows; ++row) {
            const int begin = static_cast<int>(static_cast<std::int64_t>(count) * row / rows);
            const int end   = static_cast<int>(static_cast<std::int64_t>(count) * (row + 1) / rows);
            for (; i < end; ++i) {
                Cell& c         = cells_[i / 8];
                c.width[i % 8]  = 1.0f / static_cast<float>(end - begin);
                c.height[i % 8] = static_cast<float>(end - begin) / static_cast<float>(count);
                c.x[i % 8]      = static_cast<float>(i - begin) / static_cast<float>(end - begin);
                c.y[i % 8]      = static_cast<float>(begin) / static_cast<float>(count);
            }
        }
    } else if (sampler == Sampler::sobol) {
        words_.resize(blocks);
        std::uint32_t directions[32] = {0x80000000u};  // of the second dimension; the first one is the index reversed
        for (int k = 1; k < 32; ++k) directions[k] = directions[k - 1] ^ (directions[k - 1] >> 1);
        for (std::uint32_t i = 0; i < 8 * blocks; ++i) {
            std::uint32_t y = 0;
            for (int k = 0; k < 32; ++k)
                if (i >> k & 1u) y ^= directions[k];
            words_[i / 8].x[i % 8] = i;
            words_[i / 8].y[i % 8] = reversed(y);
        }
    } else if (sampler == Sampler::r2) {
        words_.resize(blocks);
        constexpr double plastic = 1.32471795724474602596;  // x^3 = x + 1
        const auto step_x        = static_cast<std::uint32_t>(0x1p32 / plastic);
        const auto step_y        = static_cast<std::uint32_t>(0x1p32 / (plastic * plastic));
        for (std::uint32_t i = 0; i < 8 * blocks; ++i) {
            words_[i / 8].x[i % 8] = (i + 1) * step_x;
            words_[i / 8].y[i % 8] = (i + 1) * step_y;
        }
    }
}

PointKey SampleSet::key(std::uint64_t point) const {
    const std::uint32_t low = mix(static_cast<std::uint32_t>(point) + mix(seed_ + kGolden));
    const std::uint32_t all = low ^ mix(static_cast<std::uint32_t>(point >> 32) + 0x51ed270bu);
    return {mix(all + 0x2c1b3c6du), mix(all ^ 0x297a2d39u)};
}

UMBRA_FOR_EACH_PROCESSOR void SampleSet::eight(PointKey key, int first, Samples8& out) const {
    const std::size_t block = static_cast<std::size_t>(first) / 8;
    const auto base         = static_cast<std::uint32_t>(first);
    switch (sampler_) {
        case Sampler::random:
            for (std::uint32_t k = 0; k < 8; ++k) {
                out.x[k] = fraction(mix(key.x + (base + k) * kGolden));
                out.y[k] = fraction(mix(key.y + (base + k) * kGolden));
            }
            break;
        case Sampler::stratified: {
            const Cell& c = cells_[block];
            for (std::uint32_t k = 0; k < 8; ++k) {
                out.x[k] = std::min(kBelowOne, c.x[k] + c.width[k] * fraction(mix(key.x + (base + k) * kGolden)));
                out.y[k] = std::min(kBelowOne, c.y[k] + c.height[k] * fraction(mix(key.y + (base + k) * kGolden)));
            }
            break;
        }
        case Sampler::regular: {
            const Cell& c = cells_[block];
            const float x = fraction(key.x), y = fraction(key.y);
            for (int k = 0; k < 8; ++k) {
                out.x[k] = std::min(kBelowOne, c.x[k] + c.width[k] * x);
                out.y[k] = std::min(kBelowOne, c.y[k] + c.height[k] * y);
            }
            break;
        }
        case Sampler::r2: {
            const Word& w = words_[block];
            for (int k = 0; k < 8; ++k) {  // words wrap around as fractions do
                out.x[k] = fraction(w.x[k] + key.x);
                out.y[k] = fraction(w.y[k] + key.y);
            }
            break;
        }
        case Sampler::sobol: {
            const Word& w = words_[block];
            for (int k = 0; k < 8; ++k) {
                out.x[k] = fraction(reversed(owen_scrambled(w.x[k], key.x)));
                out.y[k] = fraction(reversed(owen_scrambled(w.y[k], key.y)));
            }
            break;
        }
    }
}

std::size_t SampleSet::memory_bytes() const { return cells_.size() * sizeof(Cell) + words_.size() * sizeof(Word); }

UMBRA_FOR_EACH_PROCESSOR void map_to_disk(Samples8& points) {
    // The one of the square's coordinates (a, b) that is farther from 0 becomes the radius, their quotient q an eighth
    // of a turn either way. The series of sine and cosine of q pi/4 err by less than 2^-26 for |q| <= 1.
    constexpr auto h = static_cast<float>(kPi / 4);
    for (int k = 0; k < 8; ++k) {
        const float a = 2 * points.x[k] - 1, b = 2 * points.y[k] - 1;
        const bool wide    = std::abs(a) > std::abs(b);
        const float radius = wide ? a : b, other = wide ? b : a;
        const float angle = radius != 0 ? h * other / radius : 0.0f;
        const float z     = angle * angle;
        const float along = radius * (1 + z * (-1 / 2.0f + z * (1 / 24.0f + z * (-1 / 720.0f + z * (1 / 40320.0f)))));
        const float across =
            radius * angle * (1 + z * (-1 / 6.0f + z * (1 / 120.0f + z * (-1 / 5040.0f + z * (1 / 362880.0f)))));
        points.x[k] = wide ? along : across;
        points.y[k] = wide ? across : along;
    }
}

bool tangent_disk(dvec3 p, dvec3 centre, double radius, TangentDisk& disk) {
    //            _.._          The cone from p touches the sphere where the angle at T is right, so that
    //      T  .'|    '.        cM = r^2 / d by similar triangles, and TM = r sqrt(d^2 - r^2) / d.
    //   .-'   : |  c  :
    //  p------:-M--.  :        d = |pc|, r = |cT|
    //   '-.   : |     :
    //      T' .'|.__.'
    const dvec3 to_p = p - centre;
    const double d2 = glm::dot(to_p, to_p), r2 = radius * radius;
    if (!(d2 > r2)) return false;
    const double d = std::sqrt(d2);
    const dvec3 n  = to_p / d;
    // Two perpendiculars to n, without a branch except for the sign [Tom Duff et al., Building an Orthonormal Basis,
    // Revisited, 2017].
    const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    const double size = radius * std::sqrt(d2 - r2) / d;
    disk.centre       = centre + n * (r2 / d);
    disk.axis_u       = dvec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x) * size;
    disk.axis_v       = dvec3(b, sign + n.y * n.y * a, -n.y) * size;
    return true;
}

}  // namespace umbra
