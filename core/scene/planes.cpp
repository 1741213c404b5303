// Coplanar triangles are found in three steps:
// 1. Every triangle's plane (unit normal, distance from the scene's centre) falls into a cell of a coarse grid. A plane
//    that matters fills some cell with a good part of its area; the cells that hold enough are where seeds come from.
// 2. A seed is one triangle. Its corners are rounded, so that its plane is known to their rounding at the corners and
//    to its extrapolation elsewhere. Triangles of the neighbouring cells that lie within that are candidates.
// 3. A plane is fitted to the candidates, and those stay whose corners all lie within their own rounding of it.
// Step 3 judges every triangle against one plane. Surfaces that curve slowly are therefore not chained into a plane,
// however small the angle between neighbours.
#include "umbra/core/scene/planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/parallel_sort.h"
#include "umbra/core/base/predicates.h"

namespace umbra {
namespace {

struct Plane {
    dvec3 normal{0};
    dvec3 origin{0};    ///< a point of it near its triangles
    double wobble = 0;  ///< the error of the fit: the mean rounding of the points that it was fitted to

    [[nodiscard]] double distance(dvec3 x) const { return glm::dot(normal, x - origin); }
};

/// How far rounding can have moved a vertex along the normal. A coordinate comes out of a 4x4 transform after four
/// roundings of 2^-24: relative to itself, or, where the transform mixes axes, to terms that may have cancelled. How
/// far it mixes them shows in the tilt of the plane: an axis-parallel plane's tolerance is that of its one coordinate,
/// so that a tile a hair's breadth above a floor stays a tile wherever it lies. Last, the double arithmetic here, of
/// which the same is true.
double rounding(dvec3 normal, dvec3 x) {
    const dvec3 n = glm::abs(normal), size = glm::abs(x);
    const double own = glm::dot(n, size), across = std::max({n.x, n.y, n.z});
    const double tilt = std::sqrt(std::max(0.0, glm::dot(n, n) - across * across));
    const bool tilted = n.x + n.y + n.z > across;
    return 4 * 0x1p-24 * (own + tilt * glm::length(size)) + 32 * 0x1p-53 * (tilted ? size.x + size.y + size.z : own);
}

std::array<dvec3, 3> corners(const Scene& scene, TriangleId t) {
    return {dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))};
}

bool lies_in(const Scene& scene, TriangleId t, const Plane& plane) {
    const auto x = corners(scene, t);
    return std::all_of(x.begin(), x.end(), [&](dvec3 p) {
        return std::abs(plane.distance(p)) <= plane.wobble + rounding(plane.normal, p);
    });
}

double area_of(const Scene& scene, std::span<const TriangleId> triangles) {
    double area = 0;
    for (const TriangleId t : triangles) area += 0.5 * glm::length(area_normal(scene, t));
    return area;
}

/// A seed's plane, and its largest error anywhere: the corners' rounding, extrapolated with the barycentric
/// coordinates of the position.
struct Seed {
    Plane plane;
    std::array<dvec3, 3> weight;   ///< dot(weight[k], x - origin) + (k == 0) is barycentric coordinate k
    std::array<double, 3> wobble;  ///< rounding of corner k

    Seed(const Scene& scene, TriangleId t) {
        const auto [a, b, c] = corners(scene, t);
        const dvec3 n        = glm::cross(b - a, c - a);
        const double square  = glm::dot(n, n);
        plane                = {n / std::sqrt(square), a, 0};
        weight[1]            = glm::cross(c - a, n) / square;
        weight[2]            = glm::cross(n, b - a) / square;
        weight[0]            = -weight[1] - weight[2];
        wobble               = {rounding(plane.normal, a), rounding(plane.normal, b), rounding(plane.normal, c)};
    }

    [[nodiscard]] bool may_hold(dvec3 x) const {
        const dvec3 r   = x - plane.origin;
        double accepted = rounding(plane.normal, x);
        for (std::size_t k = 0; k < 3; ++k)
            accepted += wobble[k] * std::abs(glm::dot(weight[k], r) + (k == 0 ? 1.0 : 0.0));
        return std::abs(glm::dot(plane.normal, r)) <= accepted;
    }
    [[nodiscard]] bool may_hold(const Scene& scene, TriangleId t) const {
        const auto x = corners(scene, t);
        return std::all_of(x.begin(), x.end(), [&](dvec3 p) { return may_hold(p); });
    }
};

