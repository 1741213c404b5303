#include "umbra/shadows/volumes/counting_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "umbra/core/base/lanes.h"
#include "umbra/shadows/geometry/point_groups.h"

// Compiled so that loops over lanes become vector code: shadows/CMakeLists.txt.
namespace umbra {
namespace {

// ---- where to look from ---------------------------------------------------------------------------------------------

/// A direction along no axis, diagonal or other direction that scenes are built from: seen from there no edge hides
/// another and no plane is edge on.
const dvec3 kGeneric = glm::normalize(dvec3(0.5377014291, 0.6423909307, 0.5461827730));

ViewFrame looking_at(dvec3 target, dvec3 origin) {
    ViewFrame view;
    view.origin  = origin;
    view.forward = glm::normalize(target - origin);
    view.right =
        glm::normalize(glm::cross(view.forward, std::abs(view.forward.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
    view.down = glm::cross(view.forward, view.right);
    return view;
}

/// Limits of the coordinates of surface points, and of their distances along a line of sight, in eight lanes.
struct EightExtents {
    Lanes<float> low[3], high[3];
    Lanes<double> nearest = Lanes<double>{} + std::numeric_limits<double>::infinity();

    EightExtents() {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis]  = Lanes<float>{} + kInfinity;
            high[axis] = -low[axis];
        }
    }

    /// Points i to i + 7.
    UMBRA_FOR_EACH_PROCESSOR void add(const PointBatch& points, std::size_t i, const dvec3& eye, const dvec3& forward) {
        Lanes<float> nowhere;  // 0 where there is a point, else infinite
        for (std::size_t k = 0; k < kLanes; ++k) nowhere[k] = points.triangle[i + k] != kNoTriangle ? 0 : kInfinity;
        Lanes<double> ahead = __builtin_convertvector(nowhere, Lanes<double>);
        for (int axis = 0; axis < 3; ++axis) {
            Lanes<float> at;
            std::memcpy(&at, &(axis == 0 ? points.px : axis == 1 ? points.py : points.pz)[i], sizeof at);
            const Lanes<float> above = at + nowhere, below = at - nowhere;
            low[axis]  = above < low[axis] ? above : low[axis];
            high[axis] = below > high[axis] ? below : high[axis];
            ahead += (__builtin_convertvector(at, Lanes<double>) - eye[axis]) * forward[axis];
        }
        nearest = ahead < nearest ? ahead : nearest;
    }
};

/// The eye's view where all points lie well in front of it, but from a little beside the eye, so that planes and edges
/// that contain the eye, as in scenes laid out on a grid, or a light at the eye need no special case. A far eye comes
/// nearer on its line of sight, where double resolves more. Points without a raster may lie all around the eye: they
/// are looked at from outside their box.
ViewFrame choose_view(const PointBatch& points) {
    const bool perspective    = points.raster && points.raster->projection == Projection::perspective;
    const dvec3 eye           = perspective ? points.raster->eye : dvec3(0);
    const dvec3 forward       = perspective ? points.raster->forward : dvec3(0);
    constexpr std::size_t run = 16384;
    std::vector<EightExtents> extents((points.size() + run - 1) / run);
    parallel_ranges(extents.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r) {
            EightExtents eight;
            for (std::size_t i = r * run; i + kLanes <= std::min(points.size(), (r + 1) * run); i += kLanes)
                eight.add(points, i, eye, forward);
            extents[r] = eight;
        }
    });
    Box box;
    double nearest = std::numeric_limits<double>::infinity();  // to the eye, along the line of sight
    for (const EightExtents& e : extents)
        for (std::size_t k = 0; k < kLanes; ++k) {
            box = extend(box, {{e.low[0][k], e.low[1][k], e.low[2][k]}, {e.high[0][k], e.high[1][k], e.high[2][k]}});
            nearest = std::min(nearest, e.nearest[k]);
        }
    for (std::size_t i = points.size() / kLanes * kLanes; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        box     = extend(box, points.position(i));
        nearest = std::min(nearest, glm::dot(dvec3(points.position(i)) - eye, forward));
    }
    const dvec3 centre = 0.5 * (dvec3(box.min) + dvec3(box.max));
    double radius      = 0.5 * glm::length(dvec3(box.max) - dvec3(box.min));
    if (radius == 0) radius = std::max(0x1p-10 * glm::length(centre), 0x1p-60);

