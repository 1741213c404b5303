#include "umbra/shadows/volumes/counting_tree.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

#include "umbra/core/base/morton.h"
#include "umbra/core/base/parallel_sort.h"
#include "umbra/shadows/shared/point_groups.h"

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

/// Limits of the coordinates of points that ask, and of their distances along a line of sight, in eight lanes.
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
    void add(const PointBatch& points, LightId light, std::size_t i, const dvec3& eye, const dvec3& forward) {
        Floats nowhere;  // 0 where a point asks, else infinite
        for (int k = 0; k < 8; ++k)
            nowhere[k] =
                points.asks(light, i + static_cast<std::size_t>(k)) ? 0 : std::numeric_limits<float>::infinity();
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
ViewFrame choose_view(const PointBatch& points, LightId light) {
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
            for (; i + 8 <= end; i += 8) eight.add(points, light, i, eye, forward);
            for (int k = 0; k < 8; ++k) {
                extents[r].box.min =
                    glm::min(extents[r].box.min, vec3(eight.low[0][k], eight.low[1][k], eight.low[2][k]));
                extents[r].box.max =
                    glm::max(extents[r].box.max, vec3(eight.high[0][k], eight.high[1][k], eight.high[2][k]));
                extents[r].nearest = std::min(extents[r].nearest, eight.nearest[k]);
            }
            for (; i < end; ++i) {
                if (!points.asks(light, i)) continue;
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

CountingTree::CountingTree(const Scene& scene, const PointBatch& points, LightId light)
    // Blocks of 4 x 4 pixels are a leaf, where all of them ask.
    : index_(std::move(grouped(points, 1, [&](std::size_t i) { return points.asks(light, i) ? 0u : 1u; })[0])) {
    if (index_.empty()) return;
    view_ = choose_view(points, light);
    if (!points.raster) sort_by_projection(index_, points, view_);
    project(scene, points);
    build_nodes();
}

void CountingTree::project(const Scene& scene, const PointBatch& points) {
    const std::size_t padded = (size() + kLeaf - 1) / kLeaf * kLeaf;
    for (RawVector<double>* v : {&x_, &y_, &w_}) {
        v->resize(padded);
        std::fill(v->begin() + static_cast<std::ptrdiff_t>(size()), v->end(), 0.0);
    }
    count_.resize(padded, 0);
    parallel_ranges(size(), 4096, [&](std::size_t begin, std::size_t end) {
        TriangleId last = kNoTriangle;  // neighbours are mostly on one triangle
        dvec3 a{0}, b{0}, c{0};
        for (std::size_t k = begin; k < end; ++k) {
            // What follows in memory is of other points: of blocks of 4 x 4 pixels, the first of each row.
            if (k % 16 == 0 && k + 5 * 16 < size())
                for (const std::size_t ahead : {k + 64, k + 66, k + 72, k + 74}) {
                    __builtin_prefetch(&points.triangle[index_[ahead]]);
                    __builtin_prefetch(&points.u[index_[ahead]]);
                    __builtin_prefetch(&points.v[index_[ahead]]);
                }
            const std::uint32_t i = index_[k];
            if (points.triangle[i] != last) {
                last = points.triangle[i];
                a    = dvec3(scene.vertex(last, 0));
                b = dvec3(scene.vertex(last, 1)) - a, c = dvec3(scene.vertex(last, 2)) - a, a -= view_.origin;
            }
            const double u = points.u[i], v = points.v[i];
            const dvec3 p =
                view_.turned(std::min({1 - u - v, u, v}) < kMostShare ? named_point(scene, points, i, view_.origin)
                                                                      : a + u * b + v * c);
            x_[k] = p.x / p.z, y_[k] = p.y / p.z, w_[k] = 1 / p.z;
        }
    });
}

void CountingTree::build_nodes() {
    constexpr double far = std::numeric_limits<double>::infinity();
    std::size_t size     = (this->size() + kLeaf - 1) / kLeaf;  // nodes of the level
    const auto add_level = [&](const auto& box_of) {
        Level level((size + kFanOut - 1) / kFanOut);
        parallel_ranges(level.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t parent = begin; parent < end; ++parent) {
                Siblings& nodes = level[parent];
                nodes.size      = static_cast<std::uint32_t>(std::min(kFanOut, size - parent * kFanOut));
                for (std::size_t k = 0; k < kFanOut; ++k) {
                    dvec3 min(far), max(-far);
                    if (k < nodes.size) box_of(parent * kFanOut + k, min, max);
                    for (int axis = 0; axis < 3; ++axis) nodes.min[axis][k] = min[axis], nodes.max[axis][k] = max[axis];
                    nodes.count[k] = 0;
                }
            }
        });
        levels_.push_back(std::move(level));
    };
    add_level([&](std::size_t leaf, dvec3& min, dvec3& max) {
        for (std::size_t k = leaf * kLeaf; k < std::min(this->size(), (leaf + 1) * kLeaf); ++k) {
            const dvec3 at(x_[k], y_[k], w_[k]);
            min = glm::min(min, at), max = glm::max(max, at);
        }
    });
    while (levels_.back().size() > 1) {
        size = levels_.back().size();
        add_level([&](std::size_t node, dvec3& min, dvec3& max) {
            const Siblings& children = levels_.back()[node];
            for (int axis = 0; axis < 3; ++axis)
                for (std::size_t k = 0; k < children.size; ++k)
                    min[axis] = std::min(min[axis], children.min[axis][k]),
                    max[axis] = std::max(max[axis], children.max[axis][k]);
        });
    }
}

void CountingTree::add(const Region& region, std::int32_t weight) {
    if (!levels_.empty()) descend(region, weight, levels_.size() - 1, 0, (1u << region.count) - 1);
}

/// Those that do not lie beside the region's box: one bit each.
unsigned CountingTree::within(const Siblings& nodes, const Region& region) {
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
bool CountingTree::are_large(const Siblings& nodes, const Region& region, unsigned which) {
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
unsigned CountingTree::cover(const HalfSpace& f, const Siblings& nodes) {
    // The corners of boxes at which f is least, and those at which it is most.
    const auto corners = [&](double n, int axis) {
        return n < 0 ? std::pair(nodes.max[axis], nodes.min[axis]) : std::pair(nodes.min[axis], nodes.max[axis]);
    };
    const auto [low_x, high_x] = corners(f.nx, 0);
    const auto [low_y, high_y] = corners(f.ny, 1);
    const auto [low_w, high_w] = corners(f.nw, 2);
    return cover(f, low_x, high_x, low_y, high_y, low_w, high_w);
}

unsigned CountingTree::cover(const HalfSpace& f, const double* __restrict low_x, const double* __restrict high_x,
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
void CountingTree::descend(const Region& region, std::int32_t weight, std::size_t level, std::size_t parent,
                           unsigned open) {
    Siblings& nodes = levels_[level][parent];
    unsigned which  = within(nodes, region) & ((1u << nodes.size) - 1);
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
            std::atomic_ref(nodes.count[k]).fetch_add(weight, std::memory_order_relaxed);
        else if (level == 0)
            add_to_leaf(region, weight, node, still[k]);
        else
            descend(region, weight, level - 1, node, still[k]);
    }
}

void CountingTree::add_to_leaf(const Region& region, std::int32_t weight, std::size_t leaf, unsigned open) {
    const double* x = &x_[leaf * kLeaf];
    const double* y = &y_[leaf * kLeaf];
    const double* w = &w_[leaf * kLeaf];
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
    for (; within != 0; within &= within - 1) {
        std::int32_t& count = count_[leaf * kLeaf + static_cast<std::size_t>(std::countr_zero(within))];
        std::atomic_ref(count).fetch_add(weight, std::memory_order_relaxed);
    }
}

/// To the leaves.
void CountingTree::push_down() {
    for (std::size_t level = levels_.size(); level-- > 1;)
        parallel_ranges(levels_[level].size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t parent = begin; parent < end; ++parent)
                for (std::size_t k = 0; k < levels_[level][parent].size; ++k) {
                    const std::int32_t count = levels_[level][parent].count[k];
                    for (std::int32_t& below : levels_[level - 1][parent * kFanOut + k].count) below += count;
                }
        });
}

}  // namespace umbra
