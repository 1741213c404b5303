// Which samples of a depth map triangles cover, and with which depths.
//
// Triangles are snapped, sorted into bands of rows, and filled a band a thread. Small ones become fragments while they
// are snapped, four triangles at a time in vector code; large ones are filled in exact spans.
//
// This work is based on:
// Juan Pineda. A Parallel Algorithm for Polygon Rasterization. 1988 (edge functions)
// Ivan Sutherland, Gary Hodgman. Reentrant Polygon Clipping. 1974
// Michael Abrash. Rasterization on Larrabee. 2009 (snapping, fill rule and binning as graphics hardware has them)
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "umbra/core/base/math.h"

namespace umbra {

/// unormN: depth 1 - r in steps of 1 / (2^N - 1), rounded to nearest as graphics hardware does; float32: r itself.
enum class DepthFormat : std::uint8_t { unorm16, unorm24, unorm32, float32 };

/// Which triangles are drawn, by the side that the light sees (anticlockwise corners: front).
enum class Faces : std::uint8_t { all, front, back };

/// How depth is kept: smaller words are nearer, in every format.
struct DepthCode {
    DepthFormat format;
    std::uint32_t far_word;  ///< of nearness 0
};

/// The arguments of DepthMap::draw.
struct Drawing {
    int width, height;
    DepthCode code;
    const dmat4& clip_from_world;
    std::span<const vec3> positions;
    std::span<const std::span<const uvec3>> runs;
    Faces faces;
};

/// All three draw in parallel; the same for any number of threads and any order of triangles. Words are one a sample,
/// row by row: sample (x, y) is at y * width + x.

/// Every word becomes the least of itself and of those of the triangles that cover its sample.
void keep_nearest(const Drawing& drawing, std::uint32_t* words);

/// The same for words that exceed that of `first` by more than `roundings`.
void keep_nearest_behind(const Drawing& drawing, const std::uint32_t* first, std::uint32_t roundings,
                         std::uint32_t* words);

/// The owners of some samples, `asked`, which ascend: each becomes the least of itself and of the indices in `all`, of
/// which the runs are parts, of the triangles that cover its sample with just the depth in `words`.
void keep_owners(const Drawing& drawing, const std::uint32_t* words, std::span<const uvec3> all,
                 std::span<const std::size_t> asked, std::span<std::uint32_t> owners);

/// The depth as kept of nearness r in [0, 1].
[[nodiscard]] std::uint32_t depth_word(const DepthCode& code, double r);

/// Corners are snapped to 1 / kSnapsPerSample of a sample's spacing.
inline constexpr int kSnapsPerSample = 1024;

}  // namespace umbra
