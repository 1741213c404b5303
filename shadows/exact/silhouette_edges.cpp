#include "umbra/shadows/exact/silhouette_edges.h"

#include "umbra/core/base/predicates.h"

namespace umbra::exact_detail {
namespace {

constexpr double kThin = 1e-6;  ///< sine of a triangle's angle below which its normal, a difference of products, may
                                ///< be off by more than a float's rounding
constexpr double kUnderflow   = 1e-290;   ///< products below this have lost digits
constexpr double kNormalError = 0x1p-20;  ///< a rounded unit normal is off by less than 2^-22 in each component, so
                                          ///< its product with d by less than 2^-20 of d's largest component

}  // namespace

/// Whether the edge's two triangles continue each other in one plane: they cancel wherever they are seen from.
bool SilhouetteEdges::continue_each_other(const CandidateEdge& edge, const dvec3 (&normal)[2]) const {
    const auto corner    = [&](TriangleId t, int k) { return occluders_->scene->vertex(t, k); };
    const EdgeUse &first = uses_[edge.first], &second = uses_[edge.first + 1];
    const auto in_one_plane = [&] {
        return side_of_plane(corner(first.triangle, 0), corner(first.triangle, 1), corner(first.triangle, 2),
                             corner(second.triangle, (second.side + 2) % 3)) == 0;
    };
    const bool alike  = first.forward != second.forward;
    const double even = glm::dot(normal[0], normal[1]);
    if ((even > 0) != alike && edge.normal[0] != vec3(0) && edge.normal[1] != vec3(0)) return false;
    if (!in_one_plane()) return false;
    if (edge.normal[0] != vec3(0) && edge.normal[1] != vec3(0)) return true;
    // Thin triangles: their normals' directions may be noise.
    const auto exact_normal = [&](TriangleId t) {
        const Rational3 a = rational(corner(t, 0));
        return cross(rational(corner(t, 1)) - a, rational(corner(t, 2)) - a);
    };
    return (dot(exact_normal(first.triangle), exact_normal(second.triangle)) > 0) == alike;
}

void SilhouetteEdges::add(const Edge& e) {
    const auto corner        = [&](TriangleId t, int k) { return dvec3(occluders_->scene->vertex(t, k)); };
    const Topology& topology = occluders_->topology;
    CandidateEdge edge{e.a, e.b, static_cast<std::uint32_t>(uses_.size()), 0};
    for (std::uint32_t k = e.first; k < e.first + e.count; ++k)
        if (!occluders_->casts_nothing[topology.uses[k].triangle]) uses_.push_back(topology.uses[k]);
    edge.count = static_cast<std::uint32_t>(uses_.size()) - edge.first;
    bool flat  = false;
    if (edge.count == 2) {
        dvec3 normal[2];
        for (std::size_t k = 0; k < 2; ++k) {
            const TriangleId t = uses_[edge.first + k].triangle;
            const dvec3 x = corner(t, 1) - corner(t, 0), y = corner(t, 2) - corner(t, 0);
            normal[k]         = glm::cross(x, y);
            const double size = glm::length(normal[k]);
            if (size > kThin * glm::length(x) * glm::length(y) && size > kUnderflow)
                edge.normal[k] = vec3(normal[k] / size);
        }
        flat = continue_each_other(edge, normal);
    }
    if (edge.count == 0 || flat)
        uses_.resize(edge.first);
    else
        edges_.push_back(edge);
}

NormalCone SilhouetteEdges::cone_of(const CandidateEdge& edge) const {
    const vec3 &n = edge.normal[0], &m = edge.normal[1];
    if (edge.count != 2 || n == vec3(0) || m == vec3(0)) return {};
    const bool alike = uses_[edge.first].forward != uses_[edge.first + 1].forward;
    return NormalCone::joined(NormalCone::around(n, 0), NormalCone::around(alike ? m : -m, 0));
}

void SilhouetteEdges::build(const Occluders& occluders) {
    occluders_ = &occluders;
    uses_.clear();
    edges_.clear();
    for (const Edge& e : occluders.topology.edges) add(e);
    std::vector<Box> boxes(edges_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e)
        boxes[e] = extend(extend(Box{}, occluders.position(edges_[e].a)), occluders.position(edges_[e].b));
    tree_.emplace(std::move(boxes));
    cones_ = tree_->summaries([&](std::uint32_t e) { return cone_of(edges_[e]); }, NormalCone::joined);
}

int SilhouetteEdges::change_at(const Viewpoint& viewpoint, const CandidateEdge& edge) const {
    int change        = 0;
    const Entries d   = viewpoint.point().to(occluders_->position(edge.a));
    const double sure = kNormalError * largest(d.value) + 4 * d.error;
    for (std::uint32_t k = 0; k < edge.count; ++k) {
        const EdgeUse& use = uses_[edge.first + k];
        const double over  = edge.count == 2 ? glm::dot(d.value, dvec3(edge.normal[k])) : 0;
        const int side     = use.triangle == viewpoint.own() ? 0
                             : std::abs(over) > sure         ? (over > 0 ? 1 : -1)
                                                             : viewpoint.side_of(use.triangle);
        change += use.forward ? side : -side;
    }
    return change;
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
    tree_->visit(region, enter, take);
}

std::size_t SilhouetteEdges::memory_bytes() const {
    return uses_.size() * sizeof(EdgeUse) + edges_.size() * sizeof(CandidateEdge) + cones_.size() * sizeof(NormalCone) +
           (tree_ ? tree_->memory_bytes() : 0);
}

}  // namespace umbra::exact_detail
