#include "umbra/shadows/shared/point_bins.h"

#include <boost/sort/spreadsort/integer_sort.hpp>

#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"

namespace umbra::binned_shadows_detail {
namespace {

using Entry = PointBins::Entry;

/// Blocks of a tile are at most this many times as wide as they would be if its points were spread evenly.
constexpr float kWidest = 2;

/// Around eight others.
PointBins::Box box_of(const Extents& children) {
    PointBins::Box box;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
        if (!children.empty(lane))
            box.add(children.low_u[lane], children.high_u[lane], children.low_v[lane], children.high_v[lane],
                    children.depth[lane]);
    return box;
}

/// Sorts blocks along Morton's curve over the box of all.
void sort(std::vector<std::uint32_t>& order, const PointBins::Box* boxes, const PointBins::Box& all) {
    const CurveOver curve(all);
    std::vector<std::uint64_t> keys(order.size());
    parallel_ranges(order.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const PointBins::Box& box = boxes[order[k]];
            keys[k] = std::uint64_t{curve.at(0.5f * (box.low_u + box.high_u), 0.5f * (box.low_v + box.high_v))} << 32 |
                      order[k];
        }
    });
    parallel_sort(keys.begin(), keys.end());
    for (std::size_t k = 0; k < keys.size(); ++k) order[k] = static_cast<std::uint32_t>(keys[k]);
}

/// The half perimeter that a block of `count` points in `box` may have.
float widest_of(const PointBins::Box& box, std::size_t count) {
    return kWidest * box.perimeter() / static_cast<float>(std::sqrt(static_cast<double>(count) / kLanes));
}

}  // namespace

/// Sorts the points of a face along Morton's curve over their box: its cells are 1024 times 1024; points of one cell
/// stay in their order. Where most blocks of the order that there is are small enough, it stays as it is.
class PointBins::Sorter {
public:
    /// The points of the face, until the next call.
    std::span<const std::uint32_t> order(std::span<const Entry> entries, std::uint32_t face, const Box& box) {
        std::size_t n = 0;
        for (std::uint32_t k = 0; k < entries.size(); ++k) {
            keys_[n] = k;
            n += entries[k].face == face ? 1u : 0u;
        }
        if (are_blocks(entries, std::span(keys_).first(n), box)) return std::span(keys_).first(n);
        const CurveOver curve(box);
        n = 0;
        for (std::uint32_t k = 0; k < entries.size(); ++k)
            if (entries[k].face == face)
                keys_[n++] = curve.at(entries[k].u, entries[k].v) >> kDropped << kIndexBits | k;
        const std::span<std::uint32_t> keys(keys_.data(), n);
        boost::sort::spreadsort::integer_sort(keys.begin(), keys.end());
        for (std::uint32_t& key : keys) key &= kTile - 1;
        return keys;
    }

private:
    /// Whether most of eight points that follow one another fit in a block, so that they need not be sorted.
    static bool are_blocks(std::span<const Entry> entries, std::span<const std::uint32_t> order, const Box& box) {
        const float widest = widest_of(box, order.size());
        std::size_t wide   = 0;
        for (std::size_t k = 0; k < order.size(); k += kLanes) {
            Box of;
            for (std::size_t i = k; i < std::min(k + kLanes, order.size()); ++i) {
                const Entry& e = entries[order[i]];
                of.add(e.u, e.u, e.v, e.v, e.depth);
            }
            wide += of.perimeter() > widest ? 1u : 0u;
        }
        return wide * kLanes * 16 <= order.size();
    }

    static constexpr int kIndexBits = 12, kDropped = 12;  ///< 10 bits of u and of v are kept
    static_assert(kTile == std::size_t{1} << kIndexBits);

    std::vector<std::uint32_t> keys_ = std::vector<std::uint32_t>(kTile);
};

