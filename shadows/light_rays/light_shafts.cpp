#include "umbra/shadows/light_rays/light_shafts.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "umbra/core/base/lanes.h"

namespace umbra::rays {

namespace {

// In ray space the scene is about 1 wide, and rays err by some 1e-7.
constexpr double kFarthest = 0x1p20;  ///< of a light from the origin: beyond, floats tell its points apart no more
constexpr double kWider    = 1e-5;    ///< shafts on each side, relative to how far from the origin their end is
constexpr double kRise     = 1e-3;    ///< sine of the least angle between a ray and the plane that it starts on
constexpr double kInPlane  = 1e-11;   ///< heights that count as 0: far below those at which rays start (StartPlaces)
constexpr double kInside   = 1e-4;    ///< how far inside a triangle all rays have to meet it

// How many triangles may reach into a shaft before it is given up, and a smaller one is not tried.
constexpr std::size_t kFew = 32, kMany = ~std::size_t{0};

struct DBox {
    dvec3 low{+HUGE_VAL}, high{-HUGE_VAL};
    void add(dvec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
    [[nodiscard]] bool empty() const { return low.x > high.x; }
    [[nodiscard]] dvec3 corner(int k) const {
        return {(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z};
    }
    [[nodiscard]] DBox wider() const {
        const dvec3 most = glm::max(glm::abs(low), glm::abs(high));
        const double by  = kWider * std::max({1.0, most.x, most.y, most.z});
        return {low - by, high + by};
    }
};

struct ShaftPlane {
    dvec3 normal{0};  ///< to the outside
    double offset = 0;
    [[nodiscard]] double above(dvec3 p) const { return glm::dot(normal, p) - offset; }
};

}  // namespace

/// A run of points that lie in one plane, or several such runs.
struct LightShafts::Run {
    bool asks     = false;  ///< some of its points ask
    bool flat     = false;  ///< those lie in the plane of `on`
    TriangleId on = kNoTriangle;
    dvec3 normal{0};  ///< of that plane, unit, to the points' front
    DBox box;         ///< around those that ask
};

/// Triangles that reach into a shaft.
struct LightShafts::Few {
    std::array<TriangleId, kFew> ids{};
    std::size_t count = 0;  ///< kMany: more than it is worth looking at
};

class LightShafts::Shaft {
public:
    /// Around a box of points in the plane through `in_plane`, above which all of the light is, and a box of the light,
    /// both along `axes`.
    Shaft(const DBox& points, const DBox& light, const dmat3& axes, dvec3 in_plane, dvec3 normal)
        : axes_(axes), points_(points.wider()), light_(light.wider()), floor_{normal, glm::dot(normal, in_plane)} {
        for (int k = 0; k < 8; ++k) {
            ends_[0][k] = axes_ * points_.corner(k), ends_[1][k] = axes_ * light_.corner(k);
            all_.add(ends_[0][k]), all_.add(ends_[1][k]);
            rise_ = std::min(rise_, floor_.above(ends_[1][k]));
        }
        // Along each axis: planes that hold a corner of either box, seen along that axis, and have both on one side.
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            for (const int corner : {0, 1, 2, 3}) {
                const bool top_i = (corner & 1) != 0, top_j = (corner & 2) != 0;
                const double ai = top_i ? points_.high[i] : points_.low[i],
                             aj = top_j ? points_.high[j] : points_.low[j], bi = top_i ? light_.high[i] : light_.low[i],
                             bj = top_j ? light_.high[j] : light_.low[j];
                double ni = bj - aj, nj = ai - bi;
                const double length = std::hypot(ni, nj);
                if (!(length > 0)) continue;
                const double out = top_i == (ni > 0) ? 1 / length : -1 / length;
                ni *= out, nj *= out;
                if ((ni != 0 && top_i != (ni > 0)) || (nj != 0 && top_j != (nj > 0))) continue;
                add_side(ni * axes_[i] + nj * axes_[j], std::max(ni * ai + nj * aj, ni * bi + nj * bj));
            }
        }
        // Below the points' plane, and behind a flat light.
        planes_.add(-floor_.normal, -floor_.offset);
        if (light_.high[2] >= points_.high[2]) add_side(axes_[2], light_.high[2]);
        if (light_.low[2] <= points_.low[2]) add_side(-axes_[2], -light_.low[2]);
    }

    /// Around all rays.
    [[nodiscard]] const ShaftPlanes& planes() const { return planes_; }

    /// False only where no ray of the shaft meets the triangle.
    [[nodiscard]] bool may_meet(const std::array<dvec3, 3>& v) const {
        const dvec3 low = glm::min(glm::min(v[0], v[1]), v[2]), high = glm::max(glm::max(v[0], v[1]), v[2]);
        for (int k = 0; k < 3; ++k)
            if (low[k] > all_.high[k] || high[k] < all_.low[k]) return false;
        for (std::size_t s = 0; s < side_count_; ++s)
            if (std::ranges::all_of(v, [&](dvec3 q) { return sides_[s].above(q) > 0; })) return false;
        if (std::ranges::all_of(v, [&](dvec3 q) { return floor_.above(q) <= kInPlane; })) return false;
        return !is_beside_plane_of(v);
    }

