// Embree is used with ROBUST (watertight edges; PLATFORM: up to a fifth slower) and MEDIUM build quality.
#include "core/ray.h"

#if __has_include(<embree3/rtcore.h>)  // the order in which CMakeLists.txt looks for them
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/parallel.h"

namespace umbra {

// ---- the thread's floating-point mode -------------------------------------------------------------------------------

#if defined(__SSE2__)
FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }  // FTZ and DAZ
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }
#else
FlushDenormals::FlushDenormals() : saved_(0) {}
FlushDenormals::~FlushDenormals() = default;
#endif

// ---- Embree's two versions ------------------------------------------------------------------------------------------

namespace {

#if RTC_VERSION_MAJOR >= 4
void intersect_coherent(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &rays, &arguments);
}
void occluded_incoherent(RTCScene scene, const int* valid, RTCRay8& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded8(valid, scene, &rays, &arguments);
}
#else
void intersect_coherent(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &rays);
}
void occluded_incoherent(RTCScene scene, const int* valid, RTCRay8& rays) {  // COHERENT makes shadow rays slower
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene, &context, &rays);
}
#endif

/// A ray's own triangle is no hit. Embree calls this for the few triangles that a shadow ray does hit.
void skip_own_triangle(const RTCFilterFunctionNArguments* arguments) {
    for (unsigned k = 0; k < arguments->N; ++k)
        if (RTCHitN_primID(arguments->hit, arguments->N, k) == RTCRayN_id(arguments->ray, arguments->N, k))
            arguments->valid[k] = 0;
}

bool count_memory(void* counter, ssize_t bytes, bool) {
    *static_cast<std::atomic<std::ptrdiff_t>*>(counter) += bytes;
    return true;
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

// ---- RayScene -------------------------------------------------------------------------------------------------------

struct RayScene::Impl {
    std::atomic<std::ptrdiff_t> bytes{0};
    RTCDevice device = nullptr;
    RTCScene scene   = nullptr;

    Impl() : device(rtcNewDevice(nullptr)) {
        if (!device) throw std::runtime_error("Embree gives no device");
        rtcSetDeviceMemoryMonitorFunction(device, count_memory, &bytes);
        scene = rtcNewScene(device);
    }
    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    Impl(const Impl&)            = delete;
    Impl& operator=(const Impl&) = delete;
};

RayScene::RayScene(const Scene& scene) : impl_(std::make_unique<Impl>()), space_(fit_space(bounds(scene))) {
    const std::size_t triangles = scene.triangles.size();
    if (triangles > 0) {
        static_assert(sizeof(vec3) == 12 && sizeof(uvec3) == 12);
        RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices       = static_cast<vec3*>(rtcSetNewGeometryBuffer(
                  geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), scene.positions.size()));
        auto* indices        = static_cast<uvec3*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(uvec3), triangles));
        if (vertices && indices) {
            std::transform(scene.positions.begin(), scene.positions.end(), vertices,
                           [&](vec3 p) { return space_.point(p); });
            std::copy(scene.triangles.begin(), scene.triangles.end(), indices);
            rtcSetGeometryOccludedFilterFunction(geometry, skip_own_triangle);
            rtcCommitGeometry(geometry);
            rtcAttachGeometryByID(impl_->scene, geometry, 0);
        }
        rtcReleaseGeometry(geometry);
    }
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitScene(impl_->scene);
    if (const RTCError error = rtcGetDeviceError(impl_->device); error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree cannot build its scene, error " + std::to_string(static_cast<int>(error)));
}

RayScene::~RayScene()                              = default;
RayScene::RayScene(RayScene&&) noexcept            = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::size_t RayScene::memory_bytes() const {
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, impl_->bytes));
}

void RayScene::occluded(const int (&valid)[8], ShadowPacket& rays) const {
    static_assert(sizeof(ShadowPacket) == sizeof(RTCRay8) && alignof(ShadowPacket) == alignof(RTCRay8));
    static_assert(offsetof(ShadowPacket, tfar) == offsetof(RTCRay8, tfar) &&
                  offsetof(ShadowPacket, id) == offsetof(RTCRay8, id));
    occluded_incoherent(impl_->scene, valid, reinterpret_cast<RTCRay8&>(rays));
}

// ---- the G-buffer ---------------------------------------------------------------------------------------------------

