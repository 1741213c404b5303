// Embree 3 and 4 behind one set of calls, and the part of it that a RayScene holds. Internal to core/render.
#pragma once

#if __has_include(<embree3/rtcore.h>)  // the order in which CMakeLists.txt looks for them
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "umbra/core/render/ray.h"

namespace umbra {

#if RTC_VERSION_MAJOR >= 4
inline void intersect_coherent(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &rays, &arguments);
}
inline void occluded_incoherent(RTCScene scene, const int* valid, RTCRay8& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded8(valid, scene, &rays, &arguments);
}
inline void occluded_list(RTCScene scene,
                          std::span<ShadowRay> rays) {  // Embree 4 has no lists any more: packets of eight
    for (std::size_t first = 0; first < rays.size(); first += 8) {
        alignas(32) int valid[8]{};
        RTCRay8 packet{};
        const std::size_t count = std::min<std::size_t>(8, rays.size() - first);
        for (std::size_t k = 0; k < count; ++k) {
            const ShadowRay& r = rays[first + k];
            valid[k]           = -1;
            packet.org_x[k] = r.org_x, packet.org_y[k] = r.org_y, packet.org_z[k] = r.org_z;
            packet.dir_x[k] = r.dir_x, packet.dir_y[k] = r.dir_y, packet.dir_z[k] = r.dir_z;
            packet.tnear[k] = r.tnear, packet.tfar[k] = r.tfar, packet.mask[k] = r.mask, packet.id[k] = r.id;
        }
        occluded_incoherent(scene, valid, packet);
        for (std::size_t k = 0; k < count; ++k) rays[first + k].tfar = packet.tfar[k];
    }
}
inline void intersect_one(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, nullptr); }

/// The ray as callbacks of user geometry receive it: derive from it.
struct RayQuery : RTCRayQueryContext {
    RayQuery() { rtcInitRayQueryContext(this); }
};
inline void intersect_one(RTCScene scene, RTCRayHit& ray, RayQuery& query) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &query;
    rtcIntersect1(scene, &ray, &arguments);
}
inline void occluded_one(RTCScene scene, RTCRay& ray, RayQuery& query) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &query;
    rtcOccluded1(scene, &ray, &arguments);
}
#else
/// The ray as callbacks of user geometry receive it: derive from it.
struct RayQuery : RTCIntersectContext {
    RayQuery() { rtcInitIntersectContext(this); }
};
inline void intersect_one(RTCScene scene, RTCRayHit& ray, RayQuery& query) { rtcIntersect1(scene, &query, &ray); }
inline void occluded_one(RTCScene scene, RTCRay& ray, RayQuery& query) { rtcOccluded1(scene, &query, &ray); }
inline void intersect_one(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
}
inline void intersect_coherent(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &rays);
}
inline void occluded_incoherent(RTCScene scene, const int* valid, RTCRay8& rays) {  // COHERENT makes shadow rays slower
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene, &context, &rays);
}
inline void occluded_list(RTCScene scene, std::span<ShadowRay> rays) {
    static_assert(sizeof(ShadowRay) == sizeof(RTCRay) && offsetof(ShadowRay, id) == offsetof(RTCRay, id));
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1M(scene, &context, reinterpret_cast<RTCRay*>(rays.data()), static_cast<unsigned>(rays.size()),
                  sizeof(ShadowRay));
}
#endif

/// The query in a callback's arguments.
template <class Arguments>
RayQuery& query_of(const Arguments* arguments) {
    return *static_cast<RayQuery*>(arguments->context);
}

inline bool count_memory(void* counter, ssize_t bytes, bool) {
    *static_cast<std::atomic<std::ptrdiff_t>*>(counter) += bytes;
    return true;
}

/// Embree's device and scene.
struct EmbreeScene {
    std::atomic<std::ptrdiff_t> bytes{0};
    RTCDevice device = nullptr;
    RTCScene scene   = nullptr;

    /// UMBRA_EMBREE configures Embree's device: "isa=sse4.2" limits it to instructions that other machines have.
    EmbreeScene() : device(rtcNewDevice(std::getenv("UMBRA_EMBREE"))) {
        if (!device)
            throw std::runtime_error("Embree gives no device, error " + std::to_string(rtcGetDeviceError(nullptr)));
        rtcSetDeviceMemoryMonitorFunction(device, count_memory, &bytes);
        scene = rtcNewScene(device);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    EmbreeScene(const EmbreeScene&)            = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// Builds the trees of the geometries that were attached. Throws std::runtime_error.
    void commit() {
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
        rtcCommitScene(scene);
        if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
            throw std::runtime_error("Embree cannot build its scene, error " + std::to_string(static_cast<int>(error)));
    }
};

struct RayScene::Impl : EmbreeScene {
    std::span<const vec3> vertices;  ///< Embree's own copies, in ray space
    std::span<const uvec3> triangles;
    std::vector<std::uint8_t> seen;  ///< by the eye, one a triangle; empty: all are
};

}  // namespace umbra
