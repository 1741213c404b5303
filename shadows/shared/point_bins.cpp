#include "umbra/shadows/shared/point_bins.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra::binned_shadows_detail {
namespace {

using Entry = PointBins::Entry;

constexpr std::size_t kInCell     = 16;     ///< points of a cell, on average
constexpr std::size_t kMost       = 128;    ///< of a cell that is not cut further
constexpr int kLevels             = 8;      ///< of grids in one another
constexpr std::size_t kChunk      = 32768;  ///< points that one thread sorts, at least
constexpr std::size_t kMostChunks = 8;      ///< each of which counts the points of every cell

/// Calls body(k), k < n, on one thread or on several.
template <class Body>
void each(std::size_t n, bool parallel, const Body& body) {
    const auto all = [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) body(k);
    };
    parallel ? parallel_ranges(n, 1, all) : all(0, n);
}

float farthest(std::span<const Entry> own) {
    float depth = own[0].depth;
    for (const Entry& e : own) depth = std::max(depth, e.depth);
    return depth;
}

std::size_t blocks_for(std::size_t points) { return (points + kLanes - 1) / kLanes; }

void fill_blocks(std::span<const Entry> own, Block* to) {
    for (std::size_t k = 0; k < own.size(); k += kLanes, ++to)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const Entry& e  = own[std::min(k + lane, own.size() - 1)];
            to->u[lane]     = e.u;
            to->v[lane]     = e.v;
            to->depth[lane] = e.depth;
            to->index[lane] = e.index;
        }
}

/// Equal parts of the entries, which do not depend on the number of threads.
struct Chunks {
    std::size_t size, count;
    explicit Chunks(std::size_t entries)
        : size(std::max(kChunk, (entries + kMostChunks - 1) / kMostChunks)), count((entries + size - 1) / size) {}
    [[nodiscard]] std::span<const Entry> of(std::span<const Entry> all, std::size_t k) const {
        return all.subspan(k * size, std::min(size, all.size() - k * size));
    }
};

}  // namespace

PointBins::Grid PointBins::fitted(std::span<const Entry> entries, const Box2& box) {
    const float width = box.high_u - box.low_u, height = box.high_v - box.low_v;
    // Cells as many as points allow, as square as the points' extent.
    const double cells  = std::max(1.0, static_cast<double>(entries.size()) / static_cast<double>(kInCell));
    const double aspect = width > 0 && height > 0
                              ? std::clamp(static_cast<double>(width) / static_cast<double>(height), 1 / cells, cells)
                          : width > 0 ? cells
                                      : 1 / cells;
    const int nx        = std::clamp(static_cast<int>(std::sqrt(cells * aspect)), 1, 4096),
              ny        = std::clamp(static_cast<int>(cells / nx), 1, 4096);
    return {box.low_u,
            box.low_v,
            width > 0 ? static_cast<float>(nx) / width : 0,
            height > 0 ? static_cast<float>(ny) / height : 0,
            nx,
            ny,
            0};
}

