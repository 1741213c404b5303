// Surface points in bins of eight that are next to one another, and a tree over the bins by where they are in a light's
// image: what a triangle may hide is found in it. Points come in tiles, in which they are sorted: where the points of a
// tile are next to one another, as pixels are, all of them need not be.
//
// This work is based on:
// Timo Aila, Samuli Laine. Alias-Free Shadow Maps. 2004
// Gregory Johnson, Juhyun Lee, Christopher Burns, William Mark. The Irregular Z-Buffer. 2005
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "umbra/core/base/morton.h"
#include "umbra/shadows/shared/light_image.h"

namespace umbra::binned_shadows_detail {

/// Where something is along Morton's curve over a box.
class CurveOver {
public:
    template <class Box>
    explicit CurveOver(const Box& box)
        : low_u_(box.low_u),
          low_v_(box.low_v),
          scale_u_(scale(box.high_u - box.low_u)),
          scale_v_(scale(box.high_v - box.low_v)) {}

    /// Below 2^32.
    [[nodiscard]] std::uint32_t at(float u, float v) const {
        return static_cast<std::uint32_t>(morton_code(static_cast<std::uint32_t>((u - low_u_) * scale_u_),
                                                      static_cast<std::uint32_t>((v - low_v_) * scale_v_)));
    }

private:
    /// What is smaller has no order that matters, and a scale that may not be finite.
    static float scale(float side) { return side > 1e-30f ? 65535 / side : 0; }

    float low_u_, low_v_, scale_u_, scale_v_;
};

/// Eight points: positions less the bins' centre. Lanes that no point needs repeat the last one's.
struct alignas(32) Block {
    float x[kLanes], y[kLanes], z[kLanes];
    std::uint32_t index[kLanes];  ///< in the batch
};

/// What triangles that were tested so far do to the points of a block: one bit a lane. Bits are only set.
struct Marks {
    std::atomic<std::uint8_t> crossed{0}, touched{0};
};

/// The points that ask a light for S_j.
class PointBins {
public:
    /// A place rounded to float. Rounding keeps an order, so that what lies in an extent lies in the rounded extent.
    struct Entry {
        float x, y, z;  ///< less the centre
        float u, v, depth;
        std::uint32_t index;
        std::uint32_t face;
    };
    static constexpr std::size_t kTile = 4096;  ///< points

    /// Around points, or around boxes.
    struct Box {
        float low_u = Extents::kFar, high_u = -Extents::kFar, low_v = Extents::kFar, high_v = -Extents::kFar;
        float depth = -Extents::kFar;

        void add(float from_u, float to_u, float from_v, float to_v, float at) {
            low_u = std::min(low_u, from_u), high_u = std::max(high_u, to_u);
            low_v = std::min(low_v, from_v), high_v = std::max(high_v, to_v);
            depth = std::max(depth, at);
        }
        void add(const Box& other) { add(other.low_u, other.high_u, other.low_v, other.high_v, other.depth); }
        void write(Extents& to, std::size_t lane) const {
            to.low_u[lane] = low_u, to.high_u[lane] = high_u, to.low_v[lane] = low_v, to.high_v[lane] = high_v;
            to.depth[lane] = depth;
        }
        [[nodiscard]] bool empty() const { return low_u > high_u; }
        [[nodiscard]] float perimeter() const { return high_u - low_u + (high_v - low_v); }  ///< half of it
        [[nodiscard]] double area() const {
            return empty() ? 0 : static_cast<double>(high_u - low_u) * static_cast<double>(high_v - low_v);
        }
    };

    PointBins() = default;
    /// Bins the points of tiles 0 to `tiles` - 1, those of one after those of another. `points` writes at most kTile of
    /// a tile to what it gets and returns how many; it is called once for each, from any thread.
    PointBins(std::size_t tiles, const std::function<std::size_t(std::size_t tile, Entry* to)>& points);

    [[nodiscard]] std::size_t blocks() const { return count_; }
    [[nodiscard]] const Block& block(std::size_t b) const { return blocks_[b]; }
    [[nodiscard]] Marks& marks(std::size_t b) const { return marks_[b]; }

    /// Visits no longer come to blocks whose points are all crossed. Not while others read.
    void drop_hidden();

    /// How often the boxes of tiles in the light's image cover the boxes of its faces' points: about once where the
    /// points of a tile are next to one another, as often as there are tiles where points are strewn about.
    [[nodiscard]] double overlap() const { return overlap_; }

    /// Calls visit(b, box) for every block that may hold a point in the extent, farther from the light than its depth.
    template <class Visit>
    void visit(const Extent& extent, const Visit& visit) const {
        if (!levels_.empty()) visit_level(levels_.size() - 1, 0, extent, visit);
    }

private:
    static constexpr std::size_t kFaces      = 6;
    static constexpr std::size_t kTileBlocks = kTile / kLanes + 64;  ///< a few more than full ones

    class Sorter;
    static std::size_t fill_tile(std::span<const Entry> entries, const std::array<Box, kFaces>& boxes, Sorter& sorter,
                                 Block* blocks, Box* of_blocks);
    void add_levels(std::vector<Box> boxes);

    template <class Visit>
    void visit_level(std::size_t level, std::size_t node, const Extent& extent, const Visit& visit) const {
        const Extents& boxes = levels_[level][node];
        for (unsigned rest = points_in(boxes, extent); rest != 0; rest &= rest - 1) {
            const auto lane         = static_cast<std::size_t>(std::countr_zero(rest));
            const std::size_t child = node * kLanes + lane;
            if (level > 0)
                visit_level(level - 1, child, extent, visit);
            else
                visit(child, boxes.at(lane));
        }
    }

    double overlap_    = 1;
    std::size_t count_ = 0;
    std::unique_ptr<Block[]> blocks_;           ///< those next to one another in the light's image together
    std::vector<std::vector<Extents>> levels_;  ///< boxes of eight blocks, of eight of these, up to one
    std::unique_ptr<Marks[]> marks_;
};

}  // namespace umbra::binned_shadows_detail