/// Least squares over the corners, weighted by area: the height over `start` as a linear function in the plane.
Plane fit(const Scene& scene, std::span<const TriangleId> triangles, const Plane& start) {
    const dvec3 n       = start.normal;
    const auto [e1, e2] = axes_across(n);

    dvec3 mean{0};
    double total = 0;
    for (const TriangleId t : triangles) {
        const double w       = glm::length(area_normal(scene, t));
        const auto [a, b, c] = corners(scene, t);
        mean += w * ((a - start.origin) + (b - start.origin) + (c - start.origin)) / 3.0;
        total += w;
    }
    mean = start.origin + mean / total;

    double ss = 0, st = 0, tt = 0, sh = 0, th = 0, wobble = 0;
    for (const TriangleId id : triangles) {
        const double w = glm::length(area_normal(scene, id));
        for (const dvec3 x : corners(scene, id)) {
            const double s = glm::dot(e1, x - mean), t = glm::dot(e2, x - mean), h = glm::dot(n, x - mean);
            ss += w * s * s;
            st += w * s * t;
            tt += w * t * t;
            sh += w * s * h;
            th += w * t * h;
            wobble += w * rounding(n, x) / (3 * total);
        }
    }
    const double det = ss * tt - st * st;
    if (!(det > 0)) return start;
    const double slope1 = (sh * tt - th * st) / det, slope2 = (th * ss - sh * st) / det;
    return {glm::normalize(n - slope1 * e1 - slope2 * e2), mean, wobble};
}

/// The plane that the seed represents, fitted to `candidates` (the seed is one of them). Where the seed's own plane
/// holds them all, as in axis-parallel floors, it is taken as it is.
Plane settle(const Scene& scene, const Seed& seed, std::span<const TriangleId> candidates) {
    if (std::all_of(candidates.begin(), candidates.end(), [&](TriangleId t) { return lies_in(scene, t, seed.plane); }))
        return seed.plane;
    Plane plane = fit(scene, candidates, seed.plane);
    for (int round = 0; round < 3; ++round) {  // candidates that are off the plane have bent the first fit
        std::vector<TriangleId> kept;
        std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(kept),
                     [&](TriangleId t) { return lies_in(scene, t, plane); });
        if (kept.empty()) break;
        plane = fit(scene, kept, plane);
    }
    return plane;
}

/// Whether all corners lie in one plane. `triangles` are not empty.
bool is_exact(const Scene& scene, const Plane& plane, double tolerance, std::span<const TriangleId> triangles) {
    const vec3 first = scene.vertex(triangles[0], 0);
    for (int axis = 0; axis < 3; ++axis)
        if (std::ranges::all_of(triangles, [&](TriangleId t) {
                return scene.vertex(t, 0)[axis] == first[axis] && scene.vertex(t, 1)[axis] == first[axis] &&
                       scene.vertex(t, 2)[axis] == first[axis];
            }))
            return true;
    const TriangleId base =
        *std::ranges::max_element(triangles, {}, [&](TriangleId t) { return glm::length(area_normal(scene, t)); });
    const vec3 a = scene.vertex(base, 0), b = scene.vertex(base, 1), c = scene.vertex(base, 2);
    double reach = 0;
    for (const vec3 x : {a, b, c})
        reach = std::max(reach, glm::length(dvec3(x) - plane.origin) + glm::length(dvec3(x)));
    if (tolerance > 64 * 0x1p-53 * reach) return false;  // the rest would be as costly as it is clear
    return std::ranges::all_of(triangles, [&](TriangleId t) {
        for (int k = 0; k < 3; ++k)
            if (side_of_plane(a, b, c, scene.vertex(t, k)) != 0) return false;
        return true;
    });
}

PlanarReceiver receiver(const Scene& scene, const Plane& plane, std::vector<TriangleId> triangles) {
    PlanarReceiver r;
    dvec3 wound{0};
    for (const TriangleId t : triangles) {
        wound += area_normal(scene, t);
        for (const dvec3 x : corners(scene, t)) r.tolerance = std::max(r.tolerance, std::abs(plane.distance(x)));
    }
    r.normal    = glm::dot(wound, plane.normal) < 0 ? -plane.normal : plane.normal;
    r.normal    = r.normal + dvec3(0);  // no -0 for people to read
    r.offset    = glm::dot(r.normal, plane.origin) + 0.0;
    r.area      = area_of(scene, triangles);
    r.exact     = is_exact(scene, plane, r.tolerance, triangles);
    r.triangles = std::move(triangles);
    return r;
}