/// Appends the grid of `entries` and all that is in it to `tree`: `entries` are sorted by cell to `space`, which is as
/// long, and what is cut further is sorted on between the two. Returns the grid.
std::uint32_t PointBins::add_grid(Tree& tree, std::span<Entry> entries, std::span<Entry> space, int level) {
    const bool parallel = level == 1;
    const Chunks chunks(entries.size());
    std::vector<Box2> boxes(chunks.count);
    each(chunks.count, parallel, [&](std::size_t k) {
        for (const Entry& e : chunks.of(entries, k)) boxes[k].add(e);
    });
    for (const Box2& box : boxes) boxes[0].add(box);
    Grid grid        = fitted(entries, boxes[0]);
    const auto count = static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny);
    const auto g     = static_cast<std::uint32_t>(tree.grids.size());
    grid.first       = static_cast<std::uint32_t>(tree.cells.size());
    tree.grids.push_back(grid);
    tree.cells.resize(tree.cells.size() + count);

    // Where each chunk's entries of each cell go.
    std::vector<std::vector<std::uint32_t>> next(chunks.count);
    each(chunks.count, parallel, [&](std::size_t k) {
        next[k].resize(count);
        for (const Entry& e : chunks.of(entries, k)) ++next[k][grid.cell(e)];
    });
    std::vector<std::uint32_t> first(count + 1);
    std::uint32_t sum = 0;
    for (std::size_t c = 0; c < count; ++c) {
        first[c] = sum;
        for (std::vector<std::uint32_t>& of_chunk : next) {
            const std::uint32_t n = of_chunk[c];
            of_chunk[c]           = sum;
            sum += n;
        }
    }
    first[count] = sum;
    each(chunks.count, parallel, [&](std::size_t k) {
        for (const Entry& e : chunks.of(entries, k)) space[next[k][grid.cell(e)]++] = e;
    });

    const auto own_of   = [&](std::size_t c) { return space.subspan(first[c], first[c + 1] - first[c]); };
    const auto is_heavy = [&](std::size_t c) {
        const std::size_t n = first[c + 1] - first[c];
        return n > kMost && n < entries.size() && level < kLevels;
    };
    if (!parallel) {
        for (std::size_t c = 0; c < count; ++c) {
            const std::span<Entry> own = own_of(c);
            if (own.empty()) continue;
            const float depth = farthest(own);
            if (is_heavy(c)) {
                const std::uint32_t inner  = add_grid(tree, own, entries.subspan(first[c], own.size()), level + 1);
                tree.cells[grid.first + c] = {kGrid, inner, depth};
                continue;
            }
            const std::size_t at = tree.blocks.size();
            tree.blocks.resize(at + blocks_for(own.size()));
            fill_blocks(own, tree.blocks.data() + at);
            tree.cells[grid.first + c] = {static_cast<std::uint32_t>(at),
                                          static_cast<std::uint32_t>(tree.blocks.size()), depth};
        }
        return g;
    }

    // Cells that are cut further grow trees of their own, which are then put together in the order of the cells.
    std::vector<std::size_t> heavy;
    for (std::size_t c = 0; c < count; ++c)
        if (is_heavy(c)) heavy.push_back(c);
    std::vector<Tree> inner(heavy.size());
    each(heavy.size(), true, [&](std::size_t h) {
        const std::span<Entry> own = own_of(heavy[h]);
        add_grid(inner[h], own, entries.subspan(first[heavy[h]], own.size()), level + 1);
    });
    std::vector<std::uint32_t> at_block(count + 1, 0);
    std::size_t h = 0, grids = tree.grids.size(), cells = tree.cells.size();
    std::vector<std::uint32_t> at_grid(heavy.size()), at_cell(heavy.size());
    for (std::size_t c = 0; c < count; ++c) {
        std::size_t blocks = blocks_for(first[c + 1] - first[c]);
        if (h < heavy.size() && heavy[h] == c) {
            blocks     = inner[h].blocks.size();
            at_grid[h] = static_cast<std::uint32_t>(grids), at_cell[h] = static_cast<std::uint32_t>(cells);
            grids += inner[h].grids.size(), cells += inner[h].cells.size();
            ++h;
        }
        at_block[c + 1] = at_block[c] + static_cast<std::uint32_t>(blocks);
    }
    tree.grids.resize(grids);
    tree.cells.resize(cells);
    tree.blocks.resize(at_block[count]);
    parallel_ranges(count, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            const std::span<Entry> own = own_of(c);
            if (own.empty() || is_heavy(c)) continue;
            fill_blocks(own, tree.blocks.data() + at_block[c]);
            tree.cells[grid.first + c] = {at_block[c], at_block[c + 1], farthest(own)};
        }
    });
    each(heavy.size(), true, [&](std::size_t k) {
        const std::size_t c = heavy[k];
        for (Grid& own : inner[k].grids) own.first += at_cell[k];
        for (Cell& own : inner[k].cells) {
            own.end += own.begin == kGrid ? at_grid[k] : at_block[c];
            if (own.begin != kGrid) own.begin += at_block[c];
        }
        float depth = -1;
        for (const Cell& own : inner[k].cells) depth = std::max(depth, own.depth);
        std::ranges::copy(inner[k].grids, tree.grids.begin() + at_grid[k]);
        std::ranges::copy(inner[k].cells, tree.cells.begin() + at_cell[k]);
        std::ranges::copy(inner[k].blocks, tree.blocks.begin() + at_block[c]);
        tree.cells[grid.first + c] = {kGrid, at_grid[k], depth};
    });
    return g;
}

PointBins::PointBins(std::span<Entry> entries, std::span<Entry> space, std::span<const vec3> positions) {
    if (entries.empty()) return;
    add_grid(tree_, entries, space, 1);
    parallel_ranges(tree_.blocks.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            Block& block = tree_.blocks[b];
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const vec3 p  = positions[block.index[lane]];
                block.x[lane] = p.x, block.y[lane] = p.y, block.z[lane] = p.z;
            }
        }
    });
    marks_ = std::vector<Marks>(tree_.blocks.size());
}

}  // namespace umbra::binned_shadows_detail
