#include "umbra/shadows/shared/point_bins.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra::binned_shadows_detail {
namespace {

constexpr std::size_t kInCell = 16;   ///< points of a cell, on average
constexpr std::size_t kMost   = 128;  ///< of a cell that is not cut further
constexpr int kLevels         = 8;    ///< of grids in one another

}  // namespace

/// Sorts `entries` by cell, by way of `space`, which is as long. Returns the new grid.
std::size_t PointBins::add_grid(std::span<Entry> entries, std::span<Entry> space, int level) {
    const auto [low_u, high_u] = std::ranges::minmax(entries, {}, &Entry::u);
    const auto [low_v, high_v] = std::ranges::minmax(entries, {}, &Entry::v);
    const float width = high_u.u - low_u.u, height = high_v.v - low_v.v;
    // Cells as many as points allow, as square as the points' extent.
    const double cells  = std::max(1.0, static_cast<double>(entries.size()) / static_cast<double>(kInCell));
    const double aspect = width > 0 && height > 0
                              ? std::clamp(static_cast<double>(width) / static_cast<double>(height), 1 / cells, cells)
                          : width > 0 ? cells
                                      : 1 / cells;
    const int nx        = std::clamp(static_cast<int>(std::sqrt(cells * aspect)), 1, 4096),
              ny        = std::clamp(static_cast<int>(cells / nx), 1, 4096);
    const std::size_t g = grids_.size();
    const Grid grid{low_u.u,
                    low_v.v,
                    width > 0 ? static_cast<float>(nx) / width : 0,
                    height > 0 ? static_cast<float>(ny) / height : 0,
                    nx,
                    ny,
                    static_cast<std::uint32_t>(cells_.size())};
    grids_.push_back(grid);
    const auto count = static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
    cells_.resize(cells_.size() + count);

    const auto cell_of = [&](const Entry& e) {
        return static_cast<std::size_t>(grid.row(e.v)) * static_cast<std::size_t>(nx) +
               static_cast<std::size_t>(grid.column(e.u));
    };
    std::vector<std::uint32_t> first(count + 1, 0);
    for (const Entry& e : entries) ++first[cell_of(e) + 1];
    for (std::size_t c = 0; c < count; ++c) first[c + 1] += first[c];
    {
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        for (const Entry& e : entries) space[next[cell_of(e)]++] = e;
    }
    std::ranges::copy(space, entries.begin());
    for (std::size_t c = 0; c < count; ++c) {
        const std::size_t n = first[c + 1] - first[c];
        if (n == 0) continue;
        const std::span<Entry> own = entries.subspan(first[c], n);
        float depth                = own[0].depth;
        for (const Entry& e : own) depth = std::max(depth, e.depth);
        if (n > kMost && n < entries.size() && level < kLevels) {
            const auto inner       = static_cast<std::uint32_t>(add_grid(own, space.subspan(first[c], n), level + 1));
            cells_[grid.first + c] = {kGrid, inner, depth};
            continue;
        }
        Cell& cell = cells_[grid.first + c];
        cell.begin = static_cast<std::uint32_t>(blocks_.size());
        cell.depth = depth;
        for (std::size_t k = 0; k < n; k += kLanes) {
            Block& block = blocks_.emplace_back();
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const Entry& e    = own[std::min(k + lane, n - 1)];
                block.u[lane]     = e.u;
                block.v[lane]     = e.v;
                block.depth[lane] = e.depth;
                block.index[lane] = e.index;
            }
        }
        cell.end = static_cast<std::uint32_t>(blocks_.size());
    }
    return g;
}

PointBins::PointBins(std::vector<Entry>& entries, std::span<const vec3> positions) {
    if (entries.empty()) return;
    blocks_.reserve(entries.size() / 4);
    std::vector<Entry> space(entries.size());
    add_grid(entries, space, 1);
    parallel_ranges(blocks_.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const vec3 p       = positions[blocks_[b].index[lane]];
                blocks_[b].x[lane] = p.x, blocks_[b].y[lane] = p.y, blocks_[b].z[lane] = p.z;
            }
    });
    marks_ = std::vector<Marks>(blocks_.size());
}

}  // namespace umbra::binned_shadows_detail