/// One triangle in the grid of planes. A cell packs the four rounded coordinates of a plane.
struct Cell {
    static constexpr int kPerUnit = 512;  // normals within 1/512, distances within 1/512 of half the diagonal

    static std::uint64_t key(std::array<int, 4> c) {
        std::uint64_t key = 0;
        for (const int x : c) key = key << 16 | static_cast<std::uint64_t>(x + 0x4000);
        return key;
    }
};
struct Entry {
    std::uint64_t key     = 0;
    double area           = 0;
    TriangleId triangle   = 0;
    std::array<int, 4> at = {};
};

std::array<int, 4> cell_of(dvec3 normal, double distance, double half_diagonal) {
    const auto round = [](double x) { return static_cast<int>(std::lround(Cell::kPerUnit * x)); };
    return {round(normal.x), round(normal.y), round(normal.z), round(distance / half_diagonal)};
}

/// All triangles with an area, sorted by cell, in a cell the largest first.
std::vector<Entry> grid_of_planes(const Scene& scene) {
    const Box box      = bounds(scene);
    const dvec3 centre = 0.5 * dvec3(box.min) + 0.5 * dvec3(box.max);
    const double half  = 0.5 * glm::length(dvec3(box.max) - dvec3(box.min));
    std::vector<Entry> entries(scene.triangles.size());
    parallel_ranges(entries.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto t        = static_cast<TriangleId>(i);
            const dvec3 n       = area_normal(scene, t);
            const double length = glm::length(n);
            entries[i].triangle = t;
            if (!(length > 0)) continue;
            entries[i].area = 0.5 * length;
            entries[i].at   = cell_of(n / length, glm::dot(n / length, dvec3(scene.vertex(t, 0)) - centre), half);
            entries[i].key  = Cell::key(entries[i].at);
        }
    });
    std::erase_if(entries, [](const Entry& e) { return e.area == 0; });
    parallel_sort(entries.begin(), entries.end(), [](const Entry& l, const Entry& r) {
        if (l.key != r.key) return l.key < r.key;
        if (l.area != r.area) return l.area > r.area;
        return l.triangle < r.triangle;
    });
    return entries;
}

/// A run of entries with one key, and the rest of its area.
struct Run {
    std::size_t begin = 0, end = 0;
    double area = 0;
};

class Search {
public:
    Search(const Scene& scene, double area_share) : scene_(scene), taken_(scene.triangles.size(), 0) {
        entries_     = grid_of_planes(scene);
        double total = 0;
        for (std::size_t i = 0; i < entries_.size(); ++i) {
            if (runs_.empty() || entries_[i].key != entries_[runs_.back().begin].key) runs_.push_back({i, i, 0});
            runs_.back().end = i + 1;
            runs_.back().area += entries_[i].area;
            total += entries_[i].area;
        }
        least_area_ = area_share * total;
    }

    std::vector<PlanarReceiver> run() {
        // One plane's triangles fall into at most 16 neighbouring cells, of either direction of the normal: one of
        // those 32 holds its part of the area.
        std::vector<std::size_t> promising;
        for (std::size_t r = 0; r < runs_.size(); ++r)
            if (runs_[r].area >= least_area_ / 32) promising.push_back(r);
        std::stable_sort(promising.begin(), promising.end(),
                         [&](std::size_t l, std::size_t r) { return runs_[l].area > runs_[r].area; });
        for (const std::size_t r : promising)
            while (take_plane(runs_[r])) {
            }

        std::stable_sort(planes_.begin(), planes_.end(),
                         [](const PlanarReceiver& l, const PlanarReceiver& r) { return l.area > r.area; });
        return std::move(planes_);
    }

private:
    /// Triangles not yet in a plane whose cell neighbours the run's.
    [[nodiscard]] std::vector<TriangleId> neighbourhood(const Run& run) const {
        std::vector<TriangleId> found;
        const auto at = entries_[run.begin].at;
        for (const int sign : {1, -1})
            for (int i = 0; i < 81; ++i) {
                const std::uint64_t key = Cell::key({sign * at[0] + i % 3 - 1, sign * at[1] + i / 3 % 3 - 1,
                                                     sign * at[2] + i / 9 % 3 - 1, sign * at[3] + i / 27 - 1});
                const auto run_of_key =
                    std::lower_bound(runs_.begin(), runs_.end(), key,
                                     [&](const Run& r, std::uint64_t k) { return entries_[r.begin].key < k; });
                if (run_of_key == runs_.end() || entries_[run_of_key->begin].key != key) continue;
                for (std::size_t e = run_of_key->begin; e < run_of_key->end; ++e)
                    if (!taken_[entries_[e].triangle]) found.push_back(entries_[e].triangle);
            }
        return found;
    }

