#include "umbra/shadows/volumes/counting_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel_sort.h"
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
    using Floats  = float __attribute__((vector_size(8 * sizeof(float))));
    using Doubles = double __attribute__((vector_size(8 * sizeof(double))));

    Floats low[3], high[3];
    Doubles nearest = Doubles{} + std::numeric_limits<double>::infinity();

    EightExtents() {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis]  = Floats{} + std::numeric_limits<float>::infinity();
            high[axis] = -low[axis];
        }
    }

    /// Points i to i + 7.
    void add(const PointBatch& points, std::size_t i, const dvec3& eye, const dvec3& forward) {
        Floats nowhere;  // 0 where there is a point, else infinite
        for (int k = 0; k < 8; ++k)
            nowhere[k] = points.triangle[i + static_cast<std::size_t>(k)] != kNoTriangle
                             ? 0
                             : std::numeric_limits<float>::infinity();
        Doubles ahead = __builtin_convertvector(nowhere, Doubles);
        for (int axis = 0; axis < 3; ++axis) {
            Floats at;
            std::memcpy(&at, &(axis == 0 ? points.px : axis == 1 ? points.py : points.pz)[i], sizeof at);
            const Floats above = at + nowhere, below = at - nowhere;
            low[axis]  = above < low[axis] ? above : low[axis];
            high[axis] = below > high[axis] ? below : high[axis];
            ahead += (__builtin_convertvector(at, Doubles) - eye[axis]) * forward[axis];
        }
        nearest = ahead < nearest ? ahead : nearest;
    }
};

/// The eye's view where all points lie well in front of it, but from a little beside the eye: so that a plane or an
/// edge that contains the eye, as in scenes laid out on a grid, or a light at the eye, is no special case. A far eye
/// comes nearer on its line of sight, where double resolves more. Points without a raster may lie all around the eye:
/// they are looked at from outside their box.
ViewFrame choose_view(const PointBatch& points) {
    const bool perspective = points.raster && points.raster->projection == Projection::perspective;
    struct Extent {
        Box box;
        double nearest = std::numeric_limits<double>::infinity();  // to the eye, along the line of sight
    };
    constexpr std::size_t run = 16384;
    std::vector<Extent> extents((points.size() + run - 1) / run);
    const dvec3 eye     = perspective ? points.raster->eye : dvec3(0);
    const dvec3 forward = perspective ? points.raster->forward : dvec3(0);
    parallel_ranges(extents.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r) {
            EightExtents eight;
            const std::size_t end = std::min(points.size(), (r + 1) * run);
            std::size_t i         = r * run;
            for (; i + 8 <= end; i += 8) eight.add(points, i, eye, forward);
            for (int k = 0; k < 8; ++k) {
                extents[r].box.min =
                    glm::min(extents[r].box.min, vec3(eight.low[0][k], eight.low[1][k], eight.low[2][k]));
                extents[r].box.max =
                    glm::max(extents[r].box.max, vec3(eight.high[0][k], eight.high[1][k], eight.high[2][k]));
                extents[r].nearest = std::min(extents[r].nearest, eight.nearest[k]);
            }
            for (; i < end; ++i) {
                if (points.triangle[i] == kNoTriangle) continue;
                extents[r].box     = extend(extents[r].box, points.position(i));
                extents[r].nearest = std::min(extents[r].nearest, glm::dot(dvec3(points.position(i)) - eye, forward));
            }
        }
    });
    Box box;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Extent& e : extents) box = extend(box, e.box), nearest = std::min(nearest, e.nearest);
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

// ---- the order of points --------------------------------------------------------------------------------------------

