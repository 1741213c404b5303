// Surface points in bins of eight that are next to one another, and a tree over the bins by their places in a light's
// image, in which the points that a triangle may hide are found. Points come in tiles and are sorted within them: where
// the points of a tile are next to one another, as pixels are, no other order is needed.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/raw_vector.h"
#include "umbra/core/render/points.h"
#include "umbra/shadows/bins/light_image.h"

namespace umbra::bins {

/// Where something is along Morton's curve over a box.
class CurveOver {
public:
    explicit CurveOver(const Extent& box)
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
    /// Smaller sides have no order that matters, and a scale that may not be finite.
    static float scale(float side) { return side > 1e-30f ? 65535 / side : 0; }

    float low_u_, low_v_, scale_u_, scale_v_;
};

/// Eight points: positions less the bins' centre. Lanes that no point needs repeat the last one's.
struct alignas(32) Block {
    float x[kLanes], y[kLanes], z[kLanes];
    std::uint32_t index[kLanes];  ///< in the batch
    TriangleId triangle[kLanes];  ///< on which the point lies
};

/// Whether a triangle that was tested so far hides the points of a block: one bit a lane. Bits are only set.
struct Marks {
    std::atomic<std::uint8_t> crossed{0};
};

/// The points that ask a light for S_j.
class PointBins {
public:
    static constexpr std::size_t kTile = 4096;  ///< points

    /// A place rounded to float. Rounding keeps an order: places in an extent lie in the rounded extent.
    struct Entry {
        float x, y, z;  ///< less the centre
        float u, v, depth;
        std::uint32_t index;
        TriangleId triangle;
        std::int32_t face;
    };

    /// Up to kTile points, an array for each quantity, as in Entry.
    struct Tile {
        alignas(32) float x[kTile], y[kTile], z[kTile], u[kTile], v[kTile], depth[kTile];
        alignas(32) std::uint32_t index[kTile];
        alignas(32) std::int32_t face[kTile];
        alignas(32) TriangleId triangle[kTile];
        std::size_t count = 0;

        void add(const Entry& e) {
            x[count] = e.x, y[count] = e.y, z[count] = e.z;
            u[count] = e.u, v[count] = e.v, depth[count] = e.depth;
            index[count] = e.index, face[count] = e.face, triangle[count] = e.triangle;
            ++count;
        }
        /// Eight entries, an array for each quantity.
        struct Eight {
            const float *x, *y, *z, *u, *v, *depth;
            const std::uint32_t* index;
            const TriangleId* triangle;
            const std::int32_t* face;
        };
        void add_eight(const Eight& e) {
            std::copy_n(e.x, kLanes, x + count), std::copy_n(e.y, kLanes, y + count);
            std::copy_n(e.z, kLanes, z + count), std::copy_n(e.u, kLanes, u + count);
            std::copy_n(e.v, kLanes, v + count), std::copy_n(e.depth, kLanes, depth + count);
            std::copy_n(e.index, kLanes, index + count), std::copy_n(e.triangle, kLanes, triangle + count);
            std::copy_n(e.face, kLanes, face + count);
            count += kLanes;
        }
        [[nodiscard]] Entry at(std::size_t k) const {
            return {x[k], y[k], z[k], u[k], v[k], depth[k], index[k], triangle[k], face[k]};
        }
    };

    /// Around points, or around boxes.
    struct Box : Extent {
        Box() : Extent(nothing()) { depth = -Extents::kFar; }

        void add(float from_u, float to_u, float from_v, float to_v, float at) {
            low_u = std::min(low_u, from_u), high_u = std::max(high_u, to_u);
            low_v = std::min(low_v, from_v), high_v = std::max(high_v, to_v);
            depth = std::max(depth, at);
        }
        void add(const Box& other) { add(other.low_u, other.high_u, other.low_v, other.high_v, other.depth); }
        [[nodiscard]] double area() const {
            return empty() ? 0 : static_cast<double>(high_u - low_u) * static_cast<double>(high_v - low_v);
        }
    };

