// Depth rasteriser: snap, bin by bands of rows, then fill exact spans, a band a thread.
//
// This work is based on:
// Juan Pineda. A Parallel Algorithm for Polygon Rasterization. 1988 (edge functions)
// Ivan Sutherland, Gary Hodgman. Reentrant Polygon Clipping. 1974
// Michael Abrash. Rasterization on Larrabee. 2009 (snapping, fill rule and binning as graphics hardware has them)
#include "umbra/shadows/maps/depth_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr double kGuard        = 1.5;      // triangles are clipped where |X| or |Y| exceeds this many W
constexpr double kMinW         = 1e-9;     // and where W is less than this
constexpr int kBandRows        = 32;       // 32 rows of 2048 samples fit a core's second-level cache
constexpr std::size_t kChunk   = 2048;     // triangles snapped by one task
constexpr std::size_t kCleared = 1 << 18;  // samples cleared by one task
constexpr std::size_t kBatch   = 32;  // chunks between two joins: their triangles stay in cache until they are filled

/// Corners in units of 1 / kSnap, such that sample (x, y) lies at (kSnap x, kSnap y). Of positive area.
struct Snapped {
    std::array<std::int32_t, 3> x, y;
    std::array<double, 3> r;
};

/// What one task snapped, and which of it reaches into which band.
struct Chunk {
    std::vector<Snapped> triangles;
    std::vector<const uvec3*> from;  ///< one a snapped triangle: what it was
    std::vector<std::vector<std::uint32_t>> bands;
};

using Polygon = std::vector<dvec4>;

// ---- clipping ------------------------------------------------------------------------------------------------------

/// Signed distances from the planes that bound what can be snapped.
std::array<double, 5> distances(const dvec4& c) {
    return {c.w - kMinW, kGuard * c.w - c.x, kGuard * c.w + c.x, kGuard * c.w - c.y, kGuard * c.w + c.y};
}

bool inside(const dvec4& c) {
    const auto d = distances(c);
    return std::ranges::all_of(d, [](double v) { return v >= 0; });
}

/// True where all corners lie beyond the same side of the map, or behind the light.
bool misses_map(const std::array<dvec4, 3>& c) {
    const auto all = [&](auto&& outside) { return outside(c[0]) && outside(c[1]) && outside(c[2]); };
    return all([](const dvec4& v) { return v.x < -v.w; }) || all([](const dvec4& v) { return v.x > v.w; }) ||
           all([](const dvec4& v) { return v.y < -v.w; }) || all([](const dvec4& v) { return v.y > v.w; }) ||
           all([](const dvec4& v) { return v.w < kMinW; });
}

/// Cut points are computed from the inner corner to the outer one, so that both triangles at an edge cut it alike.
void clip(Polygon& polygon) {
    Polygon kept;
    for (int plane = 0; plane < 5; ++plane) {
        kept.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const dvec4& a = polygon[i];
            const dvec4& b = polygon[(i + 1) % polygon.size()];
            const double u = distances(a)[plane];
            const double v = distances(b)[plane];
            if (u >= 0) kept.push_back(a);
            if (u >= 0 && v < 0) kept.push_back(a + (u / (u - v)) * (b - a));
            if (u < 0 && v >= 0) kept.push_back(b + (v / (v - u)) * (a - b));
        }
        polygon.swap(kept);
    }
}

// ---- filling -------------------------------------------------------------------------------------------------------

/// E(x, y) = ax x + (dx kSnap y + c): zero on the edge, positive inside. All its values are whole numbers below 2^53
/// (maps of 2^14 samples, kGuard, kSnap = 2^10), so double arithmetic on them is exact.
struct Edge {
    double dx, ax, inverse_ax, c;
    double fill;  ///< E >= fill: covered. 0 where the edge is a top or a left one, 1 elsewhere
};

Edge edge_between(std::int32_t ax, std::int32_t ay, std::int32_t bx, std::int32_t by) {
    const double dx = bx - ax;
    const double dy = by - ay;
    const double a  = -dy * DepthMap::kSnap;
    return {dx, a, 1 / a, dy * ax - dx * ay, dy < 0 || (dy == 0 && dx > 0) ? 0.0 : 1.0};
}