PointBins::PointBins(std::size_t tiles, const std::function<std::size_t(std::size_t, Entry*)>& points) {
    const auto blocks = std::make_unique_for_overwrite<Block[]>(tiles * kTileBlocks);
    const auto boxes  = std::make_unique_for_overwrite<Box[]>(tiles * kTileBlocks);
    std::vector<std::array<Box, kFaces>> of_faces(tiles);
    std::vector<std::size_t> filled(tiles);
    parallel_ranges(tiles, 1, [&](std::size_t begin, std::size_t end) {
        const auto entries = std::make_unique_for_overwrite<Entry[]>(kTile);
        Sorter sorter;
        for (std::size_t tile = begin; tile < end; ++tile) {
            const std::span<const Entry> own(entries.get(), points(tile, entries.get()));
            for (const Entry& e : own) of_faces[tile][e.face].add(e.u, e.u, e.v, e.v, e.depth);
            filled[tile] = fill_tile(own, of_faces[tile], sorter, blocks.get() + tile * kTileBlocks,
                                     boxes.get() + tile * kTileBlocks);
        }
    });
    std::vector<std::uint32_t> order;
    for (std::size_t tile = 0; tile < tiles; ++tile)
        for (std::size_t k = 0; k < filled[tile]; ++k)
            order.push_back(static_cast<std::uint32_t>(tile * kTileBlocks + k));
    double whole = 0, of_tiles = 0;
    Box everything;
    for (std::size_t face = 0; face < kFaces; ++face) {
        Box all;
        for (const auto& of : of_faces) {
            if (of[face].empty()) continue;
            of_tiles += of[face].area();
            all.add(of[face]);
        }
        whole += all.area();
        if (!all.empty()) everything.add(all);
    }
    overlap_ = whole > 0 ? of_tiles / whole : 1;
    sort(order, boxes.get(), everything);
    count_  = order.size();
    blocks_ = std::make_unique_for_overwrite<Block[]>(count_);
    marks_  = std::make_unique<Marks[]>(count_);
    std::vector<Box> sorted(count_);
    parallel_ranges(count_, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) blocks_[k] = blocks[order[k]], sorted[k] = boxes[order[k]];
    });
    add_levels(std::move(sorted));
}

/// Returns how many blocks are filled.
std::size_t PointBins::fill_tile(std::span<const Entry> entries, const std::array<Box, kFaces>& boxes, Sorter& sorter,
                                 Block* blocks, Box* of_blocks) {
    std::size_t b = 0;
    // What blocks there are room for besides full ones and the last of each face.
    std::size_t spare = kTileBlocks - kTile / kLanes - kFaces;
    for (std::uint32_t face = 0; face < kFaces; ++face) {
        if (boxes[face].empty()) continue;
        const std::span<const std::uint32_t> order = sorter.order(entries, face, boxes[face]);
        const float widest                         = widest_of(boxes[face], order.size());
        Box box;
        std::size_t lane = 0;
        const auto close = [&] {
            Block& block = blocks[b];
            for (std::size_t k = lane; k < kLanes; ++k) {
                block.x[k] = block.x[lane - 1], block.y[k] = block.y[lane - 1], block.z[k] = block.z[lane - 1];
                block.index[k] = block.index[lane - 1];
            }
            of_blocks[b] = box;
            box = {}, lane = 0, ++b;
        };
        for (const std::uint32_t k : order) {
            const Entry& e = entries[k];
            Box with       = box;
            with.add(e.u, e.u, e.v, e.v, e.depth);
            if (lane > 0 && spare > 0 && with.perimeter() > widest) {
                close(), --spare;
                with = {};
                with.add(e.u, e.u, e.v, e.v, e.depth);
            }
            box           = with;
            Block& block  = blocks[b];
            block.x[lane] = e.x, block.y[lane] = e.y, block.z[lane] = e.z;
            block.index[lane] = e.index;
            if (++lane == kLanes) close();
        }
        if (lane > 0) close();
    }
    return b;
}

void PointBins::drop_hidden() {
    for (std::size_t level = 0; level < levels_.size(); ++level) {
        std::vector<Extents>& nodes = levels_[level];
        parallel_ranges(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n)
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const std::size_t child = n * kLanes + lane;
                    if (nodes[n].empty(lane)) continue;
                    if (level == 0) {
                        if (marks_[child].crossed.load(std::memory_order_relaxed) == 0xff) nodes[n].clear(lane);
                        continue;
                    }
                    const Box box = box_of(levels_[level - 1][child]);
                    box.empty() ? nodes[n].clear(lane) : box.write(nodes[n], lane);
                }
        });
    }
}

void PointBins::add_levels(std::vector<Box> boxes) {
    while (!boxes.empty() && (levels_.empty() || boxes.size() > 1)) {
        std::vector<Extents> nodes((boxes.size() + kLanes - 1) / kLanes);
        std::vector<Box> around(nodes.size());
        parallel_ranges(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) {
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const std::size_t k = n * kLanes + lane;
                    k < boxes.size() ? boxes[k].write(nodes[n], lane) : nodes[n].clear(lane);
                }
                around[n] = box_of(nodes[n]);
            }
        });
        boxes = std::move(around);
        levels_.push_back(std::move(nodes));
    }
}

}  // namespace umbra::binned_shadows_detail
