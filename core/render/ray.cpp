// Embree is used with ROBUST (watertight edges, up to a fifth slower) and MEDIUM build quality.
#include "umbra/core/render/ray.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "umbra/core/base/geometry.h"
#include "umbra/core/render/embree_api.h"

namespace umbra {

// ---- the thread's floating-point mode -------------------------------------------------------------------------------

#if defined(__SSE2__)
FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }  // FTZ and DAZ
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }
#else
FlushDenormals::FlushDenormals() : saved_(0) {}
FlushDenormals::~FlushDenormals() = default;
#endif

namespace {

/// A ray's own triangle does not count as a hit. Embree calls this for the few triangles that a shadow ray does hit.
void skip_own_triangle(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned k = 0; k < arguments->N; ++k)
        if (RTCHitN_primID(arguments->hit, arguments->N, k) == RTCRayN_id(arguments->ray, arguments->N, k))
            arguments->valid[k] = 0;
}

/// Eye rays meet no triangle whose entry is 0. Embree calls this for all triangles that a ray may meet first, where the
/// scene has objects that the eye does not see.
void skip_unseen(const RTCFilterFunctionNArguments* arguments) {
    const auto* seen = static_cast<const std::uint8_t*>(arguments->geometryUserPtr);
    for (unsigned k = 0; k < arguments->N; ++k)
        if (RTCRayN_mask(arguments->ray, arguments->N, k) == kEyeRay && arguments->valid[k] != 0 &&
            seen[RTCHitN_primID(arguments->hit, arguments->N, k)] == 0)
            arguments->valid[k] = 0;
}

/// One entry a triangle; none where the eye sees all objects.
std::vector<std::uint8_t> seen_triangles(const Scene& scene) {
    if (std::ranges::all_of(scene.objects, [](const Object& object) { return object.switches.seen_by_camera; }))
        return {};
    std::vector<std::uint8_t> seen(scene.triangles.size());
    for (TriangleId t = 0; t < seen.size(); ++t) seen[t] = scene.switches(t).seen_by_camera ? 1 : 0;
    return seen;
}

RaySpace fit_space(const Box& box) {
    RaySpace space;
    if (box.empty()) return space;
    float extent = 0;
    for (int k = 0; k < 3; ++k) {
        const float near = std::min(std::abs(box.min[k]), std::abs(box.max[k]));
        const bool aside = (box.min[k] > 0) == (box.max[k] > 0) && box.max[k] * 0.5f - box.min[k] * 0.5f <= near;
        if (aside && box.min[k] != 0) space.centre[k] = 0.5f * box.min[k] + 0.5f * box.max[k];
        extent = std::max({extent, std::abs(box.min[k] - space.centre[k]), std::abs(box.max[k] - space.centre[k])});
    }
    if (extent > 0) space.scale = std::ldexp(1.0f, std::clamp(-std::ilogb(extent), -126, 126));
    return space;
}

}  // namespace

RayScene::RayScene(const Scene& scene, Met met) : impl_(std::make_unique<Impl>()), space_(fit_space(bounds(scene))) {
    const std::size_t triangles = scene.triangles.size();
    if (triangles > 0) {
        static_assert(sizeof(vec3) == 12 && sizeof(uvec3) == 12);
        RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices       = static_cast<vec3*>(rtcSetNewGeometryBuffer(
                  geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), scene.positions.size() + 1));
        auto* indices        = static_cast<uvec3*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(uvec3), triangles));
        if (vertices && indices) {
            std::transform(scene.positions.begin(), scene.positions.end(), vertices,
                           [&](vec3 p) { return space_.point(p); });
            // All triangles keep their numbers. Those that no ray can meet, or is not to meet, have a corner without
            // numbers (NaN), so that Embree's tree leaves them out.
            vertices[scene.positions.size()] = vec3(std::numeric_limits<float>::quiet_NaN());
            const auto is_met                = [&](TriangleId t) {
                const uvec3 v = scene.triangles[t];
                return v.x != v.y && v.y != v.z && v.z != v.x && (met == Met::all || scene.blocks(t));
            };
            for (TriangleId t = 0; t < triangles; ++t)
                indices[t] = is_met(t) ? scene.triangles[t] : uvec3(static_cast<unsigned>(scene.positions.size()));
            impl_->vertices  = {vertices, scene.positions.size()};
            impl_->triangles = {indices, triangles};
            rtcSetGeometryOccludedFilterFunction(geometry, skip_own_triangle);
            impl_->seen = seen_triangles(scene);
            if (!impl_->seen.empty()) {
                rtcSetGeometryUserData(geometry, impl_->seen.data());
                rtcSetGeometryIntersectFilterFunction(geometry, skip_unseen);
            }
            rtcCommitGeometry(geometry);
            rtcAttachGeometryByID(impl_->scene, geometry, 0);
        }
        rtcReleaseGeometry(geometry);
    }
    impl_->commit();
}

RayScene::~RayScene()                              = default;
RayScene::RayScene(RayScene&&) noexcept            = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::size_t RayScene::memory_bytes() const {
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, impl_->bytes));
}

void RayScene::occluded(ShadowPacket& rays) const {
    static_assert(offsetof(ShadowPacket, valid) == sizeof(RTCRay8) && alignof(ShadowPacket) == alignof(RTCRay8));
    static_assert(offsetof(ShadowPacket, tfar) == offsetof(RTCRay8, tfar) &&
                  offsetof(ShadowPacket, id) == offsetof(RTCRay8, id));
    occluded_incoherent(impl_->scene, rays.valid, reinterpret_cast<RTCRay8&>(rays));
}

void RayScene::occluded(std::span<ShadowRay> rays) const {
    if (!rays.empty()) occluded_list(impl_->scene, rays);
}

TriangleId RayScene::first_hit(ShadowRay ray) const {
    for (;;) {  // once, and once more for each time that it meets its own triangle
        RTCRayHit hit{};
        hit.ray.org_x = ray.org_x, hit.ray.org_y = ray.org_y, hit.ray.org_z = ray.org_z;
        hit.ray.dir_x = ray.dir_x, hit.ray.dir_y = ray.dir_y, hit.ray.dir_z = ray.dir_z;
        hit.ray.tnear = ray.tnear, hit.ray.tfar = ray.tfar, hit.ray.mask = ray.mask;
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersect_one(impl_->scene, hit);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kNoTriangle;
        if (hit.hit.primID != ray.id) return hit.hit.primID;
        ray.tnear = std::nextafter(hit.ray.tfar, kInfinity);
    }
}

// ---- distance -------------------------------------------------------------------------------------------------------

double RayScene::clearance(dvec3 point, double reach) const {
    struct Nearest {
        const Impl& impl;
        dvec3 point;
        double distance;
    } nearest{*impl_, point, reach};
    RTCPointQuery query{};
    query.x = static_cast<float>(point.x), query.y = static_cast<float>(point.y), query.z = static_cast<float>(point.z);
    query.radius = static_cast<float>(reach) * (1 + 0x1p-20f) + 0x1p-20f;  // the point is rounded
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(
        impl_->scene, &query, &context,
        [](RTCPointQueryFunctionArguments* found) {
            auto& n       = *static_cast<Nearest*>(found->userPtr);
            const uvec3 t = n.impl.triangles[found->primID];
            const auto v  = [&](unsigned k) { return dvec3(n.impl.vertices[k]); };
            n.distance    = std::min(n.distance, distance_to_triangle(n.point, v(t.x), v(t.y), v(t.z)));
            return false;  // the query's radius stays
        },
        &nearest);
    return nearest.distance;
}

}  // namespace umbra