    /// Whether all segments from the points' box to the light's pass through the triangle, well inside.
    [[nodiscard]] bool is_covered_by(const std::array<dvec3, 3>& v) const {
        const dvec3 normal  = glm::cross(v[1] - v[0], v[2] - v[0]);
        const double length = glm::length(normal);
        if (!(length > 0)) return false;
        const ShaftPlane plane{normal / length, glm::dot(normal / length, v[0])};
        const double side = plane.above(ends_[0][0]) > 0 ? 1 : -1;
        double least_here = HUGE_VAL, most_here = 0, least_there = HUGE_VAL;
        for (int k = 0; k < 8; ++k) {
            const double here = side * plane.above(ends_[0][k]);
            least_here = std::min(least_here, here), most_here = std::max(most_here, here);
            least_there = std::min(least_there, -side * plane.above(ends_[1][k]));
        }
        // A hundredth of their way on, all rays are above the height at which they start.
        if (!(least_here > kInside && least_there > kInside && 0.01 * rise_ > kWider)) return false;
        if (!(least_here > 0.01 * (least_here + least_there)) || !(least_there > 0.01 * (most_here + least_there)))
            return false;
        for (const dvec3 from : ends_[0])
            for (std::size_t e = 0; e < 3; ++e) {
                const dvec3 a = v[e] - from, b = v[(e + 1) % 3] - from;
                const dvec3 across = glm::cross(a, b) * -side;
                const double edge  = glm::length(b - a);
                for (const dvec3 to : ends_[1])
                    if (!(glm::dot(across, to - from) > kInside * edge * glm::length(to - from))) return false;
            }
        return true;
    }

private:
    void add_side(dvec3 normal, double offset) {
        sides_[side_count_++] = {normal, offset};
        planes_.add(normal, offset);
    }

    [[nodiscard]] bool is_beside_plane_of(const std::array<dvec3, 3>& v) const {
        const dvec3 n   = glm::cross(v[1] - v[0], v[2] - v[0]);
        const double at = glm::dot(n, v[0]);
        double least = HUGE_VAL, most = -HUGE_VAL;
        for (const auto& box : ends_)
            for (const dvec3 corner : box)
                least = std::min(least, glm::dot(n, corner) - at), most = std::max(most, glm::dot(n, corner) - at);
        return least > 0 || most < 0;
    }