    /// The run's largest triangles are tried as seeds, and some from all over the run, since one cell can hold many
    /// small triangles of a plane among others.
    bool take_plane(const Run& run) {
        const auto near = neighbourhood(run);
        if (area_of(scene_, near) < least_area_) return false;
        std::vector<TriangleId> seeds;
        for (std::size_t e = run.begin; e < run.end && seeds.size() < 8; ++e)
            if (!taken_[entries_[e].triangle]) seeds.push_back(entries_[e].triangle);
        const std::size_t step = std::max<std::size_t>(1, (run.end - run.begin) / 8);
        for (std::size_t e = run.begin + step / 2; e < run.end; e += step)
            if (!taken_[entries_[e].triangle]) seeds.push_back(entries_[e].triangle);

        for (const TriangleId t : seeds) {
            const Seed seed(scene_, t);
            std::vector<TriangleId> candidates;
            std::copy_if(near.begin(), near.end(), std::back_inserter(candidates),
                         [&](TriangleId c) { return seed.may_hold(scene_, c); });
            if (area_of(scene_, candidates) < least_area_) continue;
            const Plane plane = settle(scene_, seed, candidates);
            std::erase_if(candidates, [&](TriangleId c) { return !lies_in(scene_, c, plane); });
            if (area_of(scene_, candidates) < least_area_) continue;
            accept(plane);
            return true;
        }
        return false;
    }

    /// Now every triangle of the scene is asked: slivers whose own normal means little lie in the plane as well.
    void accept(const Plane& plane) {
        std::vector<std::uint8_t> member(taken_.size(), 0);
        parallel_ranges(member.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t)
                member[t] = !taken_[t] && lies_in(scene_, static_cast<TriangleId>(t), plane);
        });
        std::vector<TriangleId> triangles;
        for (std::size_t t = 0; t < member.size(); ++t)
            if (member[t]) {
                triangles.push_back(static_cast<TriangleId>(t));
                taken_[t] = 1;
            }
        planes_.push_back(receiver(scene_, plane, std::move(triangles)));
    }

    const Scene& scene_;
    std::vector<Entry> entries_;
    std::vector<Run> runs_;  ///< sorted by key
    std::vector<std::uint8_t> taken_;
    double least_area_ = 0;
    std::vector<PlanarReceiver> planes_;
};

}  // namespace

std::vector<PlanarReceiver> find_planes(const Scene& scene, double area_share) {
    if (scene.triangles.empty()) return {};
    return Search(scene, area_share).run();
}

std::optional<PlanarReceiver> common_plane(const Scene& scene, TriangleId first, std::uint32_t count) {
    std::vector<TriangleId> triangles(count);
    double largest     = 0;
    TriangleId seed_at = first;
    for (std::uint32_t i = 0; i < count; ++i) {
        triangles[i]      = first + i;
        const double area = glm::length(area_normal(scene, first + i));
        if (area > largest) {
            largest = area;
            seed_at = first + i;
        }
    }
    if (largest == 0) return std::nullopt;
    const Seed seed(scene, seed_at);
    if (!std::all_of(triangles.begin(), triangles.end(), [&](TriangleId t) { return seed.may_hold(scene, t); }))
        return std::nullopt;
    const Plane plane = settle(scene, seed, triangles);
    if (!std::all_of(triangles.begin(), triangles.end(), [&](TriangleId t) { return lies_in(scene, t, plane); }))
        return std::nullopt;
    return receiver(scene, plane, std::move(triangles));
}

}  // namespace umbra
