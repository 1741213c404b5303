// Moments of a depth map in a summed-area table: the mean over a window of any size and position from sixteen entries.
//
// Franklin Crow. Summed-Area Tables for Texture Mapping. 1984
// Andrew Lauritzen. Summed-Area Variance Shadow Maps. GPU Gems 3. 2007
// Christoph Peters, Cedrick Muenstermann, Nico Wetzstein, Reinhard Klein. Improved Moment Shadow Maps for Translucent
// Occluders, Soft Shadows and Single Scattering. 2017 (integers that wrap around)
#pragma once

#include <memory>

#include "umbra/shadows/filtered/moment_map.h"

namespace umbra {

/// The mean of a window.
struct WindowedDepth : FilteredDepth {
    double depth = 1;  ///< mean linear depth of the drawn samples
};

/// Sums are 64-bit integers that wrap around: a difference of four entries is the window's sum without any rounding,
/// as long as that sum itself fits, whatever the table holds. All that is rounded is each sample's moment, to
/// 2^-bits() of the largest that it can have. Sums of floats would keep 24 bits of the sum of all, which leaves nothing
/// of a small window.
class SummedMoments {
public:
    /// Exponentials spread over exp(2 c) to exp(-2 c), and of the least bits() must keep some.
    static constexpr double kMostExponent = 5;

    /// Windows of at most `widest` samples a side are asked for. Exponents of `bound` are kMostExponent at most.
    /// Parallel; the same bits for any number of threads.
    SummedMoments(const MapView& view, const MomentBound& bound, EmptySamples empty, double widest);

    /// Over the window from `low` to `high`, in samples, 0 the map's border; low < high. A sample counts by how much of
    /// it the window covers. Samples outside the map are empty.
    [[nodiscard]] WindowedDepth mean(dvec2 low, dvec2 high) const;

    /// Bits of the fraction: 62 less those of the number of samples of the widest window.
    [[nodiscard]] int bits() const { return bits_; }
    [[nodiscard]] std::size_t memory_bytes() const { return numbers() * sizeof(std::uint64_t); }

    /// Bytes that a sample takes.
    [[nodiscard]] static int bytes_per_sample(MomentKind kind, EmptySamples empty);

private:
    /// Moments, the depth where it is none of them, and where empty samples are apart the drawn fraction.
    static constexpr int kMostChannels = 6;
    using Channels                     = std::array<double, kMostChannels>;

    [[nodiscard]] std::size_t numbers() const {
        return static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1) * channels_;
    }
    [[nodiscard]] Channels of_depth(double z) const;
    void sum_rows(const MapView& view);
    void sum_columns();

    int width_, height_, channels_, bits_;
    MomentBound bound_;
    EmptySamples empty_;
    Channels unit_{};      ///< what 1 is worth in each channel: the largest that it can be, over 2^bits()
    Channels of_empty_{};  ///< what an empty sample has
    std::unique_ptr<std::uint64_t[]> sums_;  ///< of all samples before a column and above a row
};

}  // namespace umbra
