// A depth map as means of moments: what a filter may average, unlike depth itself.
#pragma once

#include <memory>
#include <variant>

#include "umbra/shadows/filtered/moments.h"
#include "umbra/shadows/maps/light_views.h"

namespace umbra {

/// The numbers that means are kept in. They are computed in double.
enum class MomentPrecision : std::uint8_t { single, twofold };

/// The value of a sample on which nothing was drawn.
enum class EmptySamples : std::uint8_t {
    far,   ///< depth 1
    apart  ///< nothing: the map keeps the fraction that was drawn, and the moments of that
};

/// The depth of a nearness: 0 on the frame's near plane and before it, 1 on the far plane; linear, behind that, too, up
/// to 1e6.
[[nodiscard]] double linear_depth(const LightFrame& frame, double nearness);

/// Means of moments about a position.
struct FilteredDepth {
    double drawn = 1;   ///< fraction of the filter with something to block light, [0, 1]
    Moments moments{};  ///< of that
};

class MomentMap {
public:
    /// Each sample is the mean over the box of (2 radius + 1)^2 samples of the view's map about it; samples outside the
    /// map are empty. Parallel; the same bits for any number of threads.
    MomentMap(const MapView& view, const MomentBound& bound, int radius, EmptySamples empty, MomentPrecision precision);

    /// Bilinear between samples, at `x` to the right and `y` down in samples, 0 the map's border: the mean over a box
    /// that moves with the position. Samples outside the map are empty.
    [[nodiscard]] FilteredDepth at(double x, double y) const;

    [[nodiscard]] std::size_t memory_bytes() const;

    /// Bytes that a sample takes.
    [[nodiscard]] static int bytes_per_sample(MomentKind kind, EmptySamples empty, MomentPrecision precision);

private:
    /// Moments and, where empty samples are apart, the drawn fraction, with which the moments are multiplied.
    static constexpr int kMostChannels = 5;
    using Channels                     = std::array<double, kMostChannels>;

    [[nodiscard]] static int channel_count(MomentKind kind, EmptySamples empty) {
        return moment_count(kind) + (empty == EmptySamples::apart ? 1 : 0);
    }
    [[nodiscard]] std::size_t numbers() const { return static_cast<std::size_t>(width_) * height_ * channels_; }
    template <class Number>
    void fill(Number* kept, const MapView& view, const MomentBound& bound, int radius) const;
    template <class Number>
    [[nodiscard]] Channels mean(const Number* kept, double x, double y) const;

    int width_, height_, channels_;
    EmptySamples empty_;
    Channels of_empty_{};  ///< what an empty sample has
    std::variant<std::unique_ptr<float[]>, std::unique_ptr<double[]>> kept_;
};

}  // namespace umbra
