#include "umbra/shadows/bins/point_bins.h"

#include <boost/sort/spreadsort/integer_sort.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"

// Compiled so that loops over lanes become vector code: shadows/CMakeLists.txt.
namespace umbra::bins {
namespace {

/// Blocks of a tile are at most this many times as wide as they would be if its points were spread evenly.
constexpr float kWidest = 2;

/// Searches that begin together begin at nodes of so many levels above those of blocks, and at the root where there
/// would be more nodes than this.
constexpr std::size_t kStartLevel = 1, kMostStarts = 64;

/// Around eight others.
PointBins::Box box_around(const Extents& children) {
    PointBins::Box box;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
        if (!children.empty(lane))
            box.add(children.low_u[lane], children.high_u[lane], children.low_v[lane], children.high_v[lane],
                    children.depth[lane]);
    return box;
}

/// Sorts blocks along Morton's curve over the box of all.
void sort(RawVector<std::uint32_t>& order, const PointBins::Box* boxes, const PointBins::Box& all) {
    const CurveOver curve(all);
    RawVector<std::uint64_t> keys(order.size());
    parallel_ranges(order.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const PointBins::Box& box = boxes[order[k]];
            keys[k] = std::uint64_t{curve.at(0.5f * (box.low_u + box.high_u), 0.5f * (box.low_v + box.high_v))} << 32 |
                      order[k];
        }
    });
    parallel_sort(keys.begin(), keys.end());
    parallel_ranges(order.size(), 16384, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) order[k] = static_cast<std::uint32_t>(keys[k]);
    });
}

/// The half perimeter that a block of `count` points in `box` may have.
float widest_of(const PointBins::Box& box, std::size_t count) {
    return kWidest * box.perimeter() / static_cast<float>(std::sqrt(static_cast<double>(count) / kLanes));
}

}  // namespace

/// Turns the points of tiles into blocks: those of eight points that follow one another, where most of these are next
/// to one another, as pixels of one surface are, else points sorted along Morton's curve.
class PointBins::Filler {
public:
    /// Writes the blocks of a tile and their boxes, adds to the boxes of the faces, and returns how many blocks.
    UMBRA_FOR_EACH_PROCESSOR std::size_t fill(const Tile& tile, std::array<Box, kFaces>& faces, Block* blocks,
                                              Box* boxes) {
        Writer to{.tile = tile, .block = blocks, .box = boxes};
        if (fill_in_order(tile, faces, to)) return to.number;
        for (std::size_t k = 0; k < tile.count; ++k) add(tile, k, faces[static_cast<std::size_t>(tile.face[k])]);
        for (std::int32_t f = 0; f < static_cast<std::int32_t>(kFaces); ++f) {
            const Box& face = faces[static_cast<std::size_t>(f)];
            if (face.empty()) continue;
            const std::span<const std::uint32_t> order = sorted(tile, f, face);
            to.widest                                  = widest_of(face, order.size());
            for (const std::uint32_t k : order) to.add(k);
            to.close();
        }
        return to.number;
    }

private:
    static void add(const Tile& tile, std::size_t k, Box& to) {
        to.add(tile.u[k], tile.u[k], tile.v[k], tile.v[k], tile.depth[k]);
    }

    /// Fills blocks point by point.
    struct Writer {
        const Tile& tile;
        Block* block;  ///< the one that is being filled
        Box* box;
        float widest       = 0;
        std::size_t number = 0;  ///< of blocks that are full
        std::size_t lane   = 0;
        Box around{};
        std::size_t spare = kTileBlocks - kTile / kLanes - kFaces;  ///< besides full blocks and the last of each face

        void add(std::size_t k) {
            Box with = around;
            Filler::add(tile, k, with);
            if (lane > 0 && spare > 0 && with.perimeter() > widest) {
                close(), --spare;
                Filler::add(tile, k, with = {});
            }
            around         = with;
            block->x[lane] = tile.x[k], block->y[lane] = tile.y[k], block->z[lane] = tile.z[k];
            block->index[lane] = tile.index[k], block->triangle[lane] = tile.triangle[k];
            if (++lane == kLanes) close();
        }

