// Surface points in bins of a light's image: a grid of cells, and a finer grid in each cell that holds many points, so
// that a floor whose points all lie in a corner of the image is binned as finely as any other.
//
// This work is based on:
// Timo Aila, Samuli Laine. Alias-Free Shadow Maps. 2004
// Gregory Johnson, Juhyun Lee, Christopher Burns, William Mark. The Irregular Z-Buffer. 2005
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/shadows/shared/light_image.h"

namespace umbra::binned_shadows_detail {

inline constexpr std::size_t kLanes = 8;

/// Eight points: positions less the bins' centre, and places in the light's image. Lanes that no point needs repeat the
/// last one's.
struct alignas(32) Block {
    float x[kLanes], y[kLanes], z[kLanes];
    float u[kLanes], v[kLanes], depth[kLanes];
    std::uint32_t index[kLanes];  ///< in the batch
};

/// What triangles that were tested so far do to the points of a block: one bit a lane. Bits are only set.
struct Marks {
    std::atomic<std::uint8_t> crossed{0}, touched{0};
};

/// The points of one face of a light's image that ask for S_j.
class PointBins {
public:
    /// A place rounded to float. Rounding keeps an order, so that what lies in an extent lies in the rounded extent.
    struct Entry {
        float u, v, depth;
        std::uint32_t index;
    };
    /// Sorts `entries`. `positions`: of the batch's points, less the centre.
    PointBins(std::vector<Entry>& entries, std::span<const vec3> positions);

    [[nodiscard]] std::size_t blocks() const { return blocks_.size(); }
    [[nodiscard]] const Block& block(std::size_t b) const { return blocks_[b]; }
    [[nodiscard]] Marks& marks(std::size_t b) const { return marks_[b]; }

    /// Calls visit(b) for every block that may hold a point in the extent, farther from the light than its depth.
    template <class Visit>
    void visit(const Extent& extent, const Visit& visit) const {
        if (!grids_.empty()) visit_grid(0, extent, visit);
    }

private:
    /// nx times ny cells, cells_[first] on.
    struct Grid {
        float low_u, low_v, scale_u, scale_v;
        int nx, ny;
        std::uint32_t first;
        /// Grows with the place, also by its rounding, which is what makes ranges of cells complete.
        [[nodiscard]] int column(float u) const { return index((u - low_u) * scale_u, nx); }
        [[nodiscard]] int row(float v) const { return index((v - low_v) * scale_v, ny); }
        static int index(float at, int n) {
            return at >= static_cast<float>(n) ? n - 1 : at > 0 ? static_cast<int>(at) : 0;
        }
    };
    struct Cell {
        std::uint32_t begin = 0, end = 0;  ///< its blocks; or, where `begin` is kGrid, `end` is a grid
        float depth = -1;                  ///< of the farthest point
    };
    static constexpr std::uint32_t kGrid = ~0u;

    template <class Visit>
    void visit_grid(std::size_t g, const Extent& extent, const Visit& visit) const {
        const Grid& grid = grids_[g];
        if (extent.high_u < grid.low_u || extent.high_v < grid.low_v) return;
        const int left = grid.column(extent.low_u), right = grid.column(extent.high_u);
        const int low = grid.row(extent.low_v), high = grid.row(extent.high_v);
        for (int y = low; y <= high; ++y)
            for (int x = left; x <= right; ++x) {
                const Cell& cell = cells_[grid.first + static_cast<std::uint32_t>(y * grid.nx + x)];
                if (cell.depth < extent.depth) continue;
                if (cell.begin == kGrid)
                    visit_grid(cell.end, extent, visit);
                else
                    for (std::uint32_t b = cell.begin; b < cell.end; ++b) visit(b);
            }
    }

    std::size_t add_grid(std::span<Entry> entries, std::span<Entry> space, int level);

    std::vector<Grid> grids_;
    std::vector<Cell> cells_;
    std::vector<Block> blocks_;
    mutable std::vector<Marks> marks_;
};

}  // namespace umbra::binned_shadows_detail