/// Sorts points without a raster along Morton's curve over their projections.
void sort_by_projection(std::span<std::uint32_t> index, const PointBatch& points, const ViewFrame& view) {
    const auto projected = [&](std::uint32_t i) {
        const dvec3 p = view.seen(dvec3(points.position(i)));
        return dvec2(p.x, p.y) / p.z;
    };
    dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t i : index) low = glm::min(low, projected(i)), high = glm::max(high, projected(i));
    const dvec2 scale = 65535.0 / glm::max(high - low, dvec2(std::numeric_limits<double>::min()));
    std::vector<std::pair<std::uint32_t, std::uint32_t>> keys(index.size());
    parallel_ranges(index.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const dvec2 cell = glm::clamp((projected(index[k]) - low) * scale, dvec2(0), dvec2(65535));
            keys[k]          = {static_cast<std::uint32_t>(
                           morton_code(static_cast<std::uint32_t>(cell.x), static_cast<std::uint32_t>(cell.y))),
                                index[k]};
        }
    });
    parallel_sort(keys.begin(), keys.end());
    for (std::size_t k = 0; k < index.size(); ++k) index[k] = keys[k].second;
}

/// Of a triangle's weights: a point with larger ones is not moved (named_point).
constexpr double kMostShare = 0x1p-26;

}  // namespace

dvec3 named_point(const Scene& scene, const PointBatch& points, std::size_t i, dvec3 origin) {
    const TriangleId t     = points.triangle[i];
    const dvec3 corners[3] = {dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))};
    double weight[3]       = {0, points.u[i], points.v[i]};
    weight[0]              = 1 - weight[1] - weight[2];
    // Most points are far inside: a weight times a height is a distance.
    constexpr double kClear = 0x1p-44;
    if (std::min({weight[0], weight[1], weight[2]}) < kMostShare) {
        const double area = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
        double far        = 0;
        for (const dvec3 c : corners) far = std::max(far, glm::length(c - origin));
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            const double opposite = glm::length(corners[l] - corners[m]);
            const double share    = std::min(kMostShare, kClear * far * opposite / area);
            if (weight[k] >= share) continue;
            // Towards the corner, from the nearer of the others that has the weight to give.
            const bool l_is_nearer = glm::length(corners[l] - corners[k]) < glm::length(corners[m] - corners[k]);
            const int near = l_is_nearer ? l : m, other = l_is_nearer ? m : l;
            weight[weight[near] > 0.25 ? near : other] -= share - weight[k];
            weight[k] = share;
        }
    }
    return (corners[0] - origin) + weight[1] * (corners[1] - corners[0]) + weight[2] * (corners[2] - corners[0]);
}

// ---- the tree -------------------------------------------------------------------------------------------------------

CountingTree::CountingTree(const Scene& scene, const PointBatch& points)
    // Blocks of 4 x 4 pixels are a leaf, where all of them see a surface.
    : index_(std::move(
          grouped(points, 1, [&](std::size_t i) { return points.triangle[i] != kNoTriangle ? 0u : 1u; })[0])) {
    if (index_.empty()) return;
    view_ = choose_view(points);
    if (!points.raster) sort_by_projection(index_, points, view_);
    project(scene, points);
    build_nodes();
}

