#include "umbra/bench/studies/light/body_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "umbra/core/render/embree_api.h"

namespace umbra {
namespace {

/// World space to the axes of a body, from its centre.
dvec3 into_axes(const Body& body, dvec3 direction) { return glm::transpose(body.axes) * direction; }

/// Half the size of a body's bounds, world space.
dvec3 half_bounds(const Body& body) {
    if (body.kind == BodyKind::sphere) return dvec3(body.radius);
    dvec3 half(0);
    for (int k = 0; k < 3; ++k) half += body.half_size[k] * glm::abs(body.axes[k]);
    return half;
}

/// Where a ray crosses a body's surface: distances in (least, reach), ascending.
struct Crossings {
    double t[4]{};
    int count = 0;
};

// A ray that starts on a body has a crossing there, which is 0 except for rounding: the nearest to 0, and it does not
// count. No tolerance: however short the way through the body is, it is found.
Crossings crossings(const Body& body, bool starts_here, const BodyRay& ray, double least) {
    const Passages passages = through_body(body, ray.origin, ray.direction);
    double ends[4]{};
    int count = 0, start = -1;
    for (int k = 0; k < passages.count; ++k)
        for (const double end :
             {passages.list[static_cast<std::size_t>(k)].enter, passages.list[static_cast<std::size_t>(k)].leave})
            ends[count++] = end;
    for (int k = 0; starts_here && k < count; ++k)
        if (start < 0 || std::abs(ends[k]) < std::abs(ends[start])) start = k;
    Crossings found;
    for (int k = 0; k < count; ++k)
        if (k != start && ends[k] > (starts_here ? 0 : least) && ends[k] < ray.reach) found.t[found.count++] = ends[k];
    return found;
}

Passages alone(const std::optional<Passage>& passage) { return passage ? Passages{{*passage}, 1} : Passages{}; }

// In tree space the bodies lie within [-1, 1], so that floats there round by at most 2^-24, and by 2^-22 along a ray
// through it. Bounds and reaches are larger by kSlack.
constexpr double kSlack = 0x1p-20;

}  // namespace

Passages through_body(const Body& body, dvec3 origin, dvec3 direction) {
    if (body.kind == BodyKind::sphere) return alone(through_sphere(origin, direction, body.centre, body.radius));
    const dvec3 from = into_axes(body, origin - body.centre), along = into_axes(body, direction);
    switch (body.kind) {
        case BodyKind::cylinder: return alone(through_cylinder(from, along, body.radius, body.half_size.z));
        case BodyKind::cone: return alone(through_cone(from, along, body.radius, body.half_size.z));
        case BodyKind::torus: return through_torus(from, along, body.radius, body.half_size.z);
        default: return alone(through_box(from, along, -body.half_size, body.half_size));
    }
}

namespace {

/// Cylinder, cone or torus: p along the axes, and the answer too.
OnSurface onto_turned(const Body& body, dvec3 p) {
    const double half = body.half_size.z, far = std::hypot(p.x, p.y);
    const dvec3 outwards = far > 0 ? dvec3(p.x / far, p.y / far, 0) : dvec3(1, 0, 0), axis(0, 0, 1);
    if (body.kind == BodyKind::torus) {
        const dvec3 ring = body.radius * outwards, normal = glm::normalize(p - ring);
        return {ring + half * normal, normal};
    }
    const bool is_cone = body.kind == BodyKind::cone;
    // The side, and the caps: those that p is farther outside of, or less far inside.
    const dvec3 normal  = is_cone ? glm::normalize(2 * half * outwards + body.radius * axis) : outwards;
    const double beside = glm::dot(normal, p - (is_cone ? half * axis : body.radius * outwards)),
                 beyond = is_cone ? -half - p.z : std::abs(p.z) - half;
    if (beyond > beside) {
        const double side = is_cone || p.z < 0 ? -1 : 1;
        return {std::min(far, body.radius) * outwards + side * half * axis, side * axis};
    }
    const double z = std::clamp(p.z - beside * normal.z, -half, half);
    return {(is_cone ? body.radius * (half - z) / (2 * half) : body.radius) * outwards + z * axis, normal};
}

}  // namespace

OnSurface onto_surface(const Body& body, dvec3 p) {
    if (body.kind == BodyKind::sphere) {
        const dvec3 normal = glm::normalize(p - body.centre);
        return {body.centre + body.radius * normal, normal};
    }
    dvec3 local = into_axes(body, p - body.centre);
    if (body.kind != BodyKind::box) {
        const OnSurface on = onto_turned(body, local);
        return {body.centre + body.axes * on.position, body.axes * on.normal};
    }
    int face = 0;
    for (int k = 1; k < 3; ++k)
        if (std::abs(local[k]) - body.half_size[k] > std::abs(local[face]) - body.half_size[face]) face = k;
    const double side = local[face] < 0 ? -1 : 1;
    local             = glm::clamp(local, -body.half_size, body.half_size);
    local[face]       = side * body.half_size[face];
    return {body.centre + body.axes * local, side * body.axes[face]};
}

struct BodyTree::Impl : EmbreeScene {
    std::vector<Body> bodies;
    std::vector<vec3> passes;        ///< one a body
    std::vector<std::uint8_t> seen;  ///< the same; empty: all are
    dvec3 centre{0};                 ///< tree space: (p - centre) * scale
    double scale = 1;
    double least = 0;  ///< world units

