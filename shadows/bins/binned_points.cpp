#include "umbra/shadows/bins/point_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"

// Compiled so that loops over lanes become vector code: shadows/CMakeLists.txt.
namespace umbra::bins {
namespace {

constexpr std::size_t kTileSide = 64;  ///< of a raster, pixels
constexpr double kMostOverlap   = 8;   ///< of a raster's tiles
static_assert(kTileSide * kTileSide == PointBins::kTile);

/// Writes the corners of a triangle as those of lane `lane`.
void load(const Scene& scene, TriangleId t, LightImage::Corners& corners, std::size_t lane) {
    for (int c = 0; c < 3; ++c) {
        const vec3 corner = scene.vertex(t, c);
        for (int axis = 0; axis < 3; ++axis) corners[c][axis][lane] = static_cast<double>(corner[axis]);
    }
}

/// As those of all lanes.
void load_all(const Scene& scene, TriangleId t, LightImage::Corners& corners) {
    for (int c = 0; c < 3; ++c) {
        const vec3 corner = scene.vertex(t, c);
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = static_cast<double>(corner[axis]);
#pragma GCC unroll 1
            for (std::size_t lane = 0; lane < kLanes; ++lane) corners[c][axis][lane] = at;
        }
    }
}

/// Writes eight coordinates less the centre's; `reach`: the largest magnitudes so far, so much larger that 8 roundings
/// of them in float cover `slack`, too.
void less(const double* __restrict at, const double* __restrict slack, double centre, float* __restrict near,
          float* __restrict reach) {
#pragma GCC unroll 1
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        near[lane]       = static_cast<float>(at[lane] - centre);
        const float size = std::abs(near[lane]) + static_cast<float>(0x1p21 * slack[lane]);
        reach[lane]      = reach[lane] > size ? reach[lane] : size;
    }
}

class Binning {
public:
    Binning(const Scene& scene, const PointBatch& points, LightId light, const LightImage& image, dvec3 centre)
        : scene_(scene), points_(points), light_(light), image_(image), centre_(centre) {}

    BinnedPoints in_order_of_pixels() {
        const auto width         = static_cast<std::size_t>(points_.raster->width),
                   height        = static_cast<std::size_t>(points_.raster->height);
        const std::size_t across = (width + kTileSide - 1) / kTileSide, down = (height + kTileSide - 1) / kTileSide;
        parts_.assign(across * down, {});
        return with_parts(PointBins(across * down, [&](std::size_t tile, PointBins::Tile& to) {
            const std::size_t left = tile % across * kTileSide, top = tile / across * kTileSide;
            std::array<std::uint32_t, PointBins::kTile> asking;
            std::size_t n = 0;
            for (const MortonCell pixel : kMortonSquare<kTileSide>) {
                const std::size_t x = left + pixel.x, y = top + pixel.y;
                if (x < width && y < height && points_.asks(light_, y * width + x))
                    asking[n++] = static_cast<std::uint32_t>(y * width + x);
            }
            enter(std::span(asking).first(n), to, parts_[tile]);
        }));
    }

    /// So that points that are next to one another in the light's image follow one another: along Morton's curve.
    BinnedPoints in_order_of_places() {
        std::vector<std::uint32_t> asking;
        for (std::size_t i = 0; i < points_.size(); ++i)
            if (points_.asks(light_, i)) asking.push_back(static_cast<std::uint32_t>(i));
        const std::size_t tiles = (asking.size() + PointBins::kTile - 1) / PointBins::kTile;
        parts_.assign(tiles, {});
        std::vector<PointBins::Entry> entries(asking.size());
        std::vector<std::size_t> placed(tiles);
        parallel_ranges(tiles, 1, [&](std::size_t begin, std::size_t end) {
            const auto own = std::make_unique_for_overwrite<PointBins::Tile>();
            for (std::size_t tile = begin; tile < end; ++tile) {
                own->count = 0;
                enter(of_tile<const std::uint32_t>(asking, tile), *own, parts_[tile]);
                placed[tile] = own->count;
                for (std::size_t k = 0; k < own->count; ++k) entries[tile * PointBins::kTile + k] = own->at(k);
            }
        });
        PointBins::Box all;
        for (std::size_t tile = 0; tile < tiles; ++tile)
            for (const PointBins::Entry& e : of_tile<PointBins::Entry>(entries, tile).first(placed[tile]))
                all.add(e.u, e.u, e.v, e.v, e.depth);
        const CurveOver curve(all);
        std::vector<std::uint64_t> keys;
        for (std::size_t tile = 0; tile < tiles; ++tile)
            for (std::size_t k = tile * PointBins::kTile; k < tile * PointBins::kTile + placed[tile]; ++k)
                keys.push_back(std::uint64_t{curve.at(entries[k].u, entries[k].v)} << 32 | k);
        parallel_sort(keys.begin(), keys.end());
        return with_parts(PointBins((keys.size() + PointBins::kTile - 1) / PointBins::kTile,
                                    [&](std::size_t tile, PointBins::Tile& to) {
                                        for (const std::uint64_t key : of_tile<const std::uint64_t>(keys, tile))
                                            to.add(entries[key & 0xffffffffu]);
                                    }));
    }

private:
    /// The results for some points besides bins.
    struct Unbinned {
        std::vector<std::uint32_t> without{};
        vec3 reach{0};
    };