/// The points of the leaves, and their boxes. Boxes of leaves that are empty hold nothing.
void CountingTree::project(const Scene& scene, const PointBatch& points) {
    for (RawVector<double>* v : {&x_, &y_, &w_}) v->resize(leaf_count() * kLeaf);
    Level& boxes      = levels_.emplace_back(leaf_count() / kFanOut);
    const dvec3 right = view_.right, down = view_.down, forward = view_.forward;
    parallel_ranges(leaf_count(), 256, [&](std::size_t begin, std::size_t end) {
        TriangleId last = kNoTriangle;  // neighbours are mostly on one triangle
        dvec3 a{0}, b{0}, c{0};
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            const std::size_t from = std::min(leaf * kLeaf, size()), count = std::min(kLeaf, size() - from);
            const std::uint32_t* const index = index_.data() + from;
            // What follows in memory is of other points: of blocks of 4 x 4 pixels, the first of each row.
            if (from + 5 * kLeaf < size())
                for (const std::size_t ahead : {64, 66, 72, 74}) {
                    __builtin_prefetch(&points.triangle[index[ahead]]);
                    __builtin_prefetch(&points.u[index[ahead]]);
                    __builtin_prefetch(&points.v[index[ahead]]);
                }
            double u[kLeaf], v[kLeaf];
            bool together      = count == kLeaf;
            unsigned at_border = 0;  // a bit for each point that named_point moves
            for (std::size_t k = 0; k < count; ++k) {
                u[k] = points.u[index[k]], v[k] = points.v[index[k]];
                together &= points.triangle[index[k]] == points.triangle[index[0]];
                at_border |= static_cast<unsigned>(std::min({1 - u[k] - v[k], u[k], v[k]}) < kMostShare) << k;
            }
            double* __restrict const x = &x_[leaf * kLeaf];
            double* __restrict const y = &y_[leaf * kLeaf];
            double* __restrict const w = &w_[leaf * kLeaf];
            for (std::size_t first = 0; first < count; first += together ? kLeaf : 1) {
                if (const TriangleId t = points.triangle[index[first]]; t != last) {
                    last = t;
                    a    = dvec3(scene.vertex(t, 0));
                    b = dvec3(scene.vertex(t, 1)) - a, c = dvec3(scene.vertex(t, 2)) - a, a -= view_.origin;
                }
                for (std::size_t k = first; k < (together ? kLeaf : first + 1); ++k) {
                    const double px = a.x + u[k] * b.x + v[k] * c.x, py = a.y + u[k] * b.y + v[k] * c.y,
                                 pz    = a.z + u[k] * b.z + v[k] * c.z;
                    const double depth = forward.x * px + forward.y * py + forward.z * pz;
                    x[k]               = (right.x * px + right.y * py + right.z * pz) / depth;
                    y[k]               = (down.x * px + down.y * py + down.z * pz) / depth;
                    w[k]               = 1 / depth;
                }
            }
            for (; at_border != 0; at_border &= at_border - 1) {
                const auto k  = static_cast<std::size_t>(std::countr_zero(at_border));
                const dvec3 p = view_.turned(named_point(scene, points, index[k], view_.origin));
                x[k] = p.x / p.z, y[k] = p.y / p.z, w[k] = 1 / p.z;
            }
            dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
            for (std::size_t k = 0; k < count; ++k)
                low = glm::min(low, dvec3(x[k], y[k], w[k])), high = glm::max(high, dvec3(x[k], y[k], w[k]));
            Siblings& nodes = boxes[leaf / kFanOut];
            for (int axis = 0; axis < 3; ++axis)
                nodes.min[axis][leaf % kFanOut] = low[axis], nodes.max[axis][leaf % kFanOut] = high[axis];
            for (std::size_t k = count; k < kLeaf; ++k) x[k] = y[k] = w[k] = 0;
        }
    });
}

/// The levels over the leaves.
void CountingTree::build_nodes() {
    while (levels_.back().size() > 1) {
        const Level& below = levels_.back();
        Level level((below.size() + kFanOut - 1) / kFanOut);
        parallel_ranges(level.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t node = begin * kFanOut; node < end * kFanOut; ++node)
                for (int axis = 0; axis < 3; ++axis) {
                    double low = std::numeric_limits<double>::infinity(), high = -low;
                    for (std::size_t k = 0; node < below.size() && k < kFanOut; ++k)
                        low = std::min(low, below[node].min[axis][k]), high = std::max(high, below[node].max[axis][k]);
                    level[node / kFanOut].min[axis][node % kFanOut] = low;
                    level[node / kFanOut].max[axis][node % kFanOut] = high;
                }
        });
        levels_.push_back(std::move(level));
    }
}

std::size_t CountingTree::memory_bytes() const {
    std::size_t bytes = index_.size() * sizeof(std::uint32_t) + 3 * x_.size() * sizeof(double);
    for (const Level& level : levels_) bytes += level.size() * sizeof(Siblings);
    return bytes;
}

// ---- the counts -----------------------------------------------------------------------------------------------------

