#include "umbra/shadows/exact/silhouette_edges.h"

#include "umbra/core/base/predicates.h"
#include "umbra/core/base/rounding.h"

namespace umbra::exact_visibility {
namespace {

constexpr double kNormalError = 0x1p-20;  ///< a rounded unit normal is off by less than 2^-22 in each component, so
                                          ///< its product with d by less than 2^-20 of d's largest component

}  // namespace

SilhouetteEdges::SilhouetteEdges(const Occluders& occluders) : occluders_(occluders), tree_(find_candidates()) {
    std::vector<CandidateEdge> ordered;
    ordered.reserve(edges_.size());
    for (const std::uint32_t e : tree_.renumber()) ordered.push_back(edges_[e]);
    edges_ = std::move(ordered);
    cones_ = tree_.summaries([&](std::uint32_t e) { return cone_of(edges_[e]); }, NormalCone::joined);
}

/// Fills `edges_`, and returns the edges' boxes.
std::vector<Box> SilhouetteEdges::find_candidates() {
    std::vector<Box> boxes;
    for (std::size_t e = 0; e < occluders_.edges.size(); ++e) {
        CandidateEdge edge{occluders_.edges[e]};
        edge.at = occluders_.position(edge.a);
        for (std::uint32_t k = 0; edge.count <= 2 && k < edge.count; ++k) {
            const PackedUse use = uses(edge)[k];
            const auto corner   = [&](int c) { return occluders_.scene.vertex(use.triangle, c); };
            edge.normal[k]      = turned(normal_unless_thin(corner(0), corner(1), corner(2)), use);
        }
        if (edge.count == 2 && continue_each_other(edge)) continue;
        edges_.push_back(edge);
        boxes.push_back(extend(extend(Box{}, edge.at), occluders_.position(edge.b)));
    }
    return boxes;
}

/// Whether the edge's two triangles continue each other in one plane: they cancel wherever they are seen from.
bool SilhouetteEdges::continue_each_other(const CandidateEdge& edge) const {
    const auto corner      = [&](TriangleId t, int k) { return occluders_.scene.vertex(t, k); };
    const TriangleId first = uses(edge)[0].triangle, second = uses(edge)[1].triangle;
    const bool alike = uses(edge)[0].forward != uses(edge)[1].forward;
    const bool thin  = edge.normal[0] == vec3(0) || edge.normal[1] == vec3(0);
    if (!thin && glm::dot(edge.normal[0], edge.normal[1]) > 0) return false;
    int opposite  = 0;
    const uvec3 v = occluders_.corners[second];
    while (v[opposite] == edge.a || v[opposite] == edge.b) ++opposite;
    if (side_of_plane(corner(first, 0), corner(first, 1), corner(first, 2), corner(second, opposite)) != 0)
        return false;
    if (!thin) return true;
    // Thin triangles: their normals' directions may be noise.
    const auto exact_normal = [&](TriangleId t) {
        const Rational3 a = rational(corner(t, 0));
        return cross(rational(corner(t, 1)) - a, rational(corner(t, 2)) - a);
    };
    return (dot(exact_normal(first), exact_normal(second)) > 0) == alike;
}

NormalCone SilhouetteEdges::cone_of(const CandidateEdge& edge) const {
    if (edge.count != 2 || edge.normal[0] == vec3(0) || edge.normal[1] == vec3(0)) return {};
    // Turned back, so that neighbours of one winding have one direction.
    const PackedUse first = uses(edge)[0];
    return NormalCone::joined(NormalCone::around(turned(edge.normal[0], first), 0),
                              NormalCone::around(-turned(edge.normal[1], first), 0));
}

int SilhouetteEdges::change_at(const Viewpoint& viewpoint, const CandidateEdge& edge) const {
    const Entries d   = viewpoint.point().to(edge.at);
    const double sure = kNormalError * largest(d.value) + 4 * d.error;
    std::uint32_t k   = 0;
    return change_of(uses(edge), [&](TriangleId t) {
        const bool forward = uses(edge)[k].forward != 0;
        const double over  = edge.count <= 2 ? glm::dot(d.value, dvec3(edge.normal[k])) : 0;  // turned
        ++k;
        if (t == viewpoint.own()) return 0;
        return std::abs(over) > sure ? ((over > 0) == forward ? 1 : -1) : viewpoint.side_of(t);
    });
}

void SilhouetteEdges::gather(const Viewpoint& viewpoint, const FloatSpace& space, double reach,
                             std::vector<SilhouetteEdge>& found) const {
    found.clear();
    const auto take = [&](std::uint32_t e) {
        const int change = change_at(viewpoint, edges_[e]);
        if (change != 0) found.push_back({e, change});
        return true;
    };
    if (space.orientation() == kUnsure) {  // next to nothing is known of directions
        for (std::uint32_t e = 0; e < edges_.size(); ++e) take(e);
        return;
    }
    const BoxTree::Region region = shaft(viewpoint.point(), space, reach);
    const auto enter = [&](std::uint32_t node, const Box& box) { return !cones_[node].one_sided(box, region.from); };
    tree_.visit(region, enter, take);
}

bool SilhouetteEdges::gather_around(const Viewpoint& viewpoint, BoxTree::Region region, double around, std::size_t most,
                                    EdgeGroup& group) const {
    group.origin = viewpoint.point().rounded();
    group.edges.clear();
    // From a point p + d the light lies in p's region moved by at most d.
    region.slack += around;
    const double far   = 1.75 * around;  // more than the root of three
    const double slack = 4 * viewpoint.point().slack() + 2 * kNormalError * around + far;
    // Whether the edge's two triangles surely cancel for all these points. Twice the normals' error is more than that
    // and the rounding of d.
    const auto cancels = [&](const CandidateEdge& edge) {
        const dvec3 d     = dvec3(edge.at) - group.origin;
        const double sure = 2 * kNormalError * largest(d) + slack;
        const double one = glm::dot(d, dvec3(edge.normal[0])), other = glm::dot(d, dvec3(edge.normal[1]));
        return edge.count == 2 && std::min(one, other) < -sure && std::max(one, other) > sure;
    };
    const auto enter = [&](std::uint32_t node, const Box& box) {
        return !cones_[node].one_sided(box, region.from, far);
    };
    tree_.visit(region, enter, [&](std::uint32_t e) {
        if (!cancels(edges_[e])) group.edges.push_back(e);
        return group.edges.size() <= most;
    });
    const std::size_t n = group.edges.size();
    if (n > most) return false;
    for (int k = 0; k < 3; ++k)
        for (auto* list : {&group.a, &group.b, &group.first, &group.second}) (*list)[k].resize(n);
    const auto put = [&](std::array<std::vector<float>, 3>& list, std::size_t e, vec3 v) {
        for (int k = 0; k < 3; ++k) list[k][e] = v[k];
    };
    for (std::size_t e = 0; e < n; ++e) {
        const CandidateEdge& edge = edges_[group.edges[e]];
        put(group.a, e, vec3(dvec3(edge.at) - group.origin));
        put(group.b, e, vec3(dvec3(occluders_.position(edge.b)) - group.origin));
        put(group.first, e, edge.normal[0]);
        put(group.second, e, edge.normal[1]);
    }
    return true;
}

UMBRA_FOR_EACH_PROCESSOR void SilhouetteEdges::pick(const Viewpoint& viewpoint, const FloatSpace& space, double reach,
                                                    EdgeGroup& group, std::vector<SilhouetteEdge>& found) const {
    // Floats, with a bound of 2^-19 of the largest coordinates: each is rounded to 2^-24 of itself, and so is each of
    // five operations on products with numbers of at most 1.
    constexpr float kRounding    = 0x1p-19f;
    const BoxTree::Region region = shaft(viewpoint.point(), space, reach);
    struct RegionPlane {
        float x, y, z, offset, tilt, least;  ///< least: see beyond
    };
    std::array<RegionPlane, 5> planes;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        const dvec3 n     = region.planes[k].normal;
        const double size = sum_of_magnitudes(n);
        planes[k]         = {float(n.x / size),
                             float(n.y / size),
                             float(n.z / size),
                             float(region.planes[k].offset / size),
                             kRounding + static_cast<float>(4 * region.tilt / size),
                             0};
    }
    const dvec3 moved = region.from - group.origin;
    const float dx = float(moved.x), dy = float(moved.y), dz = float(moved.z);
    // Below 2^-126 a float is off by up to 2^-150, whatever its size; so is what a few dozen operations leave there.
    constexpr float kDenormal = 0x1p-140f;
    const float slack         = static_cast<float>(4 * region.slack) + kDenormal,
                d             = std::abs(dx) + std::abs(dy) + std::abs(dz);
    for (RegionPlane& plane : planes) plane.least = plane.tilt * (d + std::abs(plane.offset)) + slack;
    const std::size_t n = group.edges.size();
    group.out.resize(n);
    const float *ax = group.a[0].data(), *ay = group.a[1].data(), *az = group.a[2].data();
    const float *bx = group.b[0].data(), *by = group.b[1].data(), *bz = group.b[2].data();
    const float *fx = group.first[0].data(), *fy = group.first[1].data(), *fz = group.first[2].data();
    const float *sx = group.second[0].data(), *sy = group.second[1].data(), *sz = group.second[2].data();
    std::int32_t* out = group.out.data();
    for (std::size_t e = 0; e < n; ++e) {
        const float x = ax[e] - dx, y = ay[e] - dy, z = az[e] - dz;
        const float one = fx[e] * x + fy[e] * y + fz[e] * z, other = sx[e] * x + sy[e] * y + sz[e] * z;
        const float sure = kRounding * (std::abs(ax[e]) + std::abs(ay[e]) + std::abs(az[e]) + d) + slack;
        out[e]           = (int{one > sure} & int{other < -sure}) | (int{one < -sure} & int{other > sure});
    }
    // Most go with that, and so the ends of the others are laid side by side before they are tried with five planes.
    std::vector<std::uint32_t>& left = group.left;
    left.resize(n);
    std::size_t rest = 0;
    for (std::uint32_t e = 0; e < n; ++e) {  // no jumps: which of them it is has no pattern
        left[rest] = e;
        rest += out[e] == 0;
    }
    for (int k = 0; k < 3; ++k) {
        group.left_a[k].resize(rest), group.left_b[k].resize(rest);
        const float *a = group.a[k].data(), *b = group.b[k].data();
        for (std::size_t i = 0; i < rest; ++i) group.left_a[k][i] = a[left[i]], group.left_b[k][i] = b[left[i]];
    }
    ax = group.left_a[0].data(), ay = group.left_a[1].data(), az = group.left_a[2].data();
    bx = group.left_b[0].data(), by = group.left_b[1].data(), bz = group.left_b[2].data();
    for (std::size_t e = 0; e < rest; ++e) {
        const float size =
            std::abs(ax[e]) + std::abs(ay[e]) + std::abs(az[e]) + std::abs(bx[e]) + std::abs(by[e]) + std::abs(bz[e]);
        const float px = ax[e] - dx, py = ay[e] - dy, pz = az[e] - dz;
        const float qx = bx[e] - dx, qy = by[e] - dy, qz = bz[e] - dz;
        std::int32_t outside = 0;
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const RegionPlane& plane = planes[k];
            const float p            = plane.x * px + plane.y * py + plane.z * pz + plane.offset,
                        q            = plane.x * qx + plane.y * qy + plane.z * qz + plane.offset;
            const float beyond       = -(plane.tilt * size + plane.least);
            outside |= int{p < beyond} & int{q < beyond};
        }
        out[e] = outside;
    }
    found.clear();
    for (std::size_t e = 0; e < rest; ++e) {
        if (out[e] != 0) continue;
        const std::uint32_t edge = group.edges[left[e]];
        const int change         = change_at(viewpoint, edges_[edge]);
        if (change != 0) found.push_back({edge, change});
    }
}

std::size_t SilhouetteEdges::memory_bytes() const {
    return edges_.size() * sizeof(CandidateEdge) + cones_.size() * sizeof(NormalCone) + tree_.memory_bytes();
}

}  // namespace umbra::exact_visibility