/// Limits [first, last] to the samples of a row that the edge covers. `value` is E at x = 0.
void limit_span(const Edge& e, double value, double& first, double& last) {
    const double c = value - e.fill;  // covered where ax x + c >= 0
    if (e.ax == 0) {
        if (c < 0) last = first - 1;
        return;
    }
    // The quotient may be off by a rounding; the neighbours settle it exactly.
    double q = -c * e.inverse_ax;
    if (e.ax > 0) {
        q = std::clamp(std::ceil(q), first, last + 1);
        if (e.ax * q + c < 0) q += 1;
        if (e.ax * (q - 1) + c >= 0) q -= 1;
        first = std::max(first, q);
    } else {
        q = std::clamp(std::floor(q), first - 1, last);
        if (e.ax * q + c < 0) q -= 1;
        if (e.ax * (q + 1) + c >= 0) q += 1;
        last = std::min(last, q);
    }
}

template <DepthFormat format>
std::uint32_t encode(double r, std::uint32_t far_word) {
    if constexpr (format == DepthFormat::float32) return far_word - std::bit_cast<std::uint32_t>(static_cast<float>(r));
    // Adding 2^52 leaves the rounded whole number in the low bits.
    return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>((1 - r) * far_word + 0x1p52));
}

/// Rows [row_begin, row_end) of one triangle: keep(sample, depth as kept) for what it covers.
template <DepthFormat format, class Keep>
void fill(const Snapped& t, int row_begin, int row_end, int width, std::uint32_t far_word, const Keep& keep) {
    const auto [x_low, x_high] = std::ranges::minmax(t.x);
    const auto [y_low, y_high] = std::ranges::minmax(t.y);
    const auto below           = [](std::int32_t v) { return v >> std::countr_zero(unsigned{DepthMap::kSnap}); };
    const double x_first       = std::max(below(x_low + DepthMap::kSnap - 1), 0);
    const double x_last        = std::min(below(x_high), width - 1);
    const int y_first          = std::max(below(y_low + DepthMap::kSnap - 1), row_begin);
    const int y_last           = std::min(below(y_high), row_end - 1);

    // edges[k] is opposite corner k, hence E_k / area is the weight of corner k.
    const std::array edges{edge_between(t.x[1], t.y[1], t.x[2], t.y[2]), edge_between(t.x[2], t.y[2], t.x[0], t.y[0]),
                           edge_between(t.x[0], t.y[0], t.x[1], t.y[1])};
    const double area         = edges[0].c + edges[1].c + edges[2].c;
    const double inverse_area = 1 / area;
    const double r_x          = (edges[0].ax * t.r[0] + edges[1].ax * t.r[1] + edges[2].ax * t.r[2]) * inverse_area;
    const double r_low        = std::clamp(std::min({t.r[0], t.r[1], t.r[2]}), 0.0, 1.0);
    const double r_high       = std::clamp(std::max({t.r[0], t.r[1], t.r[2]}), 0.0, 1.0);

    for (int y = y_first; y <= y_last; ++y) {
        std::array<double, 3> value;
        double first = x_first;
        double last  = x_last;
        for (int k = 0; k < 3; ++k) {
            value[k] = edges[k].dx * (static_cast<double>(DepthMap::kSnap) * y) + edges[k].c;
            limit_span(edges[k], value[k], first, last);
        }
        if (first > last) continue;
        // From exact weights at the first sample: a plane through slivers would not be exact anywhere.
        double r_first = 0;
        for (int k = 0; k < 3; ++k) r_first += (edges[k].ax * first + value[k]) * t.r[k];
        r_first *= inverse_area;

        const std::size_t sample = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(first);
        const int count          = static_cast<int>(last - first) + 1;
        for (int i = 0; i < count; ++i) {
            const double r = std::min(std::max(r_first + r_x * i, r_low), r_high);
            keep(sample + i, encode<format>(r, far_word));
        }
    }
}

// ---- snapping and binning ------------------------------------------------------------------------------------------

