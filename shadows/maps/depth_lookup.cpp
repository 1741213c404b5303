#include "umbra/shadows/maps/depth_lookup.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "umbra/core/base/lanes.h"
#include "umbra/shadows/maps/penumbra.h"

namespace umbra {
namespace {

/// Does the map show anything nearer than the receiver at sample (i, j)?
bool is_blocked(const MapView& view, const Receiver& p, int i, int j, BiasMode mode) {
    if (i < 0 || j < 0 || i >= view.map.width() || j >= view.map.height()) return false;
    const bool halfway  = view.midpoint && !view.midpoint->is_empty(i, j);
    const DepthMap& map = halfway ? *view.midpoint : view.map;
    double r            = p.r;
    if (mode != BiasMode::manual) {
        const double plane = p.r + p.r_x * (i + 0.5 - p.x) + p.r_y * (j + 0.5 - p.y);
        if (mode == BiasMode::receiver_plane)
            r = plane;
        else
            r = plane + (halfway ? p.snapping : std::min(std::max(0.0, p.r - plane) + p.slack, p.most));
    }
    return map.nearness(i, j) > std::max(r + p.bias, 0.0);  // behind all that casts, r is negative
}

// Four at a time.
constexpr int kFour = 4;
using Doubles       = Lanes<double, kFour>;
using Masks         = Lanes<std::int64_t, kFour>;  ///< all bits, or none
using Ints          = Lanes<std::int32_t, kFour>;

/// Four positions in a map, in samples.
struct FourPlaces {
    Doubles x, y;
};

/// Four samples of a map, compared as is_blocked does in a view without midpoints.
struct FourSamples {
    Doubles nearness;  ///< where blocked
    Masks blocked;
};

/// Calls body with the mode as a constant.
template <class Body>
auto with_mode(BiasMode mode, const Body& body) {
    switch (mode) {
        case BiasMode::manual: return body(std::integral_constant<BiasMode, BiasMode::manual>());
        case BiasMode::receiver_plane: return body(std::integral_constant<BiasMode, BiasMode::receiver_plane>());
        case BiasMode::automatic: break;
    }
    return body(std::integral_constant<BiasMode, BiasMode::automatic>());
}

void floor_of(const Doubles& v, Doubles& whole) {
    round_lanes(v, whole);
    whole = whole > v ? whole - 1 : whole;
}

/// The nearness that four samples are compared with, as in is_blocked, where the point's plane has `plane`.
template <BiasMode mode>
void find_reference(const Receiver& p, const Doubles& plane, Doubles& r) {
    constexpr Doubles kZero{};
    r = mode == BiasMode::manual ? kZero + p.r : plane;
    if (mode == BiasMode::automatic) {
        const Doubles above = p.r - plane, eased = (above > 0 ? above : kZero) + p.slack;
        r += p.most < eased ? kZero + p.most : eased;
    }
    r += p.bias;
    r = r > 0 ? r : kZero;
}

/// Asks the four samples in which `at` lies. Inline, so that what it finds stays in registers.
template <BiasMode mode>
[[gnu::always_inline]] inline void ask(const MapView& view, const Receiver& p, const FourPlaces& at,
                                       FourSamples& found) {
    constexpr Doubles kZero{};
    Doubles x, y;
    floor_of(at.x, x), floor_of(at.y, y);
    const double width = view.map.width(), height = view.map.height();
    const Masks in_map = (x >= 0) & (y >= 0) & (x < width) & (y < height);
    Doubles r;
    find_reference<mode>(p, p.r + p.r_x * (x + 0.5 - p.x) + p.r_y * (y + 0.5 - p.y), r);
    view.map.nearness(__builtin_convertvector(in_map ? y * width + x : kZero, Ints), found.nearness);
    found.blocked = in_map & (found.nearness > r);
}

/// Calls body(places, n) for a disc's points, four at a time, of which the first n count: as far from the receiver as
/// `within`, turned as it says.
template <class Body>
void for_each_four(const Receiver& p, std::span<const dvec2> points, dvec2 within, const Body& body) {
    for (std::size_t from = 0; from < points.size(); from += kFour) {
        const std::size_t n = std::min<std::size_t>(kFour, points.size() - from);
        const auto of       = [&](std::size_t k) { return points[from + std::min(k, n - 1)]; };
        const dvec2 a = of(0), b = of(1), c = of(2), d = of(3);
        const Doubles x{a.x, b.x, c.x, d.x}, y{a.y, b.y, c.y, d.y};
        const FourPlaces at{p.x + within.x * (p.turn.x * x - p.turn.y * y),
                            p.y + within.y * (p.turn.y * x + p.turn.x * y)};
        body(at, static_cast<int>(n));
    }
}

/// Counts which of four are blocked, lane by lane.
class BlockedCount {
public:
    /// The first n of four.
    void add(const Masks& blocked, int n) {
        constexpr Masks kLane{0, 1, 2, 3};
        lanes_ -= blocked & (kLane < n);
    }
    [[nodiscard]] int all() const { return static_cast<int>((lanes_[0] + lanes_[1]) + (lanes_[2] + lanes_[3])); }

private:
    Masks lanes_{};
};

/// The fraction of a disc's samples that are not blocked, in a view without midpoints.
template <BiasMode mode>
double lit_in_disc(const MapView& view, const Receiver& p, const Filter& filter) {
    FourSamples samples;
    BlockedCount blocked;
    double lit = 0;
    for_each_four(p, filter.points, dvec2(filter.radius + 0.5), [&](const FourPlaces& at, int n) {
        if (!filter.bilinear) {
            ask<mode>(view, p, at, samples);
            blocked.add(samples.blocked, n);
            return;
        }
        for (int k = 0; k < n; ++k) {
            const double x = std::floor(at.x[k] - 0.5), y = std::floor(at.y[k] - 0.5);
            const double fx = at.x[k] - 0.5 - x, fy = at.y[k] - 0.5 - y;
            const FourPlaces corners{x + Doubles{0, 1, 0, 1}, y + Doubles{0, 0, 1, 1}};
            ask<mode>(view, p, corners, samples);
            const Doubles weights{(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
            const Doubles counts = samples.blocked ? Doubles{} : weights;
            lit += (counts[0] + counts[1]) + (counts[2] + counts[3]);
        }
    });
    const auto whole = static_cast<double>(filter.points.size());
    return (filter.bilinear ? lit : whole - blocked.all()) / whole;
}

/// soft_share, of any view.
template <BiasMode mode, bool midpoints>
float lit_softly(const MapView& view, const Receiver& receiver, double depth, const SoftFilter& filter) {
    const auto reach = [&](double z) { return penumbra_reach(view, dvec2(filter.size), z, depth, filter.texels); };
    FourSamples samples{};
    const auto ask_all = [&](const FourPlaces& at, int n) {
        if constexpr (!midpoints) return ask<mode>(view, receiver, at, samples);
        for (int k = 0; k < n; ++k) {
            const ivec2 sample(std::floor(at.x[k]), std::floor(at.y[k]));
            samples.blocked[k] = is_blocked(view, receiver, sample.x, sample.y, mode) ? -1 : 0;
            if (samples.blocked[k] != 0) samples.nearness[k] = view.map.nearness(sample.x, sample.y);
        }
    };
    // Where no sample of the search lies in the map, none blocks.
    const dvec2 search = reach(view.frame.near), at_map{receiver.x, receiver.y};
    const dvec2 size(view.map.width(), view.map.height());
    if (glm::any(glm::lessThan(at_map + search, dvec2(-1))) || glm::any(glm::greaterThan(at_map - search, size + 1.0)))
        return 1;
    double sum = 0;
    BlockedCount blockers;
    for_each_four(receiver, filter.points, search, [&](const FourPlaces& at, int n) {
        ask_all(at, n);
        blockers.add(samples.blocked, n);
        for (int k = 0; k < n; ++k)
            if (samples.blocked[k] != 0) sum += view.frame.depth(samples.nearness[k]);
    });
    if (blockers.all() == 0) return 1;
    BlockedCount blocked;
    for_each_four(receiver, filter.points, reach(sum / blockers.all()), [&](const FourPlaces& at, int n) {
        ask_all(at, n);
        blocked.add(samples.blocked, n);
    });
    const int whole = static_cast<int>(filter.points.size());
    return static_cast<float>(whole - blocked.all()) / static_cast<float>(whole);
}

/// The weight of the square's samples that are not blocked: is_blocked of each, with common terms of columns and rows
/// computed once. Rows of kBlocks times four samples are compared, all in the map; those beyond the square have no
/// weight.
template <int kBlocks, BiasMode mode>
double lit_in_square(const MapView& view, const Receiver& p, const SquareKernel& square) {
    constexpr Doubles kSteps{0, 1, 2, 3};
    constexpr Doubles kZero{};
    Doubles across[kBlocks], weight[kBlocks], lit{};
    for (int b = 0; b < kBlocks; ++b) {
        across[b] = p.r + p.r_x * (square.x + kFour * b + kSteps + 0.5 - p.x);
        std::memcpy(&weight[b], &square.across[kFour * b], sizeof weight[b]);
        weight[b] = kFour * b + kSteps < square.side ? weight[b] : kZero;
    }
    for (int j = 0; j < square.side; ++j) {
        const double down = p.r_y * (square.y + j + 0.5 - p.y), of_row = square.down[j];
        for (int b = 0; b < kBlocks; ++b) {
            Doubles nearest, r;
            view.map.nearness(square.x + kFour * b, square.y + j, nearest);
            find_reference<mode>(p, across[b] + down, r);
            lit += nearest > r ? kZero : weight[b] * of_row;
        }
    }
    return (lit[0] + lit[1]) + (lit[2] + lit[3]);
}

template <int kBlocks>
double lit_in_square(const MapView& view, const Receiver& p, BiasMode mode, const SquareKernel& square) {
    return with_mode(mode, [&](auto constant) { return lit_in_square<kBlocks, constant.value>(view, p, square); });
}

}  // namespace

UMBRA_FOR_EACH_PROCESSOR float lit_share(const MapView& view, const Receiver& p, BiasMode mode, const Filter& filter) {
    if (filter.is_one_sample())
        return is_blocked(view, p, static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)), mode) ? 0.0f
                                                                                                               : 1.0f;
    // Where no sample lies in the map, none blocks.
    const double reach = filter.radius + 2;
    if (p.x < -reach || p.y < -reach || p.x > view.map.width() + reach || p.y > view.map.height() + reach) return 1.0f;
    if (filter.kernel != Kernel::disc && filter.radius <= SquareKernel::kMostRadius && !view.midpoint) {
        const SquareKernel square = square_kernel({p.x, p.y}, filter);
        constexpr int kMostBlocks = SquareKernel::kMostInRow / kFour;
        const int blocks          = square.side <= 4 ? 1 : square.side <= 8 ? 2 : square.side <= 16 ? 4 : kMostBlocks;
        if (square.x >= 0 && square.y >= 0 && square.x + kFour * blocks <= view.map.width() &&
            square.y + square.side <= view.map.height()) {
            const double lit = blocks == 1   ? lit_in_square<1>(view, p, mode, square)
                               : blocks == 2 ? lit_in_square<2>(view, p, mode, square)
                               : blocks == 4 ? lit_in_square<4>(view, p, mode, square)
                                             : lit_in_square<kMostBlocks>(view, p, mode, square);
            return static_cast<float>(std::clamp(lit / square.whole, 0.0, 1.0));
        }
    }
    if (filter.kernel == Kernel::disc && !view.midpoint)
        return static_cast<float>(std::clamp(
            with_mode(mode, [&](auto constant) { return lit_in_disc<constant.value>(view, p, filter); }), 0.0, 1.0));
    double lit         = 0;
    const double whole = for_each_sample({p.x, p.y}, p.turn, filter, [&](int i, int j, double weight) {
        if (!is_blocked(view, p, i, j, mode)) lit += weight;
    });
    return static_cast<float>(std::clamp(lit / whole, 0.0, 1.0));
}

UMBRA_FOR_EACH_PROCESSOR float soft_share(const MapView& view, const Receiver& receiver, double depth, BiasMode mode,
                                          const SoftFilter& filter) {
    return with_mode(mode, [&](auto constant) {
        return view.midpoint ? lit_softly<constant.value, true>(view, receiver, depth, filter)
                             : lit_softly<constant.value, false>(view, receiver, depth, filter);
    });
}

std::optional<ivec2> blocked_sample(const MapView& view, const Receiver& p, BiasMode mode, const Filter& filter) {
    std::optional<ivec2> nearest;
    double least = std::numeric_limits<double>::infinity();
    for_each_sample({p.x, p.y}, p.turn, filter, [&](int i, int j, double) {
        const double distance = std::hypot(i + 0.5 - p.x, j + 0.5 - p.y);
        if (distance < least && is_blocked(view, p, i, j, mode)) least = distance, nearest = ivec2(i, j);
    });
    return nearest;
}

}  // namespace umbra
