#include "umbra/shadows/volumes/seen_volumes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

uvec3 oriented(uvec3 t, int orientation) { return orientation > 0 ? t : uvec3(t[0], t[2], t[1]); }

/// A point that is no deeper than this may be projected anywhere.
double least_depth(const dvec3& v) { return 0x1p-20 * (std::abs(v.x) + std::abs(v.y)); }

struct SeenBox {
    dvec3 low, high;  // of (x, y, w)
};
/// Of a triangle, and a little larger. Nothing where it does not lie in front of the view.
std::optional<SeenBox> box_of(const std::array<dvec3, 3>& corners) {
    dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const dvec3& v : corners) {
        if (!(v.z > least_depth(v))) return std::nullopt;
        const dvec3 projected(v.x / v.z, v.y / v.z, 1 / v.z);
        low  = glm::min(low, projected);
        high = glm::max(high, projected);
    }
    const dvec3 rounding = 0x1p-40 * glm::max(glm::abs(low), glm::abs(high));
    return SeenBox{low - rounding, high + rounding};
}

}  // namespace

SeenVertices::SeenVertices(const SilhouetteMeshes& meshes, const ViewFrame& view) : at(meshes.vertices().size()) {
    parallel_ranges(at.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) at[v] = view.seen(dvec3(meshes.vertices()[v]));
    });
    double radius2 = 0;
    for (const dvec3& v : at) radius2 = std::max(radius2, glm::dot(v, v));
    radius = std::sqrt(radius2);
}

SeenVolumes::SeenVolumes(const SilhouetteMeshes& meshes, const SeenVertices& vertices, const Light& light,
                         const ViewFrame& view)
    : meshes_(meshes),
      at_infinity_(light.kind == LightKind::directional),
      travel_(at_infinity_ ? view.turned(dvec3(light.direction)) : -view.seen(dvec3(light.position))),
      vertices_(vertices.at),
      radius_(vertices.radius) {}

void SeenVolumes::add_near_cap(PointCounts& counts, TriangleId t, int orientation, bool depth_fail) const {
    const Cap cap = near_cap(t, orientation);
    Region region;
    region.add(HalfSpace::side(cap.behind, cap.behind_offset, cap.origin_behind == depth_fail ? +1 : -1));
    for (int k = 0; k < 3; ++k) {
        const Line e = edge(cap.corners[k], cap.corners[(k + 1) % 3]);
        region.add(HalfSpace::side(e.normal, 0, cap.origin_behind ? e.sense : -e.sense));
    }
    if (const auto box = box_of({vertices_[cap.corners[0]], vertices_[cap.corners[1]], vertices_[cap.corners[2]]})) {
        region.box_min = box->low, region.box_max = box->high;
        if (depth_fail)
            region.box_max.z = std::numeric_limits<double>::infinity();
        else
            region.box_min.z = -std::numeric_limits<double>::infinity();
    }
    counts.add(region, cap.origin_behind == depth_fail ? +1 : -1);
}

void SeenVolumes::add_far_cap(PointCounts& counts, TriangleId t, int orientation) const {
    const uvec3 corners = oriented(meshes_.triangles()[t], orientation);
    const std::array<dvec3, 3> ends{far(corners[0]), far(corners[1]), far(corners[2])};
    if (std::ranges::all_of(ends, [](const dvec3& v) { return v.z < -least_depth(v); })) return;  // behind the view
    Region region;
    for (int k = 0; k < 3; ++k) {
        const Line e = far_edge(corners[k], corners[(k + 1) % 3]);
        region.add(HalfSpace::side(e.normal, 0, -e.sense));
    }
    if (const auto box = box_of(ends)) {
        region.box_min = {box->low.x, box->low.y, region.box_min.z};
        region.box_max = {box->high.x, box->high.y, region.box_max.z};
    }
    counts.add(region, +1);
}

void SeenVolumes::add_side(PointCounts& counts, const ChangeEdge& e, bool depth_fail) const {
    const VolumePlane plane = side_plane(e.a, e.b);
    const int origin        = plane.origin_outside ? +1 : -1;
    Region region;
    region.add(HalfSpace::side(plane.normal, plane.offset, depth_fail ? origin : -origin));
    region.add(HalfSpace::side(edge(e.a, e.b).normal, 0, origin));
    region.add(HalfSpace::side(glm::cross(vertices_[e.b], travel_), 0, origin));
    region.add(HalfSpace::side(glm::cross(vertices_[e.a], travel_), 0, -origin));
    if (depth_fail && !at_infinity_) region.add(HalfSpace::side(far_edge(e.a, e.b).normal, 0, -origin));
    counts.add(region, depth_fail ? -origin * e.change : origin * e.change);
}

std::int32_t SeenVolumes::count_at_origin(std::span<const std::int8_t> orientation) const {
    std::atomic<std::int32_t> count{0};
    parallel_ranges(orientation.size(), 4096, [&](std::size_t begin, std::size_t end) {
        std::int32_t in_range = 0;
        for (std::size_t t = begin; t < end; ++t) {
            if (orientation[t] == 0) continue;
            const Cap cap = near_cap(static_cast<TriangleId>(t), orientation[t]);
            bool within   = cap.origin_behind;
            for (int k = 0; within && k < 3; ++k) {
                const std::uint32_t i = cap.corners[k], j = cap.corners[(k + 1) % 3];
                within = side_plane(std::min(i, j), std::max(i, j)).origin_outside == (i > j);
            }
            in_range += within;
        }
        count += in_range;
    });
    return count;
}

// A point in the plane of the triangle, its own or one that coincides with it, is not behind it. Points and vertices
// carry a few roundings u = 2^-53 relative to their distance from O, at most `radius`, the normal relative to the two
// sides that span it; the sum of both, over both points and the evaluation, is below 32 u.
SeenVolumes::Cap SeenVolumes::near_cap(TriangleId t, int orientation) const {
    Cap cap;
    cap.corners       = oriented(meshes_.triangles()[t], orientation);
    const dvec3 a     = vertices_[cap.corners[0]];
    const dvec3 p     = vertices_[cap.corners[1]] - a;
    const dvec3 q     = vertices_[cap.corners[2]] - a;
    cap.behind        = glm::cross(q, p);
    const double tiny = 32 * 0x1p-53 * radius_ * std::sqrt(glm::dot(p, p) * glm::dot(q, q));
    cap.behind_offset = -glm::dot(cap.behind, a) - tiny;
    cap.origin_behind = cap.behind_offset > 0;
    return cap;
}

SeenVolumes::VolumePlane SeenVolumes::side_plane(std::uint32_t a, std::uint32_t b) const {
    VolumePlane plane;
    plane.normal         = glm::cross(far(a), vertices_[b] - vertices_[a]);
    plane.offset         = -glm::dot(plane.normal, vertices_[a]);
    plane.origin_outside = plane.offset >= 0;
    return plane;
}

SeenVolumes::Line SeenVolumes::edge(std::uint32_t from, std::uint32_t to) const {
    return {glm::cross(vertices_[std::min(from, to)], vertices_[std::max(from, to)]), from < to ? +1 : -1};
}

SeenVolumes::Line SeenVolumes::far_edge(std::uint32_t from, std::uint32_t to) const {
    return {glm::cross(far(std::min(from, to)), far(std::max(from, to))), from < to ? +1 : -1};
}

}  // namespace umbra
