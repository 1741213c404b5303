#include "umbra/shadows/volumes/seen_volumes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "umbra/core/base/parallel.h"

namespace umbra {

using exact_visibility::operator-;
using exact_visibility::rational;
using exact_visibility::Rational3;

namespace {

uvec3 oriented(uvec3 t, int orientation) { return orientation > 0 ? t : uvec3(t[0], t[2], t[1]); }

/// Points that are not deeper than this may be projected anywhere.
double least_depth(const dvec3& v) { return 0x1p-20 * (std::abs(v.x) + std::abs(v.y)); }

struct SeenBox {
    dvec3 low, high;  // of (x, y, w)
};
/// Around a triangle, wider than rounding of it and of points, which is `slack` for these. Nothing where it does not
/// lie in front of the view.
std::optional<SeenBox> box_of(const std::array<dvec3, 3>& corners, double slack) {
    dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const dvec3& v : corners) {
        if (!(v.z > least_depth(v))) return std::nullopt;
        const dvec3 projected(v.x / v.z, v.y / v.z, 1 / v.z);
        low  = glm::min(low, projected);
        high = glm::max(high, projected);
    }
    const dvec3 far      = glm::max(glm::abs(low), glm::abs(high));
    const double share   = 0x1p-40 * (1 + far.x + far.y) + slack;
    const dvec3 rounding = share * dvec3(1, 1, far.z);
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
                         const CountingTree& tree)
    : meshes_(meshes),
      light_(light),
      origin_(tree.view().origin),
      at_infinity_(light.kind == LightKind::directional),
      travel_(at_infinity_ ? tree.view().turned(dvec3(light.direction)) : -tree.view().seen(dvec3(light.position))),
      vertices_(vertices.at),
      largest_w_(tree.largest_w()),
      // Points and vertices carry a few roundings u = 2^-53 relative to their distances from O, and points to those of
      // their triangles' corners, at most `radius`; a normal relative to the lengths of its factors. All that together,
      // over a point's least depth 1/w, is below 100 u.
      slack_(0x1p-45 * vertices.radius * largest_w_) {}

void SeenVolumes::add_near_cap(PointCounts& counts, TriangleId t, int orientation, bool depth_fail) const {
    const Cap cap = near_cap(t, orientation);
    Region region;
    region.cap             = t;
    region.on_light_s_side = cap.origin_behind != depth_fail;
    region.add(HalfSpace::side(cap.behind, cap.behind_offset, region.on_light_s_side ? -1 : +1, cap.doubt));
    for (int k = 0; k < 3; ++k) {
        const Line e = edge(cap.corners[k], cap.corners[(k + 1) % 3]);
        region.add(e.side(cap.origin_behind ? e.sense : -e.sense));
    }
    if (const auto box =
            box_of({vertices_[cap.corners[0]], vertices_[cap.corners[1]], vertices_[cap.corners[2]]}, slack_)) {
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
        region.add(e.side(-e.sense));
    }
    if (const auto box = box_of(ends, slack_)) {
        region.box_min = {box->low.x, box->low.y, region.box_min.z};
        region.box_max = {box->high.x, box->high.y, region.box_max.z};
    }
    counts.add(region, +1);
}

void SeenVolumes::add_side(PointCounts& counts, const ChangeEdge& e, bool depth_fail) const {
    const VolumePlane plane = side_plane(e.a, e.b);
    const int origin        = plane.origin_outside ? +1 : -1;
    Region region;
    region.add(HalfSpace::side(plane.normal, plane.offset, depth_fail ? origin : -origin, plane.doubt));
    region.add(edge(e.a, e.b).side(origin));
    region.add(end_line(e.b).side(origin));
    region.add(end_line(e.a).side(-origin));
    if (depth_fail && !at_infinity_) region.add(far_edge(e.a, e.b).side(-origin));
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

SeenVolumes::Cap SeenVolumes::near_cap(TriangleId t, int orientation) const {
    Cap cap;
    cap.corners   = oriented(meshes_.triangles()[t], orientation);
    const dvec3 a = vertices_[cap.corners[0]], b = vertices_[cap.corners[1]], c = vertices_[cap.corners[2]];
    const dvec3 p = b - a, q = c - a;
    const double size = glm::length(a);
    cap.behind        = glm::cross(q, p);
    cap.behind_offset = -glm::dot(cap.behind, a);
    cap.doubt         = slack_ * (glm::length(p) * (size + glm::length(c)) + glm::length(q) * (size + glm::length(b)));
    cap.origin_behind = cap.behind_offset > 0;
    if (is_near_origin(cap.behind_offset, cap.doubt)) {
        const auto at     = [&](int k) { return meshes_.vertices()[cap.corners[k]]; };
        cap.origin_behind = side_of_origin(at(0), at(1), rational(at(2)) - rational(at(0))) < 0;
    }
    return cap;
}

SeenVolumes::VolumePlane SeenVolumes::side_plane(std::uint32_t a, std::uint32_t b) const {
    VolumePlane plane;
    plane.normal         = glm::cross(far(a), vertices_[b] - vertices_[a]);
    plane.offset         = -glm::dot(plane.normal, vertices_[a]);
    plane.doubt          = slack_ * far_size(a) * (glm::length(vertices_[a]) + glm::length(vertices_[b]));
    plane.origin_outside = plane.offset >= 0;
    if (is_near_origin(plane.offset, plane.doubt)) {
        const vec3 at_a = meshes_.vertices()[a], at_b = meshes_.vertices()[b];
        const Rational3 far  = at_infinity_ ? rational(light_.direction) : rational(at_a) - rational(light_.position);
        plane.origin_outside = side_of_origin(at_a, at_b, far) <= 0;
    }
    return plane;
}

SeenVolumes::Line SeenVolumes::edge(std::uint32_t from, std::uint32_t to) const {
    const dvec3 a = vertices_[std::min(from, to)], b = vertices_[std::max(from, to)];
    return {glm::cross(a, b), slack_ * glm::length(a) * glm::length(b), from < to ? +1 : -1};
}

SeenVolumes::Line SeenVolumes::far_edge(std::uint32_t from, std::uint32_t to) const {
    return {glm::cross(far(std::min(from, to)), far(std::max(from, to))), slack_ * far_size(from) * far_size(to),
            from < to ? +1 : -1};
}

SeenVolumes::Line SeenVolumes::end_line(std::uint32_t v) const {
    return {glm::cross(vertices_[v], travel_), slack_ * glm::length(vertices_[v]) * glm::length(travel_), +1};
}

/// Whether the sign of a plane's offset, which is the side that O is on, is open.
bool SeenVolumes::is_near_origin(double offset, double doubt) const {
    return !(std::abs(offset) * largest_w_ > doubt) || doubt <= 1e-290;
}

int SeenVolumes::side_of_origin(vec3 a, vec3 b, const Rational3& c) const {
    return exact_visibility::sign_of_determinant(rational(b) - rational(a), c, rational(origin_) - rational(a));
}

}  // namespace umbra