void snap(const dvec4& a, const dvec4& b, const dvec4& c, const uvec3* from, int width, int height, Faces faces,
          Chunk& chunk) {
    Snapped t;
    const auto place = [&](int k, const dvec4& v) {
        const double inverse_w = 1 / v.w;
        t.x[k] = static_cast<std::int32_t>(std::lrint(((v.x * inverse_w + 1) * width - 1) * (DepthMap::kSnap / 2.0)));
        t.y[k] = static_cast<std::int32_t>(std::lrint(((v.y * inverse_w + 1) * height - 1) * (DepthMap::kSnap / 2.0)));
        t.r[k] = v.z * inverse_w;
    };
    place(0, a);
    place(1, b);
    place(2, c);

    constexpr int shift        = std::countr_zero(unsigned{DepthMap::kSnap});
    const auto [x_low, x_high] = std::ranges::minmax(t.x);
    const auto [y_low, y_high] = std::ranges::minmax(t.y);
    const int x_first          = std::max((x_low + DepthMap::kSnap - 1) >> shift, 0);
    const int x_last           = std::min(x_high >> shift, width - 1);
    const int y_first          = std::max((y_low + DepthMap::kSnap - 1) >> shift, 0);
    const int y_last           = std::min(y_high >> shift, height - 1);
    if (x_first > x_last || y_first > y_last) return;

    // With y down, anticlockwise corners have negative area.
    const std::int64_t area = static_cast<std::int64_t>(t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) -
                              static_cast<std::int64_t>(t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
    if (area == 0 || (faces == Faces::front && area > 0) || (faces == Faces::back && area < 0)) return;
    if (area < 0) {
        std::swap(t.x[1], t.x[2]);
        std::swap(t.y[1], t.y[2]);
        std::swap(t.r[1], t.r[2]);
    }
    const auto index = static_cast<std::uint32_t>(chunk.triangles.size());
    chunk.triangles.push_back(t);
    chunk.from.push_back(from);
    for (int band = y_first / kBandRows; band <= y_last / kBandRows; ++band) chunk.bands[band].push_back(index);
}

void snap_run(const dmat4& clip_from_world, std::span<const vec3> positions, std::span<const uvec3> triangles,
              int width, int height, Faces faces, Chunk& chunk) {
    Polygon polygon;
    for (const uvec3& t : triangles) {
        const std::array c{clip_from_world * dvec4(dvec3(positions[t.x]), 1),
                           clip_from_world * dvec4(dvec3(positions[t.y]), 1),
                           clip_from_world * dvec4(dvec3(positions[t.z]), 1)};
        if (misses_map(c)) continue;
        if (inside(c[0]) && inside(c[1]) && inside(c[2])) {
            snap(c[0], c[1], c[2], &t, width, height, faces, chunk);
            continue;
        }
        polygon.assign(c.begin(), c.end());
        clip(polygon);
        for (std::size_t i = 2; i < polygon.size(); ++i)
            snap(polygon[0], polygon[i - 1], polygon[i], &t, width, height, faces, chunk);
    }
}

/// Calls body(snapped, what it was, row_begin, row_end) for every band of rows that a triangle may reach into. Bands
/// are disjoint; each is one thread's, and sees its triangles in their order.
template <class Body>
void rasterise(int width, int height, const dmat4& clip_from_world, std::span<const vec3> positions,
               std::span<const std::span<const uvec3>> runs, Faces faces, const Body& body) {
    // Tasks of kChunk triangles each, however the runs are cut: task i is pieces [starts[i], starts[i + 1]).
    std::vector<std::span<const uvec3>> pieces;
    std::vector<std::size_t> starts;
    std::size_t room = 0;
    for (std::span<const uvec3> run : runs)
        for (std::size_t done = 0; done < run.size();) {
            if (room == 0) {
                starts.push_back(pieces.size());
                room = kChunk;
            }
            pieces.push_back(run.subspan(done, std::min(room, run.size() - done)));
            done += pieces.back().size();
            room -= pieces.back().size();
        }
    const std::size_t tasks = starts.size();
    starts.push_back(pieces.size());

    const std::size_t bands = static_cast<std::size_t>((height + kBandRows - 1) / kBandRows);
    std::vector<Chunk> chunks(std::min(kBatch, tasks));
    for (Chunk& chunk : chunks) chunk.bands.resize(bands);

    for (std::size_t batch = 0; batch < tasks; batch += kBatch) {
        const std::size_t count = std::min(kBatch, tasks - batch);
        parallel_ranges(count, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                chunks[i].triangles.clear();
                chunks[i].from.clear();
                for (auto& band : chunks[i].bands) band.clear();
                for (std::size_t piece = starts[batch + i]; piece < starts[batch + i + 1]; ++piece)
                    snap_run(clip_from_world, positions, pieces[piece], width, height, faces, chunks[i]);
            }
        });
        parallel_ranges(bands, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t band = begin; band < end; ++band) {
                const int row_begin = static_cast<int>(band) * kBandRows;
                const int row_end   = std::min(row_begin + kBandRows, height);
                for (std::size_t i = 0; i < count; ++i)
                    for (std::uint32_t t : chunks[i].bands[band])
                        body(chunks[i].triangles[t], chunks[i].from[t], row_begin, row_end);
            }
        });
    }
}