    Impl(std::vector<Body> bodies_, std::vector<vec3> passes_, std::vector<std::uint8_t> seen_)
        : bodies(std::move(bodies_)), passes(std::move(passes_)), seen(std::move(seen_)) {
        fit_space();
        build();
    }

    void fit_space() {
        if (bodies.empty()) return;
        dvec3 low(static_cast<double>(kInfinity)), high(-low);
        for (const Body& body : bodies) {
            low  = glm::min(low, body.centre - half_bounds(body));
            high = glm::max(high, body.centre + half_bounds(body));
        }
        centre             = 0.5 * low + 0.5 * high;
        const dvec3 half   = 0.5 * high - 0.5 * low;
        scale              = 1 / std::max({half.x, half.y, half.z});
        const dvec3 corner = glm::max(glm::abs(low), glm::abs(high));
        least              = 1e-12 * std::max({corner.x, corner.y, corner.z});
    }

    void build() {
        if (!bodies.empty()) {
            RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
            rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(bodies.size()));
            rtcSetGeometryUserData(geometry, this);
            rtcSetGeometryBoundsFunction(geometry, bounds_of, nullptr);
            rtcSetGeometryIntersectFunction(geometry, intersect);
            rtcSetGeometryOccludedFunction(geometry, occlude);
            rtcCommitGeometry(geometry);
            rtcAttachGeometryByID(scene, geometry, 0);
            rtcReleaseGeometry(geometry);
        }
        commit();
    }

    /// A ray in tree space from where it enters the space, for Embree alone; `ray` is what the formulas take.
    struct Query : RayQuery {
        const Impl& tree;
        const BodyRay& ray;
        double start = 0;  ///< of the traced ray along `ray`, tree space
        RTCRayHit traced{};
        BodyMeeting nearest;
        bool blocked = false;
        std::vector<std::uint32_t> filters;  ///< bodies that let a part of the light through, once a crossing

        Query(const Impl& tree_, const BodyRay& ray_) : tree(tree_), ray(ray_) { nearest.t = ray.reach; }