    dvec3 back = kGeneric;
    if (perspective) {
        const CameraFrame& f = *points.raster;
        const dvec3 to_eye   = f.eye - centre;
        const double away    = glm::length(to_eye);
        if (away > 8 * radius) {
            back = to_eye / away;
        } else if (nearest > 0x1p-20 * (radius + away)) {
            const dvec3 aside = (0x1p-14 * nearest) * kGeneric;
            return {f.eye + aside, f.right, -f.up, f.forward};
        }
    } else if (points.raster) {
        back = -points.raster->forward;
    }
    return looking_at(centre, centre + 4 * radius * back + 0x1p-10 * radius * kGeneric);
}

}  // namespace

// ---- the tree -------------------------------------------------------------------------------------------------------

CountingTree::CountingTree(const Scene& scene, const PointBatch& points)
    // Blocks of 4 x 4 pixels are a leaf, where all of them see a surface.
    : index_(std::move(
          grouped(points, 1, [&](std::size_t i) { return points.triangle[i] != kNoTriangle ? 0u : 1u; })[0])) {
    if (index_.empty()) return;
    view_ = choose_view(points);
    if (!points.raster)
        sort_in_plane(index_, [&](std::uint32_t i) {
            const dvec3 p = view_.seen(dvec3(points.position(i)));
            return dvec2(p.x, p.y) / p.z;
        });
    LeafPlaces places(points, index_, [&](TriangleId t) -> std::array<dvec3, 3> {
        const dvec3 a(scene.vertex(t, 0));
        return {a - view_.origin, dvec3(scene.vertex(t, 1)) - a, dvec3(scene.vertex(t, 2)) - a};
    });
    tree_ = Tree(index_.size(), [places, right = view_.right, down = view_.down, forward = view_.forward](
                                    auto& at, std::size_t begin, std::size_t end) mutable {
        places.find(begin, end);
        double* __restrict const x = &at[0][begin];
        double* __restrict const y = &at[1][begin];
        double* __restrict const w = &at[2][begin];
        for (std::size_t k = 0; k < Tree::kLeaf; ++k) {
            const double px = places.x[k], py = places.y[k], pz = places.z[k];
            const double depth = forward.x * px + forward.y * py + forward.z * pz;
            x[k]               = (right.x * px + right.y * py + right.z * pz) / depth;
            y[k]               = (down.x * px + down.y * py + down.z * pz) / depth;
            w[k]               = 1 / depth;
        }
    });
    for (std::size_t level = 0, width = Tree::kLeaf; level < tree_.levels.size(); ++level, width *= Tree::kBranches) {
        const auto triangle = [&](std::size_t i) {
            return level == 0 ? points.triangle[index_[i]] : own_[level - 1][i / (width / Tree::kBranches)];
        };
        RawVector<TriangleId> own(tree_.levels[level].size() * Tree::kBranches);
        parallel_ranges(own.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t child = begin; child < end; ++child) {
                const auto [first, last] = tree_.points_under(level, child);
                own[child]               = first < last ? triangle(first) : kNoTriangle;
                for (std::size_t i = first; i < last; i += level == 0 ? 1 : width / Tree::kBranches)
                    if (triangle(i) != own[child]) own[child] = kNoTriangle;
            }
        });
        own_.push_back(std::move(own));
    }
}

std::size_t CountingTree::memory_bytes() const {
    std::size_t bytes = index_.size() * sizeof(std::uint32_t) + tree_.memory_bytes();
    for (const auto& own : own_) bytes += own.size() * sizeof(TriangleId);
    return bytes;
}

// ---- the counts -----------------------------------------------------------------------------------------------------