/// Calls body with the format as a constant.
template <class Body>
void with_format(DepthFormat format, const Body& body) {
    switch (format) {
        case DepthFormat::unorm16: return body(std::integral_constant<DepthFormat, DepthFormat::unorm16>());
        case DepthFormat::unorm24: return body(std::integral_constant<DepthFormat, DepthFormat::unorm24>());
        case DepthFormat::unorm32: return body(std::integral_constant<DepthFormat, DepthFormat::unorm32>());
        case DepthFormat::float32: return body(std::integral_constant<DepthFormat, DepthFormat::float32>());
    }
}

double unorm_max(DepthFormat format) {
    switch (format) {
        case DepthFormat::unorm16: return 0xffff;
        case DepthFormat::unorm24: return 0xffffff;
        case DepthFormat::unorm32: return 0xffffffff;
        case DepthFormat::float32: break;
    }
    return 1;
}

}  // namespace

DepthMap::DepthMap(int width, int height, DepthFormat format)
    : width_(width),
      height_(height),
      format_(format),
      step_(1 / unorm_max(format)),
      far_word_(format == DepthFormat::float32 ? kFarWord : static_cast<std::uint32_t>(unorm_max(format))),
      words_(std::make_unique_for_overwrite<std::uint32_t[]>(samples())) {
    clear();
}

void DepthMap::clear() {
    parallel_ranges(samples(), kCleared, [&](std::size_t begin, std::size_t end) {
        std::fill(words_.get() + begin, words_.get() + end, far_word_);
    });
}

double DepthMap::quantum(double r) const {
    if (format_ != DepthFormat::float32) return step_;
    return std::max(std::abs(r), 0x1p-126) * 0x1p-23;
}

void DepthMap::draw(const dmat4& clip_from_world, std::span<const vec3> positions,
                    std::span<const std::span<const uvec3>> runs, Faces faces) {
    // The nearest of many does not depend on their order.
    with_format(format_, [&](auto format) {
        rasterise(width_, height_, clip_from_world, positions, runs, faces,
                  [&](const Snapped& t, const uvec3*, int row_begin, int row_end) {
                      std::uint32_t* const words = words_.get();
                      fill<format.value>(t, row_begin, row_end, width_, far_word_,
                                         [words](std::size_t sample, std::uint32_t word) {
                                             words[sample] = std::min(words[sample], word);
                                         });
                  });
    });
}

void DepthMap::draw_behind(const DepthMap& first, const dmat4& clip_from_world, std::span<const vec3> positions,
                           std::span<const std::span<const uvec3>> runs, Faces faces) {
    constexpr std::uint32_t kRoundings = 8;  // of a surface that is drawn twice, as two triangles with other corners
    with_format(format_, [&](auto format) {
        rasterise(width_, height_, clip_from_world, positions, runs, faces,
                  [&](const Snapped& t, const uvec3*, int row_begin, int row_end) {
                      fill<format.value>(
                          t, row_begin, row_end, width_, far_word_, [&](std::size_t sample, std::uint32_t word) {
                              if (word > first.words_[sample] && word - first.words_[sample] > kRoundings)
                                  words_[sample] = std::min(words_[sample], word);
                          });
                  });
    });
}

void DepthMap::move_towards(const DepthMap& first, const std::function<double(double, double)>& between) {
    with_format(format_, [&](auto format) {
        parallel_ranges(samples(), kCleared, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                if (words_[i] != far_word_)
                    words_[i] = encode<format.value>(between(decode(first.words_[i]), decode(words_[i])), far_word_);
        });
    });
}

std::vector<std::uint32_t> DepthMap::owners(const dmat4& clip_from_world, std::span<const vec3> positions,
                                            std::span<const uvec3> all, std::span<const std::span<const uvec3>> runs,
                                            Faces faces) const {
    std::vector<std::uint32_t> owners(samples(), kNoOwner);
    with_format(format_, [&](auto format) {
        rasterise(width_, height_, clip_from_world, positions, runs, faces,
                  [&](const Snapped& t, const uvec3* from, int row_begin, int row_end) {
                      const auto id = static_cast<std::uint32_t>(from - all.data());
                      fill<format.value>(t, row_begin, row_end, width_, far_word_,
                                         [&](std::size_t sample, std::uint32_t word) {
                                             if (word == words_[sample]) owners[sample] = std::min(owners[sample], id);
                                         });
                  });
    });
    return owners;
}

}  // namespace umbra