PointCounts::PointCounts(const CountingTree& tree, const PointBatch& points, LightId light)
    : tree_(tree), asks_(tree.leaf_count()), count_(tree.leaf_count() * kLeaf), levels_(tree.levels_.size()) {
    const Facing* const facing = points.facing[light].data();
    parallel_ranges(asks_.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            unsigned asks = 0;
            for (std::size_t k = leaf * kLeaf; k < std::min(tree.size(), (leaf + 1) * kLeaf); ++k)
                asks |= static_cast<unsigned>(facing[tree.index_[k]] >= Facing::partly) << k % kLeaf;
            asks_[leaf] = static_cast<std::uint16_t>(asks);
            if (asks != 0) std::fill_n(&count_[leaf * kLeaf], kLeaf, 0);
        }
    });
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        levels_[l].count.resize(tree.levels_[l].size());
        levels_[l].asks.resize(tree.levels_[l].size(), 0);
        const std::size_t nodes = l == 0 ? asks_.size() : levels_[l - 1].asks.size();
        for (std::size_t node = 0; node < nodes; ++node)
            if (l == 0 ? asks_[node] != 0 : levels_[l - 1].asks[node] != 0)
                levels_[l].asks[node / kFanOut] |= static_cast<std::uint8_t>(1u << node % kFanOut);
    }
}

void PointCounts::add(const Region& region, std::int32_t weight) {
    if (!empty()) descend(region, weight, levels_.size() - 1, 0, (1u << region.count) - 1);
}

/// Those that do not lie beside the region's box: one bit each.
unsigned PointCounts::within(const Siblings& nodes, const Region& region) {
    std::uint64_t bits = 0;
#pragma GCC unroll 1
    for (std::size_t k = 0; k < kFanOut; ++k)
        bits |=
            static_cast<std::uint64_t>((nodes.max[0][k] >= region.box_min.x) & (nodes.min[0][k] <= region.box_max.x) &
                                       (nodes.max[1][k] >= region.box_min.y) & (nodes.min[1][k] <= region.box_max.y) &
                                       (nodes.max[2][k] >= region.box_min.z) & (nodes.min[2][k] <= region.box_max.z))
            << k;
    return static_cast<unsigned>(bits);
}

/// Whether all are so much larger than the region that its box alone rules out more than its faces do.
bool PointCounts::are_large(const Siblings& nodes, const Region& region, unsigned which) {
    const dvec3 size    = 2.0 * (region.box_max - region.box_min);
    std::uint64_t large = 0;
#pragma GCC unroll 1
    for (std::size_t k = 0; k < kFanOut; ++k)
        large |= static_cast<std::uint64_t>((nodes.max[0][k] - nodes.min[0][k] > size.x) &
                                            (nodes.max[1][k] - nodes.min[1][k] > size.y))
                 << k;
    return (which & ~large) == 0;
}

/// Which nodes lie within no part of the half-space, and, four bits above these, which wholly. Certain answers only:
/// what lies nearer to the plane than the rounding of f, at any point of the box, is neither, so that a point gets the
/// same answer whether a box or the point itself is asked.
unsigned PointCounts::cover(const HalfSpace& f, const Siblings& nodes) {
    // The corners of boxes at which f is least, and those at which it is most.
    const auto corners = [&](double n, int axis) {
        return n < 0 ? std::pair(nodes.max[axis], nodes.min[axis]) : std::pair(nodes.min[axis], nodes.max[axis]);
    };
    const auto [low_x, high_x] = corners(f.nx, 0);
    const auto [low_y, high_y] = corners(f.ny, 1);
    const auto [low_w, high_w] = corners(f.nw, 2);
    return cover(f, low_x, high_x, low_y, high_y, low_w, high_w);
}