    PointBins() = default;
    /// Bins the points of tiles 0 to `tiles` - 1. `points` adds those of a tile to its argument, which is empty; it is
    /// called once for each, from any thread.
    PointBins(std::size_t tiles, const std::function<void(std::size_t tile, Tile& to)>& points);

    /// Blocks have numbers; those of tile t are first(t) to last(t) - 1.
    [[nodiscard]] std::size_t tiles() const { return filled_.size(); }
    [[nodiscard]] std::size_t first(std::size_t tile) const { return tile * kTileBlocks; }
    [[nodiscard]] std::size_t last(std::size_t tile) const { return first(tile) + filled_[tile]; }
    [[nodiscard]] std::size_t blocks() const { return order_.size(); }  ///< how many
    [[nodiscard]] const Block& block(std::size_t b) const { return blocks_[b]; }
    [[nodiscard]] Marks& marks(std::size_t b) const { return marks_[b]; }
    /// Requests positions and marks from memory.
    void prefetch(std::size_t b) const {
        __builtin_prefetch(blocks_[b].x);
        __builtin_prefetch(blocks_[b].z);
        __builtin_prefetch(&marks_[b]);
    }

    /// Blocks whose points are all crossed are found no more. Not while others read.
    void drop_hidden();

    /// How often the boxes of tiles in the light's image cover the boxes of its faces' points: about once where the
    /// points of a tile are next to one another, as often as there are tiles where points are strewn about.
    [[nodiscard]] double overlap() const { return overlap_; }

    /// A block that may hold points in the extents of some of eight triangles, farther from the light than their
    /// depths: one bit for each of these triangles.
    struct Found {
        std::uint32_t block, triangles;
    };
    /// The nodes at which searches for points near some place begin.
    class Start {
        friend class PointBins;
        std::size_t level = 0;
        std::vector<std::uint32_t> nodes{};
        std::vector<Extents> boxes{};  ///< of eight nodes each
    };
    /// Where searches in the extent of triangles, or in parts of it, begin.
    void start(const Extent& around, Start& to) const;

    /// Appends the blocks behind those of eight triangles whose bits are in `which`. A block may come more than once,
    /// each time for other triangles.
    void find(const Extents& triangles, unsigned which, const Start& start, std::vector<Found>& to) const;
    void find(const Extents& triangles, unsigned which, std::vector<Found>& to) const;

private:
    static constexpr std::size_t kFaces      = 6;
    static constexpr std::size_t kTileBlocks = kTile / kLanes + 64;  ///< a few more than full ones

    class Filler;
    template <class BoxOf>
    void add_levels(std::size_t count, const BoxOf& box_of);
    void start_at_root(Start& to) const;
    bool add_nodes(std::size_t level, std::size_t node, const Extent& around, Start& to) const;
    void find(const Extents& triangles, unsigned which, std::size_t first, std::size_t count, const Start& start,
              std::vector<Found>& to) const;
    void find_in(std::size_t level, std::size_t node, const Extents& triangles, unsigned which, const Extent& all,
                 std::vector<Found>& to) const;

    double overlap_ = 1;
    std::unique_ptr<Block[]> blocks_;         ///< by tiles, each with room for kTileBlocks
    std::unique_ptr<Marks[]> marks_;          ///< of each block
    std::vector<std::size_t> filled_;         ///< blocks of each tile
    RawVector<std::uint32_t> order_;          ///< blocks, those next to one another in the light's image together
    std::vector<RawVector<Extents>> levels_;  ///< boxes of eight blocks of order_, of eight of these, up to one
};

/// The points of a batch that ask a light.
struct BinnedPoints {
    PointBins bins{};
    std::vector<std::uint32_t> next_to_light{};  ///< points without a place in the image
    dvec3 reach{0};                              ///< the largest magnitude of each coordinate, less the centre
    bool sorted = false;                         ///< all of them, not those of each tile alone
};

/// Tiles of a raster are binned as they are, unless they overlap in the light's image as leaves of a tree do; then, and
/// without a raster, points are sorted first. `centre`: subtracted from positions in bins.
[[nodiscard]] BinnedPoints bin_points(const Scene& scene, const PointBatch& points, LightId light,
                                      const LightImage& image, dvec3 centre);

}  // namespace umbra::bins