    dmat3 axes_;
    DBox points_, light_;
    DBox all_;                                    ///< around both, along the axes of ray space
    std::array<std::array<dvec3, 8>, 2> ends_{};  ///< corners of both in ray space
    ShaftPlane floor_;                            ///< rays start on it and rise
    double rise_ = HUGE_VAL;                      ///< of the light above it, at least
    std::array<ShaftPlane, 14> sides_;
    std::size_t side_count_ = 0;
    ShaftPlanes planes_;  ///< the same, and the floor
};

std::array<dvec3, 3> LightShafts::corners(TriangleId t) const {
    const auto at = [&](int k) { return dvec3(space_.point(scene_->vertex(t, k))); };
    return {at(0), at(1), at(2)};
}

LightShafts::LightShafts(const Scene& scene, const RaySpace& space, const ShaftTree& tree, const Target& target)
    : scene_(&scene), space_(space), tree_(&tree) {
    if (!is_area(target.kind) || target.unit != 1) return;
    if (target.kind == LightKind::sphere) {
        low_ = target.sphere - target.radius, high_ = target.sphere + target.radius;
    } else {
        const dvec3 u(target.axis_u), v(target.axis_v), normal = glm::cross(u, v);
        if (!(glm::length(u) > 0 && glm::length(normal) > 0)) return;
        axes_[0] = glm::normalize(u), axes_[2] = glm::normalize(normal), axes_[1] = glm::cross(axes_[2], axes_[0]);
        const dvec3 centre = glm::transpose(axes_) * dvec3(target.centre);
        const dvec3 reach  = glm::abs(glm::transpose(axes_) * u) + glm::abs(glm::transpose(axes_) * v);
        low_ = centre - reach, high_ = centre + reach;
    }
    const dvec3 most = glm::max(glm::abs(low_), glm::abs(high_));
    usable_          = std::max({most.x, most.y, most.z}) < kFarthest;
}

// ---- a tile --------------------------------------------------------------------------------------------------------

bool LightShafts::in_one_plane(TriangleId t, TriangleId with) const {
    const std::array<dvec3, 3> a = corners(with), b = corners(t);
    const dvec3 u = a[1] - a[0], v = a[2] - a[0], n = glm::cross(u, v);
    const double length = glm::length(n);
    // The plane of a sliver is known too badly.
    if (!(length > 1e-3 * glm::length(u) * glm::length(v))) return false;
    return std::ranges::all_of(b, [&](dvec3 q) { return std::abs(glm::dot(n, q - a[0])) <= kInPlane * length; });
}

LightShafts::Run LightShafts::look_at(const PointBatch& points, LightId light, std::size_t first, std::size_t count,
                                      const Starts& starts) const {
    Run run;
    TriangleId last = kNoTriangle;
    for (std::size_t k = 0; k < count; ++k) {
        if (!points.asks(light, first + k)) continue;
        run.asks           = true;
        const TriangleId t = points.triangle[first + k];
        if (run.on == kNoTriangle) {
            run.on = t;
            if (!in_one_plane(t, t)) return run;
            run.normal = {starts.nx[k], starts.ny[k], starts.nz[k]};
        } else if (t != last && !in_one_plane(t, run.on)) {
            return run;
        }
        last = t;
        run.box.add(dvec3(starts.x[k], starts.y[k], starts.z[k]) * axes_);  // along each
    }
    run.flat = run.asks;
    return run;
}

LightShafts::Run LightShafts::joined(const Run& a, const Run& b) const {
    if (!a.asks || !b.asks) return a.asks ? a : b;
    Run both  = a;
    both.flat = a.flat && b.flat && (a.on == b.on || in_one_plane(b.on, a.on));
    both.box.add(b.box.low), both.box.add(b.box.high);
    return both;
}

/// Nothing where some of the light is not well above the run's plane.
std::optional<LightShafts::Shaft> LightShafts::shaft(const Run& run) const {
    const std::array<dvec3, 3> on = corners(run.on);
    dvec3 normal                  = glm::normalize(glm::cross(on[1] - on[0], on[2] - on[0]));
    if (glm::dot(normal, run.normal) < 0) normal = -normal;
    const DBox light{low_, high_};
    for (int k = 0; k < 8; ++k) {
        const dvec3 corner = light.corner(k);
        // No point is farther from it.
        const double farthest = glm::length(corner - run.box.low) + glm::length(run.box.high - run.box.low);
        if (!(glm::dot(normal, axes_ * corner - on[0]) > kRise * farthest)) return std::nullopt;
    }
    return Shaft(run.box, light, axes_, on[0], normal);
}

/// Decides a run by triangles of a list, or by all; `few` gets those that reach into its shaft.
Known LightShafts::resolve(const Run& run, const Few* among, Few& few) const {
    few.count = kMany;
    if (!run.flat) return Known::nothing;
    const std::optional<Shaft> shaft = this->shaft(run);
    if (!shaft) return Known::nothing;
    bool covered   = false;
    few.count      = 0;
    const auto ask = [&](TriangleId t) {
        const std::array<dvec3, 3> v = corners(t);
        if (!shaft->may_meet(v)) return;
        if (shaft->is_covered_by(v)) covered = true;
        if (few.count == kFew) few.count = kMany;
        if (few.count < kFew) few.ids[few.count++] = t;
    };
    const auto decided = [&] { return covered || few.count == kMany; };
    if (among != nullptr) {
        for (std::size_t k = 0; k < among->count && !decided(); ++k) ask(among->ids[k]);
    } else {
        tree_->visit(shaft->planes(), [&](const EightTriangles& eight, unsigned which) {
            for (; which != 0 && !decided(); which &= which - 1) ask(eight.id[std::countr_zero(which)]);
            return !decided();
        });
    }
    if (covered) return Known::umbra;
    return few.count == 0 ? Known::lit : Known::nothing;
}

UMBRA_FOR_EACH_PROCESSOR TileKnown LightShafts::known(const PointBatch& points, LightId light, const PointTile& tile,
                                                      const TileStarts& starts) const {
    TileKnown known{};
    if (!usable_) return known;
    std::array<Run, kRunsPerTile> runs;
    std::array<std::size_t, kRunsPerTile> block_of{};
    std::array<Run, 4> blocks;  // of 8 x 4 points
    std::size_t count = 0;
    tile.for_each_run([&](std::size_t first, std::size_t n) {
        runs[count]             = look_at(points, light, first, n, starts[count]);
        block_of[count]         = (first % tile.width - tile.x0) / 8 + (first / tile.width - tile.y0) / 4 * 2;
        blocks[block_of[count]] = joined(blocks[block_of[count]], runs[count]);
        ++count;
    });
    const Run whole = joined(joined(blocks[0], blocks[1]), joined(blocks[2], blocks[3]));
    if (!whole.asks) return known;

    Few in_tile, in_block, in_run;
    const Known of_tile = resolve(whole, nullptr, in_tile);
    if (of_tile != Known::nothing) {
        known.fill(of_tile);
        return known;
    }
    if (whole.flat && in_tile.count == kMany) return known;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (!blocks[b].asks) continue;
        const Known of_block = resolve(blocks[b], whole.flat ? &in_tile : nullptr, in_block);
        const bool few       = in_block.count != kMany;
        for (std::size_t r = 0; r < count; ++r) {
            if (block_of[r] != b) continue;
            known[r] = of_block;
            if (of_block != Known::nothing || !runs[r].asks) continue;
            if (few || !blocks[b].flat) known[r] = resolve(runs[r], few ? &in_block : nullptr, in_run);
        }
    }
    return known;
}

}  // namespace umbra::rays