unsigned PointCounts::cover(const HalfSpace& f, const double* __restrict low_x, const double* __restrict high_x,
                            const double* __restrict low_y, const double* __restrict high_y,
                            const double* __restrict low_w, const double* __restrict high_w) {
    const double nx = f.nx, ny = f.ny, nz = f.nz, nw = f.nw, size_z = std::abs(nz);
    std::uint64_t bits = 0;
#pragma GCC unroll 1
    for (std::size_t k = 0; k < kFanOut; ++k) {
        const double x0 = nx * low_x[k], x1 = nx * high_x[k], y0 = ny * low_y[k], y1 = ny * high_y[k],
                     w0 = nw * low_w[k], w1 = nw * high_w[k];
        const double low      = x0 + y0 + nz + w0;
        const double high     = x1 + y1 + nz + w1;
        const double rounding = 0x1p-49 * (std::abs(x0) + std::abs(x1) + std::abs(y0) + std::abs(y1) + size_z +
                                           std::abs(w0) + std::abs(w1));
        bits |= (std::uint64_t{high < -rounding} | std::uint64_t{low > rounding} << kFanOut) << k;
    }
    return static_cast<unsigned>(bits);
}

/// The four nodes below `parent`. `open` has a bit for each face that does not yet hold all of them.
void PointCounts::descend(const Region& region, std::int32_t weight, std::size_t level, std::size_t parent,
                          unsigned open) {
    const Siblings& nodes = tree_.levels_[level][parent];
    unsigned which        = within(nodes, region) & levels_[level].asks[parent];
    if (which == 0) return;
    std::array<unsigned, kFanOut> still{open, open, open, open};  // of each node
    for (unsigned rest = level > 0 && are_large(nodes, region, which) ? 0 : open; rest != 0; rest &= rest - 1) {
        const auto face        = static_cast<unsigned>(std::countr_zero(rest));
        const unsigned covered = cover(region.faces[face], nodes);
        which &= ~covered;
        if (which == 0) return;
        for (std::size_t k = 0; k < kFanOut; ++k) still[k] &= ~((covered >> (kFanOut + k) & 1u) << face);
    }
    for (; which != 0; which &= which - 1) {
        const auto k           = static_cast<std::size_t>(std::countr_zero(which));
        const std::size_t node = parent * kFanOut + k;
        if (still[k] == 0)
            std::atomic_ref(levels_[level].count[parent][k]).fetch_add(weight, std::memory_order_relaxed);
        else if (level == 0)
            add_to_leaf(region, weight, node, still[k]);
        else
            descend(region, weight, level - 1, node, still[k]);
    }
}

void PointCounts::add_to_leaf(const Region& region, std::int32_t weight, std::size_t leaf, unsigned open) {
    const double* x = &tree_.x_[leaf * kLeaf];
    const double* y = &tree_.y_[leaf * kLeaf];
    const double* w = &tree_.w_[leaf * kLeaf];
    alignas(64) std::array<double, kLeaf> least;
    least.fill(std::numeric_limits<double>::infinity());
    for (; open != 0; open &= open - 1) {
        const HalfSpace f = region.faces[static_cast<std::size_t>(std::countr_zero(open))];
#pragma GCC unroll 1
        for (std::size_t k = 0; k < kLeaf; ++k) {
            const double value = (f.nx * x[k] + f.ny * y[k]) + (f.nz + f.nw * w[k]) + f.tie;
            least[k]           = value < least[k] ? value : least[k];
        }
    }
    unsigned within = 0;
#pragma GCC unroll 1
    for (std::size_t k = 0; k < kLeaf; ++k) within |= static_cast<unsigned>(least[k] > 0) << k;
    for (within &= asks_[leaf]; within != 0; within &= within - 1) {
        std::int32_t& count = count_[leaf * kLeaf + static_cast<std::size_t>(std::countr_zero(within))];
        std::atomic_ref(count).fetch_add(weight, std::memory_order_relaxed);
    }
}

/// To the leaves.
void PointCounts::push_down() {
    for (std::size_t level = levels_.size(); level-- > 1;)
        parallel_ranges(levels_[level].count.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t parent = begin; parent < end; ++parent)
                for (unsigned asks = levels_[level].asks[parent]; asks != 0; asks &= asks - 1) {
                    const auto k = static_cast<std::size_t>(std::countr_zero(asks));
                    for (std::int32_t& below : levels_[level - 1].count[parent * kFanOut + k])
                        below += levels_[level].count[parent][k];
                }
        });
}

}  // namespace umbra
