// Surface points in bins of a light's image: a grid of cells, and a finer grid in each cell that holds many points, so
// that a floor whose points all lie in a corner of the image is binned as finely as any other.
//
// This work is based on:
// Timo Aila, Samuli Laine. Alias-Free Shadow Maps. 2004
// Gregory Johnson, Juhyun Lee, Christopher Burns, William Mark. The Irregular Z-Buffer. 2005
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
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
    /// Sorts `entries`, by way of `space`, which is as long; what either holds afterwards is undefined. `positions`: of
    /// the batch's points, less the centre. Uses many threads; the bins do not depend on their number.
    PointBins(std::span<Entry> entries, std::span<Entry> space, std::span<const vec3> positions);

    [[nodiscard]] std::size_t blocks() const { return tree_.blocks.size(); }
    [[nodiscard]] const Block& block(std::size_t b) const { return tree_.blocks[b]; }
    [[nodiscard]] Marks& marks(std::size_t b) const { return marks_[b]; }

    /// Calls visit(b) for every block that may hold a point in the extent, farther from the light than its depth.
    template <class Visit>
    void visit(const Extent& extent, const Visit& visit) const {
        if (!tree_.grids.empty()) visit_grid(0, extent, visit);
    }

private:
    /// What places reach over.
    struct Box2 {
        float low_u = kFar, low_v = kFar, high_u = -kFar, high_v = -kFar;
        void add(const Entry& e) { add(Box2{e.u, e.v, e.u, e.v}); }
        void add(const Box2& other) {
            low_u = std::min(low_u, other.low_u), low_v = std::min(low_v, other.low_v);
            high_u = std::max(high_u, other.high_u), high_v = std::max(high_v, other.high_v);
        }
        static constexpr float kFar = std::numeric_limits<float>::max();
    };
    /// nx times ny cells, cells[first] on.
    struct Grid {
        float low_u, low_v, scale_u, scale_v;
        int nx, ny;
        std::uint32_t first;
        /// Grows with the place, also by its rounding, which is what makes ranges of cells complete.
        [[nodiscard]] int column(float u) const { return index((u - low_u) * scale_u, nx); }
        [[nodiscard]] int row(float v) const { return index((v - low_v) * scale_v, ny); }
        [[nodiscard]] std::size_t cell(const Entry& e) const {
            return static_cast<std::size_t>(row(e.v)) * static_cast<std::size_t>(nx) +
                   static_cast<std::size_t>(column(e.u));
        }
        static int index(float at, int n) {
            return at >= static_cast<float>(n) ? n - 1 : at > 0 ? static_cast<int>(at) : 0;
        }
    };
    struct Cell {
        std::uint32_t begin = 0, end = 0;  ///< its blocks; or, where `begin` is kGrid, `end` is a grid
        float depth = -1;                  ///< of the farthest point
    };
    static constexpr std::uint32_t kGrid = ~0u;
    struct Tree {
        std::vector<Grid> grids{};
        std::vector<Cell> cells{};
        std::vector<Block> blocks{};
    };

    template <class Visit>
    void visit_grid(std::size_t g, const Extent& extent, const Visit& visit) const {
        const Grid& grid = tree_.grids[g];
        if (extent.high_u < grid.low_u || extent.high_v < grid.low_v) return;
        const int left = grid.column(extent.low_u), right = grid.column(extent.high_u);
        const int low = grid.row(extent.low_v), high = grid.row(extent.high_v);
        for (int y = low; y <= high; ++y)
            for (int x = left; x <= right; ++x) {
                const Cell& cell = tree_.cells[grid.first + static_cast<std::uint32_t>(y * grid.nx + x)];
                if (cell.depth < extent.depth) continue;
                if (cell.begin == kGrid)
                    visit_grid(cell.end, extent, visit);
                else
                    for (std::uint32_t b = cell.begin; b < cell.end; ++b) visit(b);
            }
    }

    static Grid fitted(std::span<const Entry> entries, const Box2& box);
    static std::uint32_t add_grid(Tree& tree, std::span<Entry> entries, std::span<Entry> space, int level);

    Tree tree_;
    mutable std::vector<Marks> marks_;
};

}  // namespace umbra::binned_shadows_detail
