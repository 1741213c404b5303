#include "umbra/shadows/maps/rasteriser.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/geometry/clipped_polygon.h"

namespace umbra {
namespace {

constexpr double kGuard      = 1.5;   // triangles are clipped where |X| or |Y| exceeds this many W
constexpr double kMinW       = 1e-9;  // and where W is less than this
constexpr int kBandRows      = 32;    // 32 rows of 2048 samples fit a core's second-level cache
constexpr int kBandShift     = std::countr_zero(unsigned{kBandRows});
constexpr std::size_t kChunk = 2048;  // triangles snapped by one task
constexpr std::size_t kBatch = 32;    // chunks between two joins: their triangles stay in cache until they are filled
constexpr int kNarrow        = 8;     // triangles of at most as many columns
constexpr int kTall          = 32;    // and rows become fragments

constexpr int kFour = 4;  // rows, samples or triangles at a time
using Doubles       = Lanes<double, kFour>;
using Masks         = Lanes<std::int64_t, kFour>;  ///< all bits, or none
using Words         = Lanes<std::uint32_t, kFour>;
using Ints          = Lanes<std::int32_t, kFour>;

/// Corners in units of 1 / kSnapsPerSample, such that sample (x, y) lies at (kSnapsPerSample x, kSnapsPerSample y). Of
/// positive area.
struct Snapped {
    std::array<double, 3> x, y, r;
    const uvec3* from;
};

/// One sample that a triangle covers.
struct Fragment {
    std::uint32_t sample, word;
};

/// The triangles that one task snapped, and which of them reach into which band.
struct Chunk {
    struct Band {
        std::vector<std::uint32_t> large;
        std::vector<Fragment> fragments;  ///< `count` of them are in use
        std::size_t count = 0;
    };
    std::vector<Snapped> large;
    std::vector<Band> bands;
};

// ---- clipping ------------------------------------------------------------------------------------------------------

/// Signed distances from the planes that bound what can be snapped.
std::array<double, 5> distances(const dvec4& c) {
    return {c.w - kMinW, kGuard * c.w - c.x, kGuard * c.w + c.x, kGuard * c.w - c.y, kGuard * c.w + c.y};
}

// ---- lanes ---------------------------------------------------------------------------------------------------------

[[gnu::always_inline]] inline void spread(double value, Doubles& lanes) { lanes = Doubles{} + value; }

[[gnu::always_inline]] inline void min_lanes(const Doubles& a, const Doubles& b, Doubles& least) {
    least = a < b ? a : b;
}

[[gnu::always_inline]] inline void max_lanes(const Doubles& a, const Doubles& b, Doubles& most) {
    most = a > b ? a : b;
}

[[gnu::always_inline]] inline bool any(const Masks& m) { return ((m[0] | m[1]) | (m[2] | m[3])) != 0; }

// ---- spans ---------------------------------------------------------------------------------------------------------

/// Four triangles, ready to be filled.
///
/// E_k(x, y) = ax x + (dx kSnapsPerSample y + c) of the edge opposite corner k: zero on it, positive inside; E_k / area
/// is the weight of corner k. All its values are whole numbers below 2^53 (maps of 2^14 samples, kGuard,
/// kSnapsPerSample = 2^10), so double arithmetic on them is exact. E >= fill: covered; 0 where the edge is a top or a
/// left one, 1 elsewhere.
struct Edges {
    std::array<Doubles, 3> dx, ax, c, fill, r;
    std::array<Doubles, 3> towards;  ///< -1 / ax
    std::array<Doubles, 3> inwards;  ///< 1 where ax > 0, else -1: from outside the edge to inside
    Doubles inverse_area, r_x, r_low, r_high;
    Doubles x_first, x_last, y_first, y_last;  ///< samples of the bounding box that lie in the map
};

[[gnu::always_inline]] inline void find_edge(const Doubles& ax, const Doubles& ay, const Doubles& bx, const Doubles& by,
                                             int k, Edges& e) {
    const Doubles zero{};
    const Doubles dy = by - ay;
    e.dx[k]          = bx - ax;
    e.ax[k]          = -dy * kSnapsPerSample;
    e.towards[k]     = -1 / e.ax[k];
    e.inwards[k]     = e.ax[k] > zero ? zero + 1 : zero - 1;
    e.c[k]           = dy * ax - e.dx[k] * ay;
    e.fill[k]        = ((dy < zero) | ((dy == zero) & (e.dx[k] > zero))) ? zero : zero + 1;
}

/// All but the bounding box.
[[gnu::always_inline]] inline void find_edges(const std::array<Doubles, 3>& x, const std::array<Doubles, 3>& y,
                                              const std::array<Doubles, 3>& r, Edges& e) {
    find_edge(x[1], y[1], x[2], y[2], 0, e);
    find_edge(x[2], y[2], x[0], y[0], 1, e);
    find_edge(x[0], y[0], x[1], y[1], 2, e);
    const Doubles zero{};
    const Doubles one  = zero + 1;
    const Doubles area = e.c[0] + e.c[1] + e.c[2];
    e.r                = r;
    e.inverse_area     = 1 / area;
    e.r_x              = (e.ax[0] * r[0] + e.ax[1] * r[1] + e.ax[2] * r[2]) * e.inverse_area;
    min_lanes(r[0], r[1], e.r_low);
    min_lanes(e.r_low, r[2], e.r_low);
    max_lanes(r[0], r[1], e.r_high);
    max_lanes(e.r_high, r[2], e.r_high);
    for (Doubles* limit : {&e.r_low, &e.r_high}) {
        max_lanes(*limit, zero, *limit);
        min_lanes(*limit, one, *limit);
    }
}

/// The spans of rows y, a row a lane: samples [first, last], which may be empty, and the nearness at `first`.
[[gnu::always_inline]] inline void find_spans(const Edges& e, const Doubles& y, Doubles& first, Doubles& last,
                                              Doubles& r_first) {
    const Doubles zero{};
    const Doubles before = e.x_first - 1, after = e.x_last + 1;
    std::array<Doubles, 3> value;  // E at x = 0
    first = e.x_first;
    last  = e.x_last;
    for (int k = 0; k < 3; ++k) {
        value[k]        = e.dx[k] * (y * kSnapsPerSample) + e.c[k];
        const Doubles c = value[k] - e.fill[k];  // covered where ax x + c >= 0
        // The quotient may be off by a rounding, and the nearest whole number may be on either side: neighbours settle
        // it exactly, towards the inside and then back.
        Doubles at = c * e.towards[k];
        round_lanes(at, at);
        max_lanes(at, before, at);
        min_lanes(at, after, at);
        at += e.ax[k] * at + c < zero ? e.inwards[k] : zero;
        const Doubles back  = at - e.inwards[k];
        at                  = e.ax[k] * back + c >= zero ? back : at;
        const Doubles low   = e.ax[k] > zero ? at : first;
        const Doubles level = c < zero ? before : last;
        const Doubles high  = e.ax[k] < zero ? at : e.ax[k] == zero ? level : last;
        max_lanes(first, low, first);
        min_lanes(last, high, last);
    }
    // From exact weights at the first sample: a plane through slivers would not be exact anywhere.
    r_first = (e.ax[0] * first + value[0]) * e.r[0];
    r_first += (e.ax[1] * first + value[1]) * e.r[1];
    r_first += (e.ax[2] * first + value[2]) * e.r[2];
    r_first *= e.inverse_area;
}

// ---- depths --------------------------------------------------------------------------------------------------------

template <DepthFormat format>
[[gnu::always_inline]] inline void encode(const Doubles& r, std::uint32_t far_word, Words& bits) {
    if constexpr (format == DepthFormat::float32) {
        const Lanes<float, kFour> kept = __builtin_convertvector(r, Lanes<float, kFour>);
        bits                           = far_word - reinterpret_cast<Words>(kept);
    } else {
        // Adding 2^52 leaves the rounded whole number in the low bits.
        bits = __builtin_convertvector(reinterpret_cast<Masks>((1 - r) * far_word + 0x1p52), Words);
    }
}

template <DepthFormat format>
[[gnu::always_inline]] inline std::uint32_t encode_one(double r, std::uint32_t far_word) {
    if constexpr (format == DepthFormat::float32) return far_word - std::bit_cast<std::uint32_t>(static_cast<float>(r));
    return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>((1 - r) * far_word + 0x1p52));
}

/// Calls body with the format as a constant.
template <class Body>
auto with_format(DepthFormat format, const Body& body) {
    switch (format) {
        case DepthFormat::unorm16: return body(std::integral_constant<DepthFormat, DepthFormat::unorm16>());
        case DepthFormat::unorm24: return body(std::integral_constant<DepthFormat, DepthFormat::unorm24>());
        case DepthFormat::unorm32: return body(std::integral_constant<DepthFormat, DepthFormat::unorm32>());
        case DepthFormat::float32: break;
    }
    return body(std::integral_constant<DepthFormat, DepthFormat::float32>());
}

// ---- narrow triangles ----------------------------------------------------------------------------------------------

using Columns = Lanes<std::int32_t>;
using RowBits = Lanes<std::uint32_t>;

/// Column x has its bits in byte x % 4, bit 0 for the first of eight rows.
constexpr RowBits kFirstRow{1, 1 << 8, 1 << 16, 1 << 24, 1, 1 << 8, 1 << 16, 1 << 24};

/// Bit 8 y + x of the result is row y of column x.
[[gnu::always_inline]] inline std::uint64_t row_by_row(const RowBits& columns) {
    std::array<std::uint64_t, 4> pairs;
    std::memcpy(pairs.data(), &columns, sizeof columns);
    const std::uint64_t left = pairs[0] | pairs[1], right = pairs[2] | pairs[3];
    std::uint64_t bits = ((left | left >> 32) & 0xffffffff) | ((right | right << 32) & ~std::uint64_t{0xffffffff});
    // An 8 x 8 matrix transposed: its elements, then blocks of 2 x 2, then of 4 x 4 change places.
    const auto swap = [&bits](int distance, std::uint64_t mask) {
        const std::uint64_t differing = (bits ^ (bits >> distance)) & mask;
        bits ^= differing ^ (differing << distance);
    };
    swap(7, 0x00aa00aa00aa00aa);
    swap(14, 0x0000cccc0000cccc);
    swap(28, 0x00000000f0f0f0f0);
    return bits;
}

// ---- filling large triangles ---------------------------------------------------------------------------------------

// Ways to keep a sample. Fragments have no triangle: where it is asked for, all triangles are large.

struct Nearest {
    static constexpr bool kNamed = false;
    std::uint32_t* words;
    void operator()(std::size_t sample, std::uint32_t word, const uvec3*) const {
        words[sample] = std::min(words[sample], word);
    }
};

struct NearestBehind {
    static constexpr bool kNamed = false;
    const std::uint32_t* first;
    std::uint32_t roundings;
    std::uint32_t* words;
    void operator()(std::size_t sample, std::uint32_t word, const uvec3*) const {
        if (word > first[sample] && word - first[sample] > roundings) words[sample] = std::min(words[sample], word);
    }
};

struct Owner {
    static constexpr bool kNamed = true;
    const std::uint32_t* words;
    const uvec3* all;
    std::span<const std::size_t> asked;
    std::vector<std::uint64_t> is_asked;  ///< a bit a sample: few are, and most that are drawn are not
    std::span<std::uint32_t> owners;
    void operator()(std::size_t sample, std::uint32_t word, const uvec3* triangle) const {
        if ((is_asked[sample / 64] >> (sample % 64) & 1) == 0 || word != words[sample]) return;
        const auto at        = std::ranges::lower_bound(asked, sample) - asked.begin();
        std::uint32_t& owner = owners[static_cast<std::size_t>(at)];
        owner                = std::min(owner, static_cast<std::uint32_t>(triangle - all));
    }
};

/// Rows [row_begin, row_end) of one triangle.
template <DepthFormat format, class Keep>
UMBRA_FOR_EACH_PROCESSOR void fill(const Snapped& t, int row_begin, int row_end, const Drawing& drawing,
                                   const Keep& keep) {
    Edges e;
    std::array<Doubles, 3> x, y, r;
    for (int k = 0; k < 3; ++k) {
        spread(t.x[k], x[k]);
        spread(t.y[k], y[k]);
        spread(t.r[k], r[k]);
    }
    find_edges(x, y, r, e);
    const auto [x_low, x_high] = std::ranges::minmax(t.x);
    const auto [y_low, y_high] = std::ranges::minmax(t.y);
    spread(std::max(std::ceil(x_low / kSnapsPerSample), 0.0), e.x_first);
    spread(std::min(std::floor(x_high / kSnapsPerSample), drawing.width - 1.0), e.x_last);
    const int y_first = std::max(static_cast<int>(std::ceil(y_low / kSnapsPerSample)), row_begin);
    const int y_last  = std::min(static_cast<int>(std::floor(y_high / kSnapsPerSample)), row_end - 1);

    constexpr Doubles kSteps{0, 1, 2, 3};
    constexpr Ints kWholeSteps{0, 1, 2, 3};
    const std::size_t band_end = static_cast<std::size_t>(row_end) * drawing.width;
    const Doubles r_low = e.r_low, r_high = e.r_high;
    const double r_x             = e.r_x[0];
    const std::uint32_t far_word = drawing.code.far_word;
    for (int row = y_first; row <= y_last; row += kFour) {
        Doubles rows, first, last, r_first;
        for (int k = 0; k < kFour; ++k) rows[k] = row + k;
        find_spans(e, rows, first, last, r_first);
        for (int k = 0; k < std::min(kFour, y_last - row + 1); ++k) {
            const int begin        = static_cast<int>(first[k]);
            const int count        = static_cast<int>(last[k]) - begin + 1;
            const double r_begin   = r_first[k];
            const std::size_t from = static_cast<std::size_t>(row + k) * drawing.width + begin;
            const auto word        = [&](const Doubles& steps, Words& words) {
                Doubles at;
                max_lanes(r_begin + r_x * steps, r_low, at);
                min_lanes(at, r_high, at);
                encode<format>(at, far_word, words);
            };
            int i = 0;
            if constexpr (std::is_same_v<Keep, Nearest>) {
                const auto take = [&](int at, const Words& words) {
                    Words kept;
                    std::memcpy(&kept, keep.words + from + at, sizeof kept);
                    kept = kept < words ? kept : words;
                    std::memcpy(keep.words + from + at, &kept, sizeof kept);
                };
                Words words, next;
                for (Doubles steps = kSteps; i + 2 * kFour <= count; i += 2 * kFour, steps += 2.0 * kFour) {
                    word(steps, words);
                    word(steps + kFour, next);
                    take(i, words);
                    take(i + kFour, next);
                }
                // Samples behind the span's last one get their own word again, which is safe within the band.
                if (from + count + kFour <= band_end)
                    for (; i < count; i += kFour) {
                        word(kSteps + i, words);
                        take(i, words | reinterpret_cast<Words>(kWholeSteps >= count - i));
                    }
            }
            for (; i < count; i += kFour) {
                Words words;
                word(kSteps + i, words);
                for (int l = 0; l < std::min(kFour, count - i); ++l) keep(from + i + l, words[l], t.from);
            }
        }
    }
}

// ---- snapping and binning ------------------------------------------------------------------------------------------

/// Snaps the triangles of one chunk.
template <DepthFormat format>
class Snapper {
public:
    Snapper(const Drawing& drawing, bool all_large, Chunk& chunk)
        : drawing_(drawing), all_large_(all_large), chunk_(chunk) {
        chunk_.large.clear();
        for (Chunk::Band& band : chunk_.bands) {
            band.large.clear();
            band.count = 0;
        }
    }