PointCounts::PointCounts(const CountingTree& tree, const Scene& scene, const PointBatch& points, LightId light)
    : tree_(tree.tree_),
      index_(tree.index_),
      own_(tree.own_),
      scene_(scene),
      points_(points),
      asks_(tree_.leaf_count()),
      open_(tree_.leaf_count()),
      count_(tree_.leaf_count() * kLeaf),
      levels_(tree_.levels.size()) {
    const Facing* const facing = points.facing[light].data();
    parallel_ranges(asks_.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            unsigned asks = 0;
            for (std::size_t k = leaf * kLeaf; k < std::min(tree_.size, (leaf + 1) * kLeaf); ++k)
                asks |= static_cast<unsigned>(is_asked(facing[index_[k]])) << k % kLeaf;
            asks_[leaf] = static_cast<std::uint16_t>(asks);
            open_[leaf] = 0;
            if (asks != 0) std::fill_n(&count_[leaf * kLeaf], kLeaf, 0);
        }
    });
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        levels_[l].count.resize(tree_.levels[l].size());
        levels_[l].asks.resize(tree_.levels[l].size(), 0);
        const std::size_t nodes = l == 0 ? asks_.size() : levels_[l - 1].asks.size();
        for (std::size_t node = 0; node < nodes; ++node)
            if (l == 0 ? asks_[node] != 0 : levels_[l - 1].asks[node] != 0)
                levels_[l].asks[node / kFanOut] |= static_cast<std::uint8_t>(1u << node % kFanOut);
    }
}

/// Visits the nodes that a region may hold points of.
struct PointCounts::OneRegion {
    PointCounts& to;
    const Region& region;
    std::int32_t weight;

    /// `open` has a bit for each face that does not yet hold all of the node.
    template <class GoOn>
    void node(std::size_t level, std::size_t n, unsigned open, const GoOn& go_on) {
        const Tree::Node& boxes = to.tree_.levels[level][n];
        unsigned which          = boxes.meeting(region.box_min, region.box_max) & to.levels_[level].asks[n];
        if (which == 0) return;
        std::array<unsigned, kFanOut> still{open, open, open, open};  // of each branch
        for (unsigned rest = level > 0 && are_large(boxes, which) ? 0 : open; rest != 0; rest &= rest - 1) {
            const auto face        = static_cast<unsigned>(std::countr_zero(rest));
            const unsigned covered = cover(region.faces[face], boxes);
            which &= ~covered;
            if (which == 0) return;
            for (std::size_t k = 0; k < kFanOut; ++k) still[k] &= ~((covered >> (kFanOut + k) & 1u) << face);
        }
        if (region.cap != kNoTriangle)
            for (unsigned rest = which; rest != 0; rest &= rest - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(rest));
                if ((still[k] & 1u) == 0 || !is_at_cap(to.own_[level][n * kFanOut + k])) continue;
                if (region.on_light_s_side)
                    still[k] &= ~1u;
                else
                    which &= ~(1u << k);
            }
        for (; which != 0; which &= which - 1) {
            const auto k = static_cast<std::size_t>(std::countr_zero(which));
            if (still[k] == 0)
                std::atomic_ref(to.levels_[level].count[n][k]).fetch_add(weight, std::memory_order_relaxed);
            else
                go_on(k, still[k]);
        }
    }

    void leaf(std::size_t leaf, unsigned open) {
        const std::size_t first = leaf * kLeaf;
        const double* x         = &to.tree_.at[0][first];
        const double* y         = &to.tree_.at[1][first];
        const double* w         = &to.tree_.at[2][first];
        alignas(64) std::array<double, kLeaf> least;
        least.fill(std::numeric_limits<double>::infinity());
        for (; open != 0; open &= open - 1) {
            const HalfSpace f = region.faces[static_cast<std::size_t>(std::countr_zero(open))];
#pragma GCC unroll 1
            for (std::size_t k = 0; k < kLeaf; ++k) {
                const double value = (f.nx * x[k] + f.ny * y[k]) + (f.nz + f.nw * w[k]);
                least[k]           = value < least[k] ? value : least[k];
            }
        }
        unsigned within = 0, near = 0;
#pragma GCC unroll 1
        for (std::size_t k = 0; k < kLeaf; ++k) {
            within |= static_cast<unsigned>(least[k] > 1) << k;
            near |= static_cast<unsigned>(least[k] >= -1) << k;
        }
        for (near &= to.asks_[leaf] & ~within; near != 0; near &= near - 1) {
            const auto k = static_cast<std::size_t>(std::countr_zero(near));
            switch (near_point(first + k)) {
                case Near::within: within |= 1u << k; break;
                case Near::outside: break;
                case Near::open:
                    std::atomic_ref(to.open_[leaf]).fetch_or(std::uint16_t(1u << k), std::memory_order_relaxed);
            }
        }
        for (within &= to.asks_[leaf]; within != 0; within &= within - 1) {
            std::int32_t& count = to.count_[first + static_cast<std::size_t>(std::countr_zero(within))];
            std::atomic_ref(count).fetch_add(weight, std::memory_order_relaxed);
        }
    }

