#include "umbra/core/render/gbuffer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/lanes.h"
#include "umbra/core/render/embree_api.h"
#include "umbra/core/render/point_writer.h"
#include "umbra/core/render/tiles.h"

namespace umbra {
namespace {

// Tiles are whole packets of 4 x 2 pixels.
constexpr int kTileWidth = PointTile::kWidth, kTileHeight = PointTile::kHeight;

// In ray space the scene is about 1 wide and lies within kScene of the origin. Eye rays that begin farther than kFar
// away, where floats are coarse, are moved along themselves to the scene; beyond kFarthest doubles cannot tell any more
// where in the scene, or whether, a ray passes it.
constexpr double kScene = 4, kFar = 0x1p20, kFarthest = 0x1p52;

/// The largest distance from the origin of ray space at which eye rays of the raster begin.
double farthest_start(const CameraFrame& f, const RaySpace& space) {
    const double scale  = static_cast<double>(space.scale);
    const double window = f.projection == Projection::orthographic ? std::hypot(f.half_width, f.half_height) : 0;
    return (glm::length(f.eye - dvec3(space.centre)) + window) * scale;
}

/// Eye rays as the camera defines them, split into terms that vary with the column and with the row of the raster.
class EyeRays {
public:
    EyeRays(const CameraFrame& f, const RaySpace& space)
        : window_(f.projection == Projection::orthographic),
          far_(farthest_start(f, space) > kFar),
          eye_(space.point(f.eye)),
          forward_(f.forward),
          world_eye_(f.eye),
          centre_(space.centre),
          unit_(1 / static_cast<double>(space.scale)) {
        const double scale = static_cast<double>(space.scale);
        still_             = window_ ? f.forward : (f.eye - dvec3(space.centre)) * scale;
        middle_            = window_ ? (f.eye - dvec3(space.centre)) * scale : f.forward;
        // Beyond the right and bottom edge up to whole packets; those lanes are not traced.
        for (int x = 0; x < f.width + kTileWidth; ++x) {
            const dvec3 offset = f.half_width * (2 * (x + 0.5) / f.width - 1) * f.right * (window_ ? scale : 1);
            for (int d = 0; d < 3; ++d) column_[d].push_back(offset[d]);
        }
        for (int y = 0; y < f.height + kTileHeight; ++y)
            row_.push_back(f.half_height * (2 * (y + 0.5) / f.height - 1) * f.up * (window_ ? scale : 1));
    }

    /// Sets the part that all packets have in common: the eye, or the direction of an orthographic view.
    void start(RTCRay8& ray) const {
        fill(window_ ? forward_ : eye_, window_ ? ray.dir_x : ray.org_x, window_ ? ray.dir_y : ray.org_y,
             window_ ? ray.dir_z : ray.org_z);
        std::fill_n(ray.mask, 8, kEyeRay);
    }

    /// Clears `valid` of rays that pass far from the scene. `hits` gets the rays in double.
    void aim(RTCRay8& ray, int x, int y, int* valid, Hits8& hits) const {
        if (far_) return aim_from_afar(ray, x, y, valid, hits);
        float* to[3] = {window_ ? ray.org_x : ray.dir_x, window_ ? ray.org_y : ray.dir_y,
                        window_ ? ray.org_z : ray.dir_z};
        for (int d = 0; d < 3; ++d) {
            double moving[8];
            lanes(d, x, y, moving);
            for (int k = 0; k < 8; ++k) {
                to[d][k]          = static_cast<float>(moving[k]);
                hits.origin[d][k] = window_ ? moving[k] * unit_ + centre_[d] : world_eye_[d];
                hits.along[d][k]  = window_ ? still_[d] : moving[k];
            }
        }
        std::fill_n(ray.tfar, 8, kInfinity);
    }

private:
    static void fill(vec3 v, float* x, float* y, float* z) {
        std::fill_n(x, 8, v.x), std::fill_n(y, 8, v.y), std::fill_n(z, 8, v.z);
    }
    void lanes(int d, int x, int y, double* to) const {
        const double* column = column_[d].data() + x;
        for (int r = 0; r < 2; ++r)
            for (int k = 0; k < 4; ++k) to[4 * r + k] = middle_[d] + (column[k] - row_[y + r][d]);
    }

