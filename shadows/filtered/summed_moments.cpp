#include "umbra/shadows/filtered/summed_moments.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

bool is_exponential(MomentKind kind) { return kind != MomentKind::vsm && kind != MomentKind::msm; }

int summed_channels(MomentKind kind, EmptySamples empty) {
    return moment_count(kind) + (is_exponential(kind) ? 1 : 0) + (empty == EmptySamples::apart ? 1 : 0);
}

/// An interval of samples, cut where they begin to count in full and where they cease to.
struct Pieces {
    int count = 0;
    std::array<int, 4> at{};  ///< piece k holds the samples from at[k] to at[k + 1]
    std::array<double, 3> weight{};
};

Pieces pieces(double from, double to, int samples) {
    Pieces p;
    from = std::clamp(from, 0.0, static_cast<double>(samples)), to = std::clamp(to, 0.0, static_cast<double>(samples));
    if (!(from < to)) return p;
    const auto add = [&](int begin, int end, double weight) {
        p.at[p.count]     = begin;
        p.at[p.count + 1] = end;
        p.weight[p.count] = weight;
        ++p.count;
    };
    // Samples first to last are covered in full, and those on either side of them in part.
    const int first = static_cast<int>(std::ceil(from)), last = static_cast<int>(to);
    if (first > last) {
        add(last, first, to - from);
        return p;
    }
    if (from < first) add(first - 1, first, first - from);
    if (first < last) add(first, last, 1);
    if (last < to) add(last, last + 1, to - last);
    return p;
}

}  // namespace

SummedMoments::SummedMoments(const MapView& view, const MomentBound& bound, EmptySamples empty, double widest)
    : width_(view.map.width()),
      height_(view.map.height()),
      channels_(summed_channels(bound.kind, empty)),
      bound_(bound),
      empty_(empty) {
    const double texels =
        std::min(widest + 2, static_cast<double>(width_)) * std::min(widest + 2, static_cast<double>(height_));
    bits_ = std::min(52, 62 - static_cast<int>(std::ceil(std::log2(texels))));
    unit_.fill(1);
    if (is_exponential(bound.kind)) {
        const double c = std::exp(bound.positive), d = std::exp(bound.negative);
        std::copy_n(Channels{c, c * c, d, d * d}.begin(), moment_count(bound.kind), unit_.begin());
    }
    for (double& unit : unit_) unit = std::ldexp(unit, -bits_);
    if (empty == EmptySamples::far) of_empty_ = of_depth(1);
    // Not cleared, as in MomentMap.
    sums_ = std::make_unique_for_overwrite<std::uint64_t[]>(numbers());
    sum_rows(view);
    sum_columns();
}

SummedMoments::Channels SummedMoments::of_depth(double z) const {
    Channels c{};
    int k                 = 0;
    const Moments moments = moments_of(bound_, z);
    for (; k < moment_count(bound_.kind); ++k) c[k] = moments[k];
    if (is_exponential(bound_.kind)) c[k++] = 2 * z - 1;
    if (empty_ == EmptySamples::apart) c[k] = 1;
    return c;
}

void SummedMoments::sum_rows(const MapView& view) {
    const std::size_t pitch = static_cast<std::size_t>(width_ + 1) * channels_;
    Channels scale{};
    for (int k = 0; k < channels_; ++k) scale[k] = 1 / unit_[k];
    std::fill_n(sums_.get(), pitch, 0);
    const auto as_integer = [&](const Channels& c) {
        std::array<std::uint64_t, kMostChannels> all{};
        for (int k = 0; k < channels_; ++k)
            all[k] = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(c[k] * scale[k] + 0.5)));
        return all;
    };
    const auto nothing = as_integer(of_empty_);
    parallel_ranges(static_cast<std::size_t>(height_), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            std::uint64_t* to = sums_.get() + (y + 1) * pitch;
            std::array<std::uint64_t, kMostChannels> sum{};
            to = std::copy_n(sum.begin(), channels_, to);
            for (int x = 0; x < width_; ++x) {
                const int row    = static_cast<int>(y);
                const auto added = view.map.is_empty(x, row)
                                       ? nothing
                                       : as_integer(of_depth(linear_depth(view.frame, view.map.nearness(x, row))));
                for (int k = 0; k < channels_; ++k) sum[k] += added[k];
                to = std::copy_n(sum.begin(), channels_, to);
            }
        }
    });
}

void SummedMoments::sum_columns() {
    const std::size_t pitch = static_cast<std::size_t>(width_ + 1) * channels_;
    parallel_ranges(pitch, 512, [&](std::size_t begin, std::size_t end) {
        for (int y = 2; y <= height_; ++y) {
            std::uint64_t* const row         = sums_.get() + static_cast<std::size_t>(y) * pitch;
            const std::uint64_t* const above = row - pitch;
            for (std::size_t k = begin; k < end; ++k) row[k] += above[k];
        }
    });
}

WindowedDepth SummedMoments::mean(dvec2 low, dvec2 high) const {
    const Pieces across = pieces(low.x, high.x, width_);
    const Pieces down   = pieces(low.y, high.y, height_);
    const auto entries  = [&](int x, int y) {
        return sums_.get() + (static_cast<std::size_t>(y) * (width_ + 1) + x) * channels_;
    };
    Channels sum{};
    double inside = 0;
    for (int j = 0; j < down.count; ++j)
        for (int i = 0; i < across.count; ++i) {
            const double weight                 = across.weight[i] * down.weight[j];
            const std::uint64_t *const a        = entries(across.at[i], down.at[j]),
                                       *const b = entries(across.at[i + 1], down.at[j]),
                                       *const c = entries(across.at[i], down.at[j + 1]),
                                       *const d = entries(across.at[i + 1], down.at[j + 1]);
            for (int k = 0; k < channels_; ++k)
                sum[k] += weight * static_cast<double>(static_cast<std::int64_t>(d[k] - c[k] - b[k] + a[k]));
            inside += weight * (across.at[i + 1] - across.at[i]) * (down.at[j + 1] - down.at[j]);
        }
    const double whole = (high.x - low.x) * (high.y - low.y), outside = std::max(0.0, whole - inside);
    for (int k = 0; k < channels_; ++k) sum[k] = sum[k] * unit_[k] + outside * of_empty_[k];

    WindowedDepth window;
    double drawn = whole;
    if (empty_ == EmptySamples::apart) {
        drawn        = sum[channels_ - 1];
        window.drawn = std::min(drawn / whole, 1.0);
        if (!(drawn > 0)) return {{0, {}}, 1};
    }
    const int count = moment_count(bound_.kind);
    for (int k = 0; k < count; ++k) window.moments[k] = sum[k] / drawn;
    const double x = is_exponential(bound_.kind) ? sum[count] / drawn : window.moments[0];
    window.depth   = 0.5 * (x + 1);
    return window;
}

int SummedMoments::bytes_per_sample(MomentKind kind, EmptySamples empty) {
    return summed_channels(kind, empty) * static_cast<int>(sizeof(std::uint64_t));
}

}  // namespace umbra
