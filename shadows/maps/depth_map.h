// Depth maps: what is nearest to the light along each direction.
//
// Kept as *nearness* r: 1 on the near plane, 0 on the far one, affine in 1/z (perspective) or in z (orthographic),
// hence linear over the map. Reversed so that floating point spends its fine steps where 1/z has its coarse ones.
// [Eugene Lapidous, Guofang Jiao, Optimal Depth Buffer for Low-Cost Graphics Hardware, 1999]
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/math.h"
#include "umbra/shadows/maps/rasteriser.h"

namespace umbra {

class DepthMap {
public:
    /// Cleared, in parallel. Every sample takes 4 bytes, whatever the format.
    DepthMap(int width, int height, DepthFormat format);
    /// As newly made, in the same memory: new memory costs more than drawing a small scene.
    void clear();

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] DepthFormat format() const { return format_; }
    [[nodiscard]] std::size_t memory_bytes() const { return samples() * sizeof(words_[0]); }

    /// Nearness kept at sample (x, y); 0 where nothing was drawn. x to the right and y down as the light sees it.
    [[nodiscard]] double nearness(int x, int y) const { return decode(word(x, y)); }
    [[nodiscard]] bool is_empty(int x, int y) const { return word(x, y) == far_word_; }

    /// The same at (x, y) to (x + 3, y).
    void nearness(int x, int y, Lanes<double, 4>& four) const {
        Lanes<std::uint32_t, 4> words;
        std::memcpy(&words, words_.get() + static_cast<std::size_t>(y) * width_ + x, sizeof words);
        decode(words, four);
    }
    /// The same at samples y * width + x.
    void nearness(const Lanes<std::int32_t, 4>& samples, Lanes<double, 4>& four) const {
        const Lanes<std::uint32_t, 4> words{words_[samples[0]], words_[samples[1]], words_[samples[2]],
                                            words_[samples[3]]};
        decode(words, four);
    }

    /// As kept: smaller is nearer, in every format.
    [[nodiscard]] std::uint32_t word(int x, int y) const { return words_[static_cast<std::size_t>(y) * width_ + x]; }

    /// Distance of neighbouring values of the format at nearness r: what rounding costs at most, twice.
    [[nodiscard]] double quantum(double r) const {
        const double of_float = std::max(std::abs(r), 0x1p-126) * 0x1p-23;
        return format_ == DepthFormat::float32 ? of_float : step_;
    }

    /// Draws triangles (runs of corner indices into `positions`) so that every sample keeps the nearest.
    ///
    /// `clip_from_world` gives (X, Y, R, W): the map shows -W <= X, Y <= W, nearness is R / W limited to [0, 1], and W
    /// is at most about 1 for everything in the scene. Nothing is clipped by depth: what lies between the light and the
    /// near plane is drawn with nearness 1. Sample (x, y) lies at X/W = (2x + 1) / width - 1, and so on.
    ///
    /// Watertight: corners are snapped to 1/1024 of a sample's spacing, edge functions are exact, and of two triangles
    /// that share an edge exactly one draws the samples on it (top-left rule).
    /// Parallel; the same bits for any number of threads and any order of triangles.
    void draw(const dmat4& clip_from_world, std::span<const vec3> positions,
              std::span<const std::span<const uvec3>> runs, Faces faces);

    /// Draws as `draw` does what lies behind `first`, a map of this size and format into which the same was drawn:
    /// every sample keeps the second surface, if there is one that lies farther by more than a few roundings.
    void draw_behind(const DepthMap& first, const dmat4& clip_from_world, std::span<const vec3> positions,
                     std::span<const std::span<const uvec3>> runs, Faces faces);

    /// In every sample that is not empty keeps between(r of `first`, r of this), in [0, 1], instead of r. Parallel.
    void move_towards(const DepthMap& first, const std::function<double(double first, double second)>& between);

    /// Which triangle each of some samples shows, which ascend, row by row: draws the same once more and names the one
    /// whose depth the map kept, the first of several, by its index in `all`, of which the runs are parts; kNoOwner where
    /// there is none. As costly as drawing: for explaining a map.
    [[nodiscard]] std::vector<std::uint32_t> owners(const dmat4& clip_from_world, std::span<const vec3> positions,
                                                    std::span<const uvec3> all,
                                                    std::span<const std::span<const uvec3>> runs, Faces faces,
                                                    std::span<const std::size_t> samples) const;
    static constexpr std::uint32_t kNoOwner = 0xffffffffu;

private:
    static constexpr std::uint32_t kFarWord = 0x3f800000;  ///< the bits of 1.0f
    [[nodiscard]] double decode(std::uint32_t word) const {
        if (format_ == DepthFormat::float32) return std::bit_cast<float>(kFarWord - word);
        return 1 - word * step_;
    }
    void decode(const Lanes<std::uint32_t, 4>& words, Lanes<double, 4>& four) const {
        if (format_ == DepthFormat::float32) {
            four = __builtin_convertvector(reinterpret_cast<Lanes<float, 4>>(kFarWord - words), Lanes<double, 4>);
        } else {
            four = 1 - __builtin_convertvector(words, Lanes<double, 4>) * step_;
        }
    }
    [[nodiscard]] DepthCode code() const { return {format_, far_word_}; }
    [[nodiscard]] std::size_t samples() const { return static_cast<std::size_t>(width_) * height_; }

    int width_, height_;
    DepthFormat format_;
    double step_;             ///< unorm: value of the last bit
    std::uint32_t far_word_;  ///< nearness 0
    // Unorm depth as it is; float as kFarWord - (bits of r), since the bits of floats that are not negative are in the
    // floats' order.
    std::unique_ptr<std::uint32_t[]> words_;
};

}  // namespace umbra
