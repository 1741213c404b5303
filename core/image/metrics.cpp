#include "umbra/core/image/metrics.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// Pairs of channel indices of the same name.
std::vector<std::pair<std::size_t, std::size_t>> common_channels(const Image& a, const Image& b) {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t c = 0; c < a.channels.size(); ++c) {
        const auto found = std::find(b.channels.begin(), b.channels.end(), a.channels[c]);
        if (found != b.channels.end()) pairs.emplace_back(c, std::size_t(found - b.channels.begin()));
    }
    return pairs;
}

/// One row of the sums behind ImageError: rows are added up in order, whatever thread made them.
struct RowSums {
    double absolute = 0, squared = 0, a = 0, b = 0, max = 0;
    int worst_x = 0, worst_channel = 0;
    std::size_t values = 0, differing = 0, over = 0, not_finite = 0, unlike_not_finite = 0;
};

std::vector<double> luminance(const Image& image) {
    const auto [r, g, b] = colour_channels(image);
    const auto finite    = [](float x) { return std::isfinite(x) ? double(x) : 0.0; };
    std::vector<double> y(image.pixels());
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] = r == g ? finite(image.at(i, r))
                      : 0.2126 * finite(image.at(i, r)) + 0.7152 * finite(image.at(i, g)) +
                            0.0722 * finite(image.at(i, b));
    return y;
}

std::vector<double> window(int side) {
    constexpr double kSigma = 1.5;
    const int length        = std::min(side, 11);
    std::vector<double> weights;
    double sum = 0;
    for (int i = 0; i < length; ++i) {
        const double x = i - 0.5 * (length - 1);
        weights.push_back(std::exp(-x * x / (2 * kSigma * kSigma)));
        sum += weights.back();
    }
    for (double& w : weights) w /= sum;
    return weights;
}

/// Weighted sums of a window, in the order a, b, a^2, b^2, a b.
using Moments = std::array<double, 5>;

double similarity(const Moments& m) {
    constexpr double c1 = 0.01 * 0.01;
    constexpr double c2 = 0.03 * 0.03;
    const double mean_a = m[0], mean_b = m[1];
    const double variance_a = m[2] - mean_a * mean_a;
    const double variance_b = m[3] - mean_b * mean_b;
    const double covariance = m[4] - mean_a * mean_b;
    return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
           ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
}

}  // namespace

ImageError image_error(const Image& a, const Image& b, double threshold) {
    check_same_size(a, b, "metrics");
    const auto channels = common_channels(a, b);
    std::vector<RowSums> rows(std::size_t(a.height));
    parallel_ranges(rows.size(), 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) {
            RowSums& row = rows[y];
            for (int x = 0; x < a.width; ++x) {
                const std::size_t i = y * std::size_t(a.width) + std::size_t(x);
                bool differs = false, over = false;
                for (const auto& [in_a, in_b] : channels) {
                    const double va = a.at(i, in_a);
                    const double vb = b.at(i, in_b);
                    const bool same = va == vb || (std::isnan(va) && std::isnan(vb));
                    differs |= !same;
                    if (!std::isfinite(va) || !std::isfinite(vb)) {
                        ++row.not_finite;
                        row.unlike_not_finite += !same;
                        over |= !same;
                        continue;
                    }
                    const double difference = std::abs(va - vb);
                    over |= difference > threshold;
                    ++row.values;
                    row.a += va;
                    row.b += vb;
                    row.absolute += difference;
                    row.squared += difference * difference;
                    if (difference > row.max) {
                        row.max           = difference;
                        row.worst_x       = x;
                        row.worst_channel = int(in_a);
                    }
                }
                row.differing += differs;
                row.over += over;
            }
        }
    });

    ImageError error;
    double squared = 0;
    for (std::size_t y = 0; y < rows.size(); ++y) {
        const RowSums& row = rows[y];
        error.mae += row.absolute;
        squared += row.squared;
        error.mean_a += row.a;
        error.mean_b += row.b;
        error.values += row.values;
        error.differing += row.differing;
        error.over += row.over;
        error.not_finite += row.not_finite;
        error.unlike_not_finite += row.unlike_not_finite;
        if (row.max > error.max) {
            error.max   = row.max;
            error.worst = {row.worst_x, int(y), row.worst_channel};
        }
    }
    const double n = double(std::max<std::size_t>(1, error.values));
    error.mae /= n;
    error.mean_a /= n;
    error.mean_b /= n;
    error.rmse = std::sqrt(squared / n);
    error.psnr = squared > 0 ? -20 * std::log10(error.rmse) : double(kInfinity);
    return error;
}

double ssim(const Image& a, const Image& b) {
    check_same_size(a, b, "metrics");
    const std::vector<double> ya     = luminance(a);
    const std::vector<double> yb     = luminance(b);
    const std::vector<double> across = window(a.width);
    const std::vector<double> down   = window(a.height);
    const std::size_t width          = std::size_t(a.width);
    const std::size_t windows_across = width - across.size() + 1;
    const std::size_t windows_down   = std::size_t(a.height) - down.size() + 1;

    // A window with the same values in both has the similarity 1 to the last bit: it is not computed.
    std::vector<double> sums(windows_down);
    parallel_ranges(windows_down, 8, [&](std::size_t begin, std::size_t end) {
        std::vector<Moments> columns(width);
        std::vector<std::size_t> differing(width + 1);  // columns of the windows' rows, before each, that differ
        for (std::size_t y = begin; y < end; ++y) {
            for (std::size_t x = 0; x < width; ++x) {
                bool differs = false;
                for (std::size_t k = 0; k < down.size(); ++k)
                    differs |= ya[(y + k) * width + x] != yb[(y + k) * width + x];
                differing[x + 1] = differing[x] + (differs ? 1 : 0);
            }
            if (differing[width] == 0) {
                sums[y] = double(windows_across);
                continue;
            }
            std::fill(columns.begin(), columns.end(), Moments{});
            for (std::size_t k = 0; k < down.size(); ++k) {
                for (std::size_t x = 0; x < width; ++x) {
                    const double va = ya[(y + k) * width + x];
                    const double vb = yb[(y + k) * width + x];
                    const Moments m{va, vb, va * va, vb * vb, va * vb};
                    for (std::size_t q = 0; q < m.size(); ++q) columns[x][q] += down[k] * m[q];
                }
            }
            for (std::size_t x = 0; x < windows_across; ++x) {
                if (differing[x + across.size()] == differing[x]) {
                    sums[y] += 1;
                    continue;
                }
                Moments m{};
                for (std::size_t k = 0; k < across.size(); ++k)
                    for (std::size_t q = 0; q < m.size(); ++q) m[q] += across[k] * columns[x + k][q];
                sums[y] += similarity(m);
            }
        }
    });
    double sum = 0;
    for (const double row : sums) sum += row;
    return sum / double(windows_across * windows_down);
}

}  // namespace umbra