    void snap(std::span<const uvec3> triangles) {
        for (std::size_t i = 0; i < triangles.size(); i += kFour)
            snap_four(triangles.subspan(i, std::min<std::size_t>(kFour, triangles.size() - i)));
    }

private:
    void snap_four(std::span<const uvec3> triangles);
    void clip_and_snap(const std::array<std::array<Doubles, 3>, 4>& corners, int lane, const uvec3* from);
    /// Triangles of `drawn` lanes, whose corners are in units of samples' spacings.
    void place(const std::array<Doubles, 3>& x, const std::array<Doubles, 3>& y, const std::array<Doubles, 3>& r,
               const Masks& drawn, const uvec3* const* from);
    /// Triangles of at most kNarrow columns and kTall rows.
    void add_narrow(const Edges& e, const Masks& drawn);
    void add_row(const Edges& e, int lane, int x, int y, int count);

    const Drawing& drawing_;
    bool all_large_;
    Chunk& chunk_;
};

template <DepthFormat format>
UMBRA_FOR_EACH_PROCESSOR void Snapper<format>::snap_four(std::span<const uvec3> triangles) {
    // X, Y, R and W of three corners. Lanes without a triangle take the last one's, and are not drawn.
    std::array<std::array<Doubles, 3>, 4> c;
    std::array<const uvec3*, kFour> from;
    Masks drawn{};
    for (int l = 0; l < kFour; ++l) {
        from[l]  = &triangles[std::min<std::size_t>(l, triangles.size() - 1)];
        drawn[l] = l < static_cast<int>(triangles.size()) ? -1 : 0;
    }
    const dmat4& m = drawing_.clip_from_world;
    for (int k = 0; k < 3; ++k) {
        Doubles x, y, z;
        for (int l = 0; l < kFour; ++l) {
            const vec3& p = drawing_.positions[(*from[l])[k]];
            x[l] = p.x, y[l] = p.y, z[l] = p.z;
        }
        for (int i = 0; i < 4; ++i) c[i][k] = (m[0][i] * x + m[1][i] * y) + (m[2][i] * z + m[3][i]);
    }

    // Not drawn: all corners beyond one side of the map, or behind the light.
    const auto& [X, Y, R, W] = c;
    Masks left = ~Masks{}, right = left, above = left, below = left, behind = left, inside = left;
    for (int k = 0; k < 3; ++k) {
        left &= X[k] < -W[k];
        right &= X[k] > W[k];
        above &= Y[k] < -W[k];
        below &= Y[k] > W[k];
        behind &= W[k] < kMinW;
        const Doubles guard = kGuard * W[k];
        inside &=
            (W[k] - kMinW >= 0) & (guard - X[k] >= 0) & (guard + X[k] >= 0) & (guard - Y[k] >= 0) & (guard + Y[k] >= 0);
    }
    drawn &= ~(left | right | above | below | behind);
    if (!any(drawn)) return;
    if (const Masks cut = drawn & ~inside; any(cut)) {
        for (int l = 0; l < kFour; ++l)
            if (cut[l] != 0) clip_and_snap(c, l, from[l]);
        drawn &= inside;
        if (!any(drawn)) return;
    }

    std::array<Doubles, 3> x, y, r;
    const double width = drawing_.width, height = drawing_.height;
    for (int k = 0; k < 3; ++k) {
        const Doubles inverse_w = 1 / W[k];
        round_lanes(((X[k] * inverse_w + 1) * width - 1) * (kSnapsPerSample / 2.0), x[k]);
        round_lanes(((Y[k] * inverse_w + 1) * height - 1) * (kSnapsPerSample / 2.0), y[k]);
        r[k] = R[k] * inverse_w;
    }
    place(x, y, r, drawn, from.data());
}

template <DepthFormat format>
void Snapper<format>::clip_and_snap(const std::array<std::array<Doubles, 3>, 4>& corners, int lane, const uvec3* from) {
    ClippedPolygon<dvec4, 8> polygon;
    for (int k = 0; k < 3; ++k)
        polygon.add({corners[0][k][lane], corners[1][k][lane], corners[2][k][lane], corners[3][k][lane]});
    for (std::size_t plane = 0; plane < 5; ++plane)
        polygon.cut<CutFrom::inner>([plane](const dvec4& c) { return distances(c)[plane]; });
    std::array<Doubles, 3> x{}, y{}, r{};
    for (std::size_t i = 2; i < polygon.count; ++i) {
        const std::array<const dvec4*, 3> fan{&polygon.corners[0], &polygon.corners[i - 1], &polygon.corners[i]};
        for (int k = 0; k < 3; ++k) {
            const dvec4& v         = *fan[k];
            const double inverse_w = 1 / v.w;
            Doubles at{((v.x * inverse_w + 1) * drawing_.width - 1) * (kSnapsPerSample / 2.0),
                       ((v.y * inverse_w + 1) * drawing_.height - 1) * (kSnapsPerSample / 2.0)};
            round_lanes(at, at);
            x[k][0] = at[0], y[k][0] = at[1], r[k][0] = v.z * inverse_w;
        }
        const std::array<const uvec3*, kFour> all{from, from, from, from};
        place(x, y, r, Masks{-1, 0, 0, 0}, all.data());
    }
}

template <DepthFormat format>
void Snapper<format>::place(const std::array<Doubles, 3>& x, const std::array<Doubles, 3>& y,
                            const std::array<Doubles, 3>& r, const Masks& drawn, const uvec3* const* from) {
    const Doubles zero{};
    Edges e;
    Masks narrow = all_large_ ? Masks{} : ~Masks{};
    // Samples within the bounding box and the map. Small are triangles that are, within the map or not.
    const auto box = [&](const std::array<Doubles, 3>& v, int samples, int small, Doubles& first, Doubles& last) {
        Doubles low, high;
        min_lanes(v[0], v[1], low);
        min_lanes(low, v[2], low);
        max_lanes(v[0], v[1], high);
        max_lanes(high, v[2], high);
        low *= 1.0 / kSnapsPerSample;
        high *= 1.0 / kSnapsPerSample;
        round_lanes(low, first);
        round_lanes(high, last);
        first = first < low ? first + 1 : first;
        last  = last > high ? last - 1 : last;
        narrow &= last - first < small;
        max_lanes(first, zero, first);
        min_lanes(last, zero + (samples - 1), last);
    };
    box(x, drawing_.width, kNarrow, e.x_first, e.x_last);
    box(y, drawing_.height, kTall, e.y_first, e.y_last);

    // With y down, anticlockwise corners have negative area.
    const Doubles area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    Masks kept         = drawn & (e.x_first <= e.x_last) & (e.y_first <= e.y_last) & (area != zero);
    if (drawing_.faces == Faces::front) kept &= area < zero;
    if (drawing_.faces == Faces::back) kept &= area > zero;
    if (!any(kept)) return;

    const std::array<Doubles, 3> px{x[0], area < zero ? x[2] : x[1], area < zero ? x[1] : x[2]};
    const std::array<Doubles, 3> py{y[0], area < zero ? y[2] : y[1], area < zero ? y[1] : y[2]};
    const std::array<Doubles, 3> pr{r[0], area < zero ? r[2] : r[1], area < zero ? r[1] : r[2]};

    narrow &= kept;
    if (const Masks large = kept & ~narrow; any(large)) {
        for (int l = 0; l < kFour; ++l) {
            if (large[l] == 0) continue;
            const auto index = static_cast<std::uint32_t>(chunk_.large.size());
            chunk_.large.push_back({{px[0][l], px[1][l], px[2][l]},
                                    {py[0][l], py[1][l], py[2][l]},
                                    {pr[0][l], pr[1][l], pr[2][l]},
                                    from[l]});
            for (int band = static_cast<int>(e.y_first[l]) >> kBandShift;
                 band <= static_cast<int>(e.y_last[l]) >> kBandShift; ++band)
                chunk_.bands[band].large.push_back(index);
        }
    }
    if (!any(narrow)) return;
    find_edges(px, py, pr, e);
    add_narrow(e, narrow);
}

template <DepthFormat format>
void Snapper<format>::add_row(const Edges& e, int lane, int x, int y, int count) {
    double r = 0;
    for (int k = 0; k < 3; ++k)
        r += (e.ax[k][lane] * x + (e.dx[k][lane] * (static_cast<double>(y) * kSnapsPerSample) + e.c[k][lane])) *
             e.r[k][lane];
    r *= e.inverse_area[lane];
    Chunk::Band& band = chunk_.bands[y >> kBandShift];
    if (band.fragments.size() < band.count + kNarrow) band.fragments.resize(2 * band.fragments.size() + kNarrow);
    Fragment* const to         = band.fragments.data() + band.count;
    const std::uint32_t sample = static_cast<std::uint32_t>(y) * drawing_.width + x;
    for (int i = 0; i < count; ++i)
        to[i] = {sample + i, encode_one<format>(std::min(std::max(r + e.r_x[lane] * i, e.r_low[lane]), e.r_high[lane]),
                                                drawing_.code.far_word)};
    band.count += count;
}

template <DepthFormat format>
void Snapper<format>::add_narrow(const Edges& e, const Masks& drawn) {
    // E - fill at the first sample of the box, and its steps: whole numbers below 2^31 in the box and around it, since
    // the triangle is small beyond the map, too.
    std::array<std::array<std::int32_t, kFour>, 3> at_first, right, down;
    for (int k = 0; k < 3; ++k) {
        const auto to_int = [](const Doubles& from, std::array<std::int32_t, kFour>& to) {
            const Ints whole = __builtin_convertvector(from, Ints);
            std::memcpy(to.data(), &whole, sizeof whole);
        };
        to_int(e.ax[k] * e.x_first + (e.dx[k] * (e.y_first * kSnapsPerSample) + e.c[k]) - e.fill[k], at_first[k]);
        to_int(e.ax[k], right[k]);
        to_int(e.dx[k] * kSnapsPerSample, down[k]);
    }
    constexpr Columns kColumns{0, 1, 2, 3, 4, 5, 6, 7};
    for (int l = 0; l < kFour; ++l) {
        if (drawn[l] == 0) continue;
        const int x_first = static_cast<int>(e.x_first[l]), columns = static_cast<int>(e.x_last[l]) - x_first + 1;
        const int y_first = static_cast<int>(e.y_first[l]), y_last = static_cast<int>(e.y_last[l]);
        Columns e0 = at_first[0][l] + right[0][l] * kColumns;
        Columns e1 = at_first[1][l] + right[1][l] * kColumns;
        Columns e2 = at_first[2][l] + right[2][l] * kColumns;
        for (int y = y_first; y <= y_last; y += 8) {
            // Column by column, a bit a row.
            RowBits hit{}, bit = kFirstRow;
            for (int row = y; row <= std::min(y + 7, y_last); ++row) {
                hit |= reinterpret_cast<RowBits>((e0 | e1 | e2) >= 0) & bit;
                bit += bit;
                e0 += down[0][l], e1 += down[1][l], e2 += down[2][l];
            }
            hit &= reinterpret_cast<RowBits>(kColumns < columns);
            std::uint64_t rows = row_by_row(hit);
            while (rows != 0) {
                const int shift    = std::countr_zero(rows) & ~7;
                const auto samples = static_cast<std::uint32_t>(rows >> shift & 0xff);
                rows &= ~(std::uint64_t{0xff} << shift);
                add_row(e, l, x_first + std::countr_zero(samples), y + shift / 8,
                        std::countr_one(samples >> std::countr_zero(samples)));
            }
        }
    }
}

/// Hands `keep` all samples that triangles cover, each once a triangle.
template <class Keep>
void rasterise(const Drawing& drawing, const Keep& keep) {
    // Tasks of kChunk triangles each, however the runs are cut: task i is pieces [starts[i], starts[i + 1]).
    std::vector<std::span<const uvec3>> pieces;
    std::vector<std::size_t> starts;
    std::size_t room = 0;
    for (std::span<const uvec3> run : drawing.runs)
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

    const std::size_t bands = static_cast<std::size_t>((drawing.height + kBandRows - 1) / kBandRows);
    std::vector<Chunk> chunks(std::min(kBatch, tasks));
    for (Chunk& chunk : chunks) chunk.bands.resize(bands);

    with_format(drawing.code.format, [&](auto format) {
        for (std::size_t batch = 0; batch < tasks; batch += kBatch) {
            const std::size_t count = std::min(kBatch, tasks - batch);
            parallel_ranges(count, 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    Snapper<format.value> snapper(drawing, Keep::kNamed, chunks[i]);
                    for (std::size_t piece = starts[batch + i]; piece < starts[batch + i + 1]; ++piece)
                        snapper.snap(pieces[piece]);
                }
            });
            parallel_ranges(bands, 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t b = begin; b < end; ++b) {
                    const int row_begin = static_cast<int>(b) * kBandRows;
                    const int row_end   = std::min(row_begin + kBandRows, drawing.height);
                    for (std::size_t i = 0; i < count; ++i) {
                        const Chunk::Band& band = chunks[i].bands[b];
                        for (std::uint32_t t : band.large)
                            fill<format.value>(chunks[i].large[t], row_begin, row_end, drawing, keep);
                        for (std::size_t f = 0; f < band.count; ++f)
                            keep(band.fragments[f].sample, band.fragments[f].word, nullptr);
                    }
                }
            });
        }
    });
}

}  // namespace

std::uint32_t depth_word(const DepthCode& code, double r) {
    return with_format(code.format, [&](auto format) { return encode_one<format.value>(r, code.far_word); });
}

void keep_nearest(const Drawing& drawing, std::uint32_t* words) { rasterise(drawing, Nearest{words}); }

void keep_nearest_behind(const Drawing& drawing, const std::uint32_t* first, std::uint32_t roundings,
                         std::uint32_t* words) {
    rasterise(drawing, NearestBehind{first, roundings, words});
}

void keep_owners(const Drawing& drawing, const std::uint32_t* words, std::span<const uvec3> all,
                 std::span<const std::size_t> asked, std::span<std::uint32_t> owners) {
    std::vector<std::uint64_t> is_asked((static_cast<std::size_t>(drawing.width) * drawing.height + 63) / 64);
    for (const std::size_t sample : asked) is_asked[sample / 64] |= std::uint64_t{1} << (sample % 64);
    rasterise(drawing, Owner{words, all.data(), asked, std::move(is_asked), owners});
}

}  // namespace umbra