namespace {

constexpr int kTileWidth = 16, kTileHeight = 8;  // whole packets of 4 x 2 pixels

/// What the eye rays through one tile met.
struct TileHits {
    TriangleId triangle[kTileHeight][kTileWidth];
    float u[kTileHeight][kTileWidth], v[kTileHeight][kTileWidth];
};

/// Eye rays as the camera defines them, split into what varies with the column and with the row.
struct EyeRays {
    Projection projection;
    dvec3 forward;
    vec3 origin{0};                  ///< perspective: the eye, in ray space
    dvec3 window_origin;             ///< orthographic: the eye, in ray space
    std::vector<dvec3> column, row;  ///< offsets along right and along -up; ray space lengths where orthographic

    EyeRays(const CameraFrame& f, const RaySpace& space)
        : projection(f.projection), forward(f.forward), origin(space.point(f.eye)) {
        const bool window  = projection == Projection::orthographic;
        const double scale = window ? static_cast<double>(space.scale) : 1.0;
        window_origin      = (f.eye - dvec3(space.centre)) * static_cast<double>(space.scale);
        // Beyond the right and bottom edge up to whole packets; those lanes are not traced.
        for (int x = 0; x < f.width + kTileWidth; ++x)
            column.push_back(f.half_width * (2 * (x + 0.5) / f.width - 1) * f.right * scale);
        for (int y = 0; y < f.height + kTileHeight; ++y)
            row.push_back(f.half_height * (2 * (y + 0.5) / f.height - 1) * f.up * scale);
    }

    void fill(RTCRay8& ray, int x0, int y0) const {
        for (int k = 0; k < 8; ++k) {
            const dvec3 across = column[x0 + (k & 3)] - row[y0 + (k >> 2)];
            const bool window  = projection == Projection::orthographic;
            const vec3 o       = window ? vec3(window_origin + across) : origin;
            const vec3 d       = vec3(window ? forward : forward + across);
            ray.org_x[k] = o.x, ray.org_y[k] = o.y, ray.org_z[k] = o.z;
            ray.dir_x[k] = d.x, ray.dir_y[k] = d.y, ray.dir_z[k] = d.z;
            ray.tfar[k] = kInfinity;
        }
    }
};

void trace_tile(RTCScene scene, const EyeRays& eye, int x0, int y0, int width, int height, TileHits& hits) {
    const FlushDenormals flush;
    RTCRayHit8 rays{};
    std::fill_n(rays.ray.mask, 8, ~0u);
    for (int y = y0; y < std::min(y0 + kTileHeight, height); y += 2) {
        for (int x = x0; x < std::min(x0 + kTileWidth, width); x += 4) {
            alignas(32) int valid[8];
            for (int k = 0; k < 8; ++k) valid[k] = x + (k & 3) < width && y + (k >> 2) < height ? -1 : 0;
            eye.fill(rays.ray, x, y);
            std::fill_n(rays.hit.geomID, 8, RTC_INVALID_GEOMETRY_ID);
            intersect_coherent(scene, valid, rays);
            for (int k = 0; k < 8; ++k) {
                const int row = y - y0 + (k >> 2), column = x - x0 + (k & 3);
                hits.triangle[row][column] =
                    rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? kNoTriangle : rays.hit.primID[k];
                hits.u[row][column] = rays.hit.u[k];
                hits.v[row][column] = rays.hit.v[k];
            }
        }
    }
}

}  // namespace

PointBatch primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width, int height) {
    PointBatch batch;
    batch.raster = frame(camera, width, height);
    batch.eye    = camera.eye;
    batch.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));

    const EyeRays eye(*batch.raster, rays.space());
    const int across = (width + kTileWidth - 1) / kTileWidth, down = (height + kTileHeight - 1) / kTileHeight;
    parallel_ranges(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 8,
                    [&](std::size_t begin, std::size_t end) {
                        TileHits hits;
                        for (std::size_t tile = begin; tile < end; ++tile) {
                            const int x0 = static_cast<int>(tile % across) * kTileWidth;
                            const int y0 = static_cast<int>(tile / across) * kTileHeight;
                            trace_tile(rays.impl().scene, eye, x0, y0, width, height, hits);
                            for (int y = y0; y < std::min(y0 + kTileHeight, height); ++y)
                                for (int x = x0; x < std::min(x0 + kTileWidth, width); ++x)
                                    if (const TriangleId t = hits.triangle[y - y0][x - x0]; t != kNoTriangle)
                                        set_point(batch, static_cast<std::size_t>(y) * width + x, scene, t,
                                                  hits.u[y - y0][x - x0], hits.v[y - y0][x - x0]);
                        }
                    });
    face_lights(batch, scene);
    return batch;
}

}  // namespace umbra