        /// Eight points from k on, as they are.
        void add_eight(std::size_t k, const Box& of) {
            std::copy_n(tile.x + k, kLanes, block->x), std::copy_n(tile.y + k, kLanes, block->y);
            std::copy_n(tile.z + k, kLanes, block->z), std::copy_n(tile.index + k, kLanes, block->index);
            std::copy_n(tile.triangle + k, kLanes, block->triangle);
            around = of, lane = kLanes;
            close();
        }

        void close() {
            if (lane == 0) return;
            for (std::size_t k = lane; k < kLanes; ++k) {
                block->x[k] = block->x[lane - 1], block->y[k] = block->y[lane - 1], block->z[k] = block->z[lane - 1];
                block->index[k] = block->index[lane - 1], block->triangle[k] = block->triangle[lane - 1];
            }
            *box++ = around;
            around = {}, lane = 0, ++block, ++number;
        }
    };

    /// Does nothing and returns false where points are in several faces, or more than a few blocks would be too wide.
    bool fill_in_order(const Tile& tile, std::array<Box, kFaces>& faces, Writer& to) {
        const std::size_t eights = (tile.count + kLanes - 1) / kLanes;
        std::int32_t other       = 0;
        for (std::size_t k = 0; k < tile.count; ++k) other |= tile.face[k] ^ tile.face[0];
        if (other != 0 || eights == 0) return eights == 0;
        Box all;
        for (std::size_t e = 0; e < eights; ++e) {
            Box of;
            for (std::size_t k = e * kLanes; k < std::min((e + 1) * kLanes, tile.count); ++k) add(tile, k, of);
            of_eights_[e] = of;
            all.add(of);
        }
        to.widest        = widest_of(all, tile.count);
        std::size_t wide = 0;
        for (std::size_t e = 0; e < eights; ++e) wide += of_eights_[e].perimeter() > to.widest ? 1u : 0u;
        if (wide * kLanes * 16 > tile.count) return false;
        faces[static_cast<std::size_t>(tile.face[0])].add(all);
        for (std::size_t e = 0; e < eights; ++e) {
            const std::size_t first = e * kLanes, last = std::min(first + kLanes, tile.count);
            if (last == first + kLanes && of_eights_[e].perimeter() <= to.widest) {
                to.add_eight(first, of_eights_[e]);
                continue;
            }
            for (std::size_t k = first; k < last; ++k) to.add(k);
            to.close();
        }
        return true;
    }

    /// The points of the face along Morton's curve over their box, until the next call: its cells are 1024 times 1024;
    /// points of one cell stay in their order.
    std::span<const std::uint32_t> sorted(const Tile& tile, std::int32_t face, const Box& box) {
        const CurveOver curve(box);
        std::size_t n = 0;
        for (std::uint32_t k = 0; k < tile.count; ++k)
            if (tile.face[k] == face) keys_[n++] = curve.at(tile.u[k], tile.v[k]) >> kDropped << kIndexBits | k;
        const std::span<std::uint32_t> keys(keys_.data(), n);
        boost::sort::spreadsort::integer_sort(keys.begin(), keys.end());
        for (std::uint32_t& key : keys) key &= kTile - 1;
        return keys;
    }

    static constexpr int kIndexBits = 12, kDropped = 12;  ///< 10 bits of u and of v are kept
    static_assert(kTile == std::size_t{1} << kIndexBits);

    std::vector<std::uint32_t> keys_ = std::vector<std::uint32_t>(kTile);
    std::vector<Box> of_eights_      = std::vector<Box>(kTile / kLanes);
};