        /// Whether it comes near the bodies at all.
        bool aim() {
            const dvec3 from   = (ray.origin - tree.centre) * tree.scale;
            const auto passage = through_box(from, ray.direction, dvec3(-1 - kSlack), dvec3(1 + kSlack));
            if (!passage || passage->leave < 0) return false;
            start = std::max(0.0, passage->enter);
            const vec3 o(from + start * ray.direction), d(ray.direction);
            traced.ray.org_x = o.x, traced.ray.org_y = o.y, traced.ray.org_z = o.z;
            traced.ray.dir_x = d.x, traced.ray.dir_y = d.y, traced.ray.dir_z = d.z;
            traced.ray.tfar   = reach_of(ray.reach);
            traced.ray.mask   = ~0u;
            traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            return traced.ray.tfar >= 0;
        }
        [[nodiscard]] float reach_of(double t) const { return static_cast<float>(t * tree.scale - start + kSlack); }
        [[nodiscard]] Crossings crossings_of(std::uint32_t b) const {
            return crossings(tree.bodies[b], b == ray.from, ray, tree.least);
        }
    };

    static void bounds_of(const RTCBoundsFunctionArguments* arguments) {
        const Impl& tree = *static_cast<const Impl*>(arguments->geometryUserPtr);
        const Body& body = tree.bodies[arguments->primID];
        const dvec3 half = half_bounds(body) * tree.scale + kSlack, middle = (body.centre - tree.centre) * tree.scale;
        const vec3 low(middle - half), high(middle + half);
        RTCBounds& bounds = *arguments->bounds_o;
        bounds.lower_x = low.x, bounds.lower_y = low.y, bounds.lower_z = low.z;
        bounds.upper_x = high.x, bounds.upper_y = high.y, bounds.upper_z = high.z;
    }

    static void intersect(const RTCIntersectFunctionNArguments* arguments) {
        if (arguments->valid[0] == 0) return;
        Query& query          = static_cast<Query&>(query_of(arguments));
        const std::uint32_t b = arguments->primID;
        if (query.ray.is_of_eye && !query.tree.seen.empty() && query.tree.seen[b] == 0) return;
        const Crossings found = query.crossings_of(b);
        if (found.count == 0) return;
        BodyMeeting& nearest = query.nearest;
        if (found.t[0] > nearest.t || (found.t[0] == nearest.t && b > nearest.body)) return;
        nearest                                                   = {b, found.t[0]};
        RTCRayN_tfar(RTCRayHitN_RayN(arguments->rayhit, 1), 1, 0) = query.reach_of(nearest.t);
    }

    static void occlude(const RTCOccludedFunctionNArguments* arguments) {
        if (arguments->valid[0] == 0) return;
        Query& query          = static_cast<Query&>(query_of(arguments));
        const std::uint32_t b = arguments->primID;
        const vec3 passes     = query.tree.passes[b];
        if (passes == vec3(1)) return;
        const Crossings found = query.crossings_of(b);
        query.filters.insert(query.filters.end(), static_cast<std::size_t>(found.count), b);
        query.blocked = query.blocked || (found.count > 0 && passes == vec3(0));
        if (query.blocked) RTCRayN_tfar(arguments->ray, 1, 0) = -kInfinity;
    }
};

BodyTree::BodyTree(std::vector<Body> bodies, std::vector<vec3> lets_through, std::vector<std::uint8_t> seen)
    : impl_(std::make_unique<Impl>(std::move(bodies), std::move(lets_through), std::move(seen))) {}
BodyTree::~BodyTree() = default;

const Body& BodyTree::body(std::uint32_t b) const { return impl_->bodies[b]; }

BodyMeeting BodyTree::first(const BodyRay& ray) const {
    if (impl_->bodies.empty()) return {};
    Impl::Query query(*impl_, ray);
    if (query.aim()) intersect_one(impl_->scene, query.traced, query);
    return query.nearest.body == kNoBody ? BodyMeeting() : query.nearest;
}

dvec3 BodyTree::lets_through(const BodyRay& ray) const {
    if (impl_->bodies.empty()) return dvec3(1);
    Impl::Query query(*impl_, ray);
    if (query.aim()) occluded_one(impl_->scene, query.traced.ray, query);
    if (query.blocked) return dvec3(0);
    std::ranges::sort(query.filters);  // the product is the same bits whatever Embree visits first
    dvec3 product(1);
    for (const std::uint32_t b : query.filters) product *= dvec3(impl_->passes[b]);
    return product;
}

}  // namespace umbra