    template <class Item, class Items>
    static std::span<Item> of_tile(Items& items, std::size_t tile) {
        const std::size_t first = tile * PointBins::kTile;
        return std::span<Item>(items).subspan(first, std::min(PointBins::kTile, items.size() - first));
    }

    /// Adds the points that have a place.
    UMBRA_FOR_EACH_PROCESSOR void enter(std::span<const std::uint32_t> which, PointBins::Tile& to,
                                        Unbinned& part) const {
        float reach[3][kLanes] = {};
        for (std::size_t k = 0; k < which.size(); k += kLanes) {
            const std::size_t count = std::min<std::size_t>(kLanes, which.size() - k);
            // Eight of a raster are mostly of two rows, and the next in memory are of other tiles.
            if (k + 8 * kLanes + 2 < which.size())
                for (const std::size_t ahead : {k + 8 * kLanes, k + 8 * kLanes + 2}) {
                    __builtin_prefetch(&points_.triangle[which[ahead]]);
                    __builtin_prefetch(&points_.u[which[ahead]]);
                    __builtin_prefetch(&points_.v[which[ahead]]);
                }
            LightImage::Corners corners;
            float u[kLanes], v[kLanes];
            TriangleId of[kLanes];
            bool is_one = true;  // triangle
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const std::uint32_t i = which[k + std::min(lane, count - 1)];
                u[lane] = points_.u[i], v[lane] = points_.v[i];
                of[lane] = points_.triangle[i];
                is_one   = is_one & (of[lane] == of[0]);
            }
            if (is_one)
                load_all(scene_, of[0], corners);
            else
                for (std::size_t lane = 0; lane < kLanes; ++lane) load(scene_, of[lane], corners, lane);
            LightImage::Places places;
            image_.places(corners, u, v, places);
            float near[3][kLanes];
            less(places.x, places.slack[0], centre_.x, near[0], reach[0]);
            less(places.y, places.slack[1], centre_.y, near[1], reach[1]);
            less(places.z, places.slack[2], centre_.z, near[2], reach[2]);
            std::int32_t lowest = 0;  // face
            for (std::size_t lane = 0; lane < kLanes; ++lane) lowest |= places.face[lane];
            if (count == kLanes && lowest >= 0) {
                to.add_eight({.x        = near[0],
                              .y        = near[1],
                              .z        = near[2],
                              .u        = places.u,
                              .v        = places.v,
                              .depth    = places.depth,
                              .index    = &which[k],
                              .triangle = of,
                              .face     = places.face});
                continue;
            }
            for (std::size_t lane = 0; lane < count; ++lane) {
                if (places.face[lane] < 0) {
                    part.without.push_back(which[k + lane]);
                    continue;
                }
                to.add({.x        = near[0][lane],
                        .y        = near[1][lane],
                        .z        = near[2][lane],
                        .u        = places.u[lane],
                        .v        = places.v[lane],
                        .depth    = places.depth[lane],
                        .index    = which[k + lane],
                        .triangle = of[lane],
                        .face     = places.face[lane]});
            }
        }
        for (int axis = 0; axis < 3; ++axis) part.reach[axis] = *std::ranges::max_element(reach[axis]);
    }

    [[nodiscard]] BinnedPoints with_parts(PointBins bins) const {
        BinnedPoints all{.bins = std::move(bins)};
        for (const Unbinned& part : parts_) {
            all.next_to_light.insert(all.next_to_light.end(), part.without.begin(), part.without.end());
            all.reach = glm::max(all.reach, dvec3(part.reach));
        }
        return all;
    }

    const Scene& scene_;
    const PointBatch& points_;
    LightId light_;
    const LightImage& image_;
    dvec3 centre_;
    std::vector<Unbinned> parts_{};
};

}  // namespace

BinnedPoints bin_points(const Scene& scene, const PointBatch& points, LightId light, const LightImage& image,
                        dvec3 centre) {
    Binning binning(scene, points, light, image, centre);
    if (points.raster) {
        BinnedPoints binned = binning.in_order_of_pixels();
        if (binned.bins.overlap() <= kMostOverlap) return binned;
    }
    BinnedPoints binned = binning.in_order_of_places();
    binned.sorted       = true;
    return binned;
}

}  // namespace umbra::bins