PointBins::PointBins(std::size_t tiles, const std::function<void(std::size_t, Tile&)>& points)
    : blocks_(std::make_unique_for_overwrite<Block[]>(tiles * kTileBlocks)),
      marks_(std::make_unique<Marks[]>(tiles * kTileBlocks)),
      filled_(tiles) {
    const auto boxes = std::make_unique_for_overwrite<Box[]>(tiles * kTileBlocks);
    std::vector<std::array<Box, kFaces>> of_faces(tiles);
    parallel_ranges(tiles, 1, [&](std::size_t begin, std::size_t end) {
        const auto tile = std::make_unique_for_overwrite<Tile>();
        Filler filler;
        for (std::size_t t = begin; t < end; ++t) {
            tile->count = 0;
            points(t, *tile);
            filled_[t] = filler.fill(*tile, of_faces[t], blocks_.get() + first(t), boxes.get() + first(t));
        }
    });
    std::vector<std::size_t> before(tiles + 1);
    for (std::size_t t = 0; t < tiles; ++t) before[t + 1] = before[t] + filled_[t];
    order_.resize(before[tiles]);
    parallel_ranges(tiles, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            for (std::size_t k = 0; k < filled_[t]; ++k)
                order_[before[t] + k] = static_cast<std::uint32_t>(first(t) + k);
    });
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
    sort(order_, boxes.get(), everything);
    add_levels(order_.size(), [&](std::size_t k) { return boxes[order_[k]]; });
}

namespace {

/// Which of eight rectangles overlap an extent and have depths(their depth): one bit each.
template <class Depths>
unsigned sharing(const Extents& all, const Extent& one, const Depths& depths) {
    unsigned bits = 0;
#pragma GCC unroll 1
    for (std::size_t i = 0; i < kLanes; ++i)
        bits |= static_cast<unsigned>((all.low_u[i] <= one.high_u) & (all.high_u[i] >= one.low_u) &
                                      (all.low_v[i] <= one.high_v) & (all.high_v[i] >= one.low_v) &
                                      static_cast<int>(depths(all.depth[i])))
                << i;
    return bits;
}

/// Which of eight boxes of points lie partly in a triangle's extent, and not all nearer than its depth.
unsigned points_in(const Extents& boxes, const Extent& triangle) {
    return sharing(boxes, triangle, [&](float depth) { return depth >= triangle.depth; });
}

/// In the extents of which of eight triangles a box of points lies partly, and not all nearer than its depth.
unsigned triangles_over(const Extents& triangles, const Extent& box) {
    return sharing(triangles, box, [&](float depth) { return depth <= box.depth; });
}

}  // namespace

void PointBins::start(const Extent& around, Start& to) const {
    to.level = kStartLevel;
    to.nodes.clear(), to.boxes.clear();
    if (levels_.size() <= kStartLevel + 1 || !add_nodes(levels_.size() - 1, 0, around, to)) start_at_root(to);
}

void PointBins::start_at_root(Start& to) const {
    to.level = levels_.size() - 1;
    to.nodes.assign(levels_.empty() ? 0 : 1, 0);
    to.boxes.assign(1, {});
    for (std::size_t lane = 0; lane < kLanes; ++lane) to.boxes[0].clear(lane);
    to.boxes[0].set(0, {dvec2(-Extents::kFar), dvec2(Extents::kFar), static_cast<double>(Extents::kFar)});
}

/// Adds the nodes of level to.level below a node; false where they are too many.
UMBRA_FOR_EACH_PROCESSOR bool PointBins::add_nodes(std::size_t level, std::size_t node, const Extent& around,
                                                   Start& to) const {
    const Extents& boxes = levels_[level][node];
    for (unsigned rest = points_in(boxes, around); rest != 0; rest &= rest - 1) {
        const auto lane  = static_cast<std::size_t>(std::countr_zero(rest));
        const auto child = static_cast<std::uint32_t>(node * kLanes + lane);
        if (level > to.level + 1) {
            if (!add_nodes(level - 1, child, around, to)) return false;
            continue;
        }
        const std::size_t n = to.nodes.size();
        if (n == kMostStarts) return false;
        if (n % kLanes == 0) {
            to.boxes.emplace_back();
            for (std::size_t k = 0; k < kLanes; ++k) to.boxes.back().clear(k);
        }
        to.nodes.push_back(child);
        to.boxes.back().set(n % kLanes, boxes.at(lane));
    }
    return true;
}