    void aim_from_afar(RTCRay8& ray, int x, int y, int* valid, Hits8& hits) const {
        for (int k = 0; k < 8; ++k) {
            const int column = x + k % 4, row = y + k / 4;
            dvec3 moving;
            for (int d = 0; d < 3; ++d) moving[d] = middle_[d] + (column_[d][column] - row_[row][d]);
            const dvec3 direction = window_ ? still_ : moving, eye = window_ ? moving : still_;
            // From the place nearest to the origin of ray space, which is in the scene, back until before the scene.
            const double nearest = -glm::dot(eye, direction) / glm::dot(direction, direction);
            const dvec3 place    = eye + nearest * direction;
            const double start   = std::max(0.0, nearest - 2 * kScene / glm::length(direction));
            const dvec3 origin   = eye + start * direction;
            if (!(glm::length(place) < kScene && glm::length(origin) < 4 * kScene)) valid[k] = 0;
            const vec3 o(valid[k] != 0 ? origin : dvec3(0)), r(direction);
            ray.org_x[k] = o.x, ray.org_y[k] = o.y, ray.org_z[k] = o.z;
            ray.dir_x[k] = r.x, ray.dir_y[k] = r.y, ray.dir_z[k] = r.z;
            for (int d = 0; d < 3; ++d) {
                hits.origin[d][k] = origin[d] * unit_ + centre_[d];
                hits.along[d][k]  = direction[d];
            }
        }
        std::fill_n(ray.tfar, 8, kInfinity);
    }

    bool window_, far_;
    vec3 eye_, forward_;
    dvec3 world_eye_, centre_;
    double unit_;      ///< of ray space, in world space
    dvec3 still_{0};   ///< common to all rays, in ray space: the eye, or the direction of an orthographic view
    dvec3 middle_{0};  ///< perspective: forward; orthographic: the eye, in ray space
    std::vector<double> column_[3];
    std::vector<dvec3> row_;
};

using TileHits = Hits8[kTileHeight / 2][kTileWidth / 4];

UMBRA_FOR_EACH_PROCESSOR void trace_tile(RTCScene scene, const EyeRays& eye, int x0, int y0, int width, int height,
                                         TileHits& hits) {
    const FlushDenormals flush;
    RTCRayHit8 rays{};
    eye.start(rays.ray);
    for (int y = y0; y < std::min(y0 + kTileHeight, height); y += 2) {
        for (int x = x0; x < std::min(x0 + kTileWidth, width); x += 4) {
            alignas(32) int valid[8];
            for (int k = 0; k < 8; ++k) valid[k] = x + (k & 3) < width && y + (k >> 2) < height ? -1 : 0;
            Hits8& hit = hits[(y - y0) / 2][(x - x0) / 4];
            eye.aim(rays.ray, x, y, valid, hit);
            std::fill_n(rays.hit.geomID, 8, RTC_INVALID_GEOMETRY_ID);
            intersect_coherent(scene, valid, rays);
            for (int k = 0; k < 8; ++k)
                hit.triangle[k] = rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? kNoTriangle : rays.hit.primID[k];
            std::copy_n(rays.hit.u, 8, hit.u);
            std::copy_n(rays.hit.v, 8, hit.v);
        }
    }
}

double widest(const Box& box) {
    const dvec3 size = dvec3(box.max) - dvec3(box.min);
    return std::max({size.x, size.y, size.z});
}

/// Throws InputError where eye rays cannot be placed in the scene.
void check_reach(const CameraFrame& frame, const RaySpace& space, const Scene& scene) {
    if (!(farthest_start(frame, space) > kFarthest)) return;
    const Box box = bounds(scene);
    if (box.empty() || box.min == box.max) return;  // nothing has an area, so nothing is seen
    const std::string_view what = frame.projection == Projection::perspective ? "the eye is" : "eye or window reach";
    throw InputError(
        fmt::format("{}: camera: {} {:.2g} from the scene, which is {:.2g} wide: beyond {:.1g} times that, "
                    "rounding decides what a pixel sees",
                    scene.source.empty() ? scene.name : scene.source, what,
                    farthest_start(frame, space) / static_cast<double>(space.scale), widest(box), kFarthest / 2));
}

}  // namespace

void primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width, int height,
                    PointBatch& batch) {
    batch.raster = frame(camera, width, height);
    batch.eye    = camera.eye;
    batch.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    check_reach(*batch.raster, rays.space(), scene);
    const EyeRays eye(*batch.raster, rays.space());
    const PointWriter writer(scene, batch);
    for_each_tile(batch, [&](const PointTile& tile) {
        TileHits hits;
        writer.claim(tile);
        const int x0 = static_cast<int>(tile.x0), y0 = static_cast<int>(tile.y0);
        trace_tile(rays.impl().scene, eye, x0, y0, width, height, hits);
        bool faced = true;
        for (int y = y0; y < std::min(y0 + kTileHeight, height); y += 2)
            for (int x = x0; x < std::min(x0 + kTileWidth, width); x += 4)
                faced &= writer.write(hits[(y - y0) / 2][(x - x0) / 4], x, y);
        if (!faced) writer.face_open_points(tile);
    });
}

PointBatch primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width, int height) {
    PointBatch batch;
    primary_points(rays, scene, camera, width, height, batch);
    return batch;
}

}  // namespace umbra