private:
    enum class Near : std::uint8_t { within, outside, open };

    /// The place of a point at one of the region's faces.
    [[nodiscard]] Near near_point(std::size_t at) const {
        if (region.cap == kNoTriangle || !is_at_cap(to.points_.triangle[to.index_[at]])) return Near::open;
        if (!region.on_light_s_side) return Near::outside;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t face = 1; face < static_cast<std::size_t>(region.count); ++face) {
            const HalfSpace& f = region.faces[face];
            least              = std::min(
                             least, (f.nx * to.tree_.at[0][at] + f.ny * to.tree_.at[1][at]) + (f.nz + f.nw * to.tree_.at[2][at]));
        }
        return least > 1 ? Near::within : least < -1 ? Near::outside : Near::open;
    }

    /// Whether points of triangle t are at the near cap: of their own triangle, and of copies of that. These lie in one
    /// plane, on the light's side of which such points are. kNoTriangle is none.
    [[nodiscard]] bool is_at_cap(TriangleId t) const {
        if (t == region.cap || t == kNoTriangle) return t == region.cap;
        const Scene& scene = to.scene_;
        for (int k = 0; k < 3; ++k) {
            const vec3 corner = scene.vertex(region.cap, k);
            if (corner != scene.vertex(t, 0) && corner != scene.vertex(t, 1) && corner != scene.vertex(t, 2))
                return false;
        }
        return true;
    }

    /// Whether all are so much larger than the region that its box alone rules out more than its faces do.
    [[nodiscard]] bool are_large(const Tree::Node& boxes, unsigned which) const {
        const dvec3 size    = 2.0 * (region.box_max - region.box_min);
        std::uint64_t large = 0;
#pragma GCC unroll 1
        for (std::size_t k = 0; k < kFanOut; ++k)
            large |= static_cast<std::uint64_t>((boxes.high[0][k] - boxes.low[0][k] > size.x) &
                                                (boxes.high[1][k] - boxes.low[1][k] > size.y))
                     << k;
        return (which & ~large) == 0;
    }

    /// Which nodes lie within no part of the half-space, and, four bits above these, which wholly. Certain answers
    /// only: a box with a point nearer to the plane than the rounding of f is neither.
    static unsigned cover(const HalfSpace& f, const Tree::Node& boxes) {
        const double nx = f.nx, ny = f.ny, nz = f.nz, nw = f.nw, size_z = std::abs(nz);
        // The corners of boxes at which f is least, and those at which it is most.
        const auto corners = [&](double n, int axis) {
            return n < 0 ? std::pair(boxes.high[axis], boxes.low[axis]) : std::pair(boxes.low[axis], boxes.high[axis]);
        };
        const auto [low_x, high_x] = corners(nx, 0);
        const auto [low_y, high_y] = corners(ny, 1);
        const auto [low_w, high_w] = corners(nw, 2);
        std::uint64_t bits         = 0;
#pragma GCC unroll 1
        for (std::size_t k = 0; k < kFanOut; ++k) {
            const double x0 = nx * low_x[k], x1 = nx * high_x[k], y0 = ny * low_y[k], y1 = ny * high_y[k],
                         w0 = nw * low_w[k], w1 = nw * high_w[k];
            const double low      = x0 + y0 + nz + w0;
            const double high     = x1 + y1 + nz + w1;
            const double rounding = 0x1p-49 * (std::abs(x0) + std::abs(x1) + std::abs(y0) + std::abs(y1) + size_z +
                                               std::abs(w0) + std::abs(w1));
            bits |= (std::uint64_t{high < -1 - rounding} | std::uint64_t{low > 1 + rounding} << kFanOut) << k;
        }
        return static_cast<unsigned>(bits);
    }
};

void PointCounts::add(const Region& region, std::int32_t weight) {
    if (empty()) return;
    OneRegion visitor{*this, region, weight};
    Tree::descend(visitor, levels_.size() - 1, 0, (1u << region.count) - 1);
}

}  // namespace umbra