void PointBins::find(const Extents& triangles, unsigned which, std::vector<Found>& to) const {
    Start root;
    start_at_root(root);
    find(triangles, which, root, to);
}

void PointBins::find(const Extents& triangles, unsigned which, const Start& start, std::vector<Found>& to) const {
    if (!start.nodes.empty()) find(triangles, which, 0, kLanes, start, to);
}

/// Triangles that are next to one another look for points together, others half by half. `first` and `count`: lanes.
UMBRA_FOR_EACH_PROCESSOR void PointBins::find(const Extents& triangles, unsigned which, std::size_t first,
                                              std::size_t count, const Start& start, std::vector<Found>& to) const {
    const unsigned own = which & ((1u << count) - 1) << first;
    if (own == 0) return;
    Extent all = Extent::nothing();
    float sum  = 0;
    for (unsigned rest = own; rest != 0; rest &= rest - 1) {
        const Extent of = triangles.at(static_cast<std::size_t>(std::countr_zero(rest)));
        all.add(of);
        sum += of.perimeter();
    }
    if (!std::has_single_bit(own) && all.perimeter() > sum) {
        find(triangles, own, first, count / 2, start, to);
        find(triangles, own, first + count / 2, count / 2, start, to);
        return;
    }
    for (std::size_t e = 0; e < start.boxes.size(); ++e)
        for (unsigned rest = points_in(start.boxes[e], all); rest != 0; rest &= rest - 1)
            find_in(start.level, start.nodes[e * kLanes + static_cast<std::size_t>(std::countr_zero(rest))], triangles,
                    own, all, to);
}

UMBRA_FOR_EACH_PROCESSOR void PointBins::find_in(std::size_t level, std::size_t node, const Extents& triangles,
                                                 unsigned which, const Extent& all, std::vector<Found>& to) const {
    const Extents& boxes = levels_[level][node];
    for (unsigned rest = points_in(boxes, all); rest != 0; rest &= rest - 1) {
        const auto lane         = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t child = node * kLanes + lane;
        if (level > 0) {
            find_in(level - 1, child, triangles, which, all, to);
            continue;
        }
        const unsigned over = triangles_over(triangles, boxes.at(lane)) & which;
        if (over != 0) to.push_back({order_[child], over});
    }
}

void PointBins::drop_hidden() {
    for (std::size_t level = 0; level < levels_.size(); ++level) {
        RawVector<Extents>& nodes = levels_[level];
        parallel_ranges(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n)
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const std::size_t child = n * kLanes + lane;
                    if (nodes[n].empty(lane)) continue;
                    if (level == 0) {
                        if (marks_[order_[child]].crossed.load(std::memory_order_relaxed) == 0xff) nodes[n].clear(lane);
                        continue;
                    }
                    const Box box = box_around(levels_[level - 1][child]);
                    box.empty() ? nodes[n].clear(lane) : nodes[n].set(lane, box);
                }
        });
    }
}

/// `box_of`: of blocks in their order.
template <class BoxOf>
void PointBins::add_levels(std::size_t count, const BoxOf& box_of) {
    const auto add_level = [&](std::size_t below, const auto& box_of_child) {
        RawVector<Extents> nodes((below + kLanes - 1) / kLanes);
        parallel_ranges(nodes.size(), 512, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n)
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const std::size_t k = n * kLanes + lane;
                    k < below ? nodes[n].set(lane, box_of_child(k)) : nodes[n].clear(lane);
                }
        });
        levels_.push_back(std::move(nodes));
    };
    if (count == 0) return;
    add_level(count, box_of);
    while (levels_.back().size() > 1)
        add_level(levels_.back().size(), [&](std::size_t k) { return box_around(levels_.back()[k]); });
}

}  // namespace umbra::bins
