#include "umbra/shadows/filtered/moment_map.h"

#include <cmath>
#include <vector>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr double kDeepest = 1e6;
constexpr int kTileWidth = 128, kTileHeight = 64;  // with five channels in double, half a megabyte

}  // namespace

double linear_depth(const LightFrame& frame, double nearness) {
    const double r = std::min(nearness, 1.0);
    if (!frame.perspective) return std::min(1 - r, kDeepest);
    const double inverse = r * (frame.far / frame.near - 1) + 1;  // near over depth, in units of near over far
    return inverse * kDeepest > 1 - r ? (1 - r) / inverse : kDeepest;
}

MomentMap::MomentMap(const MapView& view, const MomentBound& bound, int radius, EmptySamples empty,
                     MomentPrecision precision)
    : width_(view.map.width()), height_(view.map.height()), channels_(channel_count(bound.kind, empty)), empty_(empty) {
    if (empty == EmptySamples::far) std::ranges::copy(moments_of(bound, 1), of_empty_.begin());
    // Not cleared: the tiles are filled in parallel, and memory that one thread touches first is slow to get.
    if (precision == MomentPrecision::twofold)
        kept_ = std::make_unique_for_overwrite<double[]>(numbers());
    else
        kept_ = std::make_unique_for_overwrite<float[]>(numbers());
    std::visit([&](const auto& kept) { fill(kept.get(), view, bound, radius); }, kept_);
}

template <class Number>
void MomentMap::fill(Number* kept, const MapView& view, const MomentBound& bound, int radius) const {
    const int side      = 2 * radius + 1;
    const double weight = 1.0 / (static_cast<double>(side) * side);
    const int across = (width_ + kTileWidth - 1) / kTileWidth, down = (height_ + kTileHeight - 1) / kTileHeight;
    const auto is_empty = [&](int x, int y) {
        return x < 0 || y < 0 || x >= width_ || y >= height_ || view.map.is_empty(x, y);
    };
    const auto are_empty = [&](int left, int right, int top, int bottom) {
        for (int y = top; y < bottom; ++y)
            for (int x = left; x < right; ++x)
                if (!is_empty(x, y)) return false;
        return true;
    };
    const auto sample = [&](int x, int y) -> Channels {
        if (is_empty(x, y)) return of_empty_;
        Channels c{};
        std::ranges::copy(moments_of(bound, linear_depth(view.frame, view.map.nearness(x, y))), c.begin());
        if (empty_ == EmptySamples::apart) c[static_cast<std::size_t>(channels_) - 1] = 1;
        return c;
    };
    const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    parallel_ranges(tiles, 1, [&](std::size_t begin, std::size_t end) {
        // Sums, not differences of running sums: those of exponentials would leave nothing of the small ones.
        std::vector<double> row, rows;
        for (std::size_t tile = begin; tile < end; ++tile) {
            const int left = static_cast<int>(tile) % across * kTileWidth, right = std::min(left + kTileWidth, width_);
            const int top           = static_cast<int>(tile) / across * kTileHeight,
                      bottom        = std::min(top + kTileHeight, height_);
            const std::size_t pitch = static_cast<std::size_t>(right - left) * channels_;
            const auto kept_row     = [&](int y) {
                return kept + (static_cast<std::size_t>(y) * width_ + left) * channels_;
            };
            if (are_empty(left - radius, right + radius, top - radius, bottom + radius)) {
                for (int y = top; y < bottom; ++y)
                    for (std::size_t k = 0; k < pitch; ++k)
                        kept_row(y)[k] = static_cast<Number>(of_empty_[k % static_cast<std::size_t>(channels_)]);
                continue;
            }
            row.resize(static_cast<std::size_t>(right - left + 2 * radius) * channels_);
            rows.assign(pitch * static_cast<std::size_t>(bottom - top + 2 * radius), 0);
            for (int y = top - radius; y < bottom + radius; ++y) {
                for (int x = left - radius; x < right + radius; ++x)
                    std::copy_n(sample(x, y).begin(), channels_,
                                row.begin() + static_cast<std::ptrdiff_t>(x - left + radius) * channels_);
                double* const sums = rows.data() + static_cast<std::size_t>(y - top + radius) * pitch;
                for (int i = 0; i < side; ++i)
                    for (std::size_t k = 0; k < pitch; ++k) sums[k] += row[static_cast<std::size_t>(i) * channels_ + k];
            }
            for (int y = top; y < bottom; ++y) {
                row.assign(pitch, 0);
                for (int i = 0; i < side; ++i)
                    for (std::size_t k = 0; k < pitch; ++k)
                        row[k] += rows[static_cast<std::size_t>(y - top + i) * pitch + k];
                Number* const to = kept_row(y);
                for (std::size_t k = 0; k < pitch; ++k) to[k] = static_cast<Number>(weight * row[k]);
            }
        }
    });
}

template <class Number>
MomentMap::Channels MomentMap::mean(const Number* kept, double x, double y) const {
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    const double fx = x - 0.5 - left, fy = y - 0.5 - top;
    Channels sum{};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const int sx         = static_cast<int>(left) + i;
            const int sy         = static_cast<int>(top) + j;
            const double weight  = (i == 0 ? 1 - fx : fx) * (j == 0 ? 1 - fy : fy);
            const bool outside   = sx < 0 || sy < 0 || sx >= width_ || sy >= height_;
            const std::size_t at = outside ? 0 : (static_cast<std::size_t>(sy) * width_ + sx) * channels_;
            for (int k = 0; k < channels_; ++k)
                sum[k] += weight * (outside ? of_empty_[k] : static_cast<double>(kept[at + k]));
        }
    return sum;
}

FilteredDepth MomentMap::at(double x, double y) const {
    const Channels c = std::visit([&](const auto& kept) { return mean(kept.get(), x, y); }, kept_);
    FilteredDepth filtered;
    if (empty_ == EmptySamples::apart) filtered.drawn = c[static_cast<std::size_t>(channels_) - 1];
    if (filtered.drawn <= 0) return {0, {}};
    for (int k = 0; k < channels_ - (empty_ == EmptySamples::apart ? 1 : 0); ++k)
        filtered.moments[k] = c[k] / filtered.drawn;
    filtered.drawn = std::min(filtered.drawn, 1.0);
    return filtered;
}

std::size_t MomentMap::memory_bytes() const {
    return std::visit([&](const auto& kept) { return numbers() * sizeof(kept[0]); }, kept_);
}

int MomentMap::bytes_per_sample(MomentKind kind, EmptySamples empty, MomentPrecision precision) {
    const std::size_t number = precision == MomentPrecision::single ? sizeof(float) : sizeof(double);
    return channel_count(kind, empty) * static_cast<int>(number);
}

}  // namespace umbra
