#include "umbra/core/render/gbuffer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/embree_api.h"
#include "umbra/core/render/seen_side.h"

namespace umbra {
namespace {

constexpr int kTileWidth = 16, kTileHeight = 8;  // whole packets of 4 x 2 pixels

/// What eight eye rays met, as 4 x 2 pixels.
struct Hits8 {
    TriangleId triangle[8];
    float u[8], v[8];                  ///< as Embree has them: their last bits depend on the processor
    double origin[3][8], along[3][8];  ///< the rays, in world space
};

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

/// Eye rays as the camera defines them, split into what varies with the column and with the row of the raster.
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

    /// What all packets have alike: the eye, or the direction of an orthographic view.
    void start(RTCRay8& ray) const {
        fill(window_ ? forward_ : eye_, window_ ? ray.dir_x : ray.org_x, window_ ? ray.dir_y : ray.org_y,
             window_ ? ray.dir_z : ray.org_z);
        std::fill_n(ray.mask, 8, ~0u);
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
    dvec3 still_{0};   ///< what all rays have alike, in ray space: the eye, or the direction of an orthographic view
    dvec3 middle_{0};  ///< perspective: forward; orthographic: the eye, in ray space
    std::vector<double> column_[3];
    std::vector<dvec3> row_;
};

using TileHits = Hits8[kTileHeight / 2][kTileWidth / 4];

void trace_tile(RTCScene scene, const EyeRays& eye, int x0, int y0, int width, int height, TileHits& hits) {
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

/// Where eight rays meet the planes of the triangles that Embree named, in double and so alike on all processors, and
/// what set_point makes of that, to the same bits: all but the loads are loops over lanes. Leaves to set_point what
/// needs a second look: barycentrics at or over an edge, slivers, triangles that the eye sees edge-on.
class PointWriter {
public:
    PointWriter(const Scene& scene, PointBatch& batch) : scene_(scene), batch_(batch) {
        window_ = batch.raster->projection == Projection::orthographic;
        for (const Material& m : scene.materials) all_two_sided_ &= m.two_sided;
    }

    /// Pixels (x .. x+3, y .. y+1), those inside the raster.
    void write(const Hits8& hits, int x, int y) const {
        const CameraFrame& frame = *batch_.raster;
        Points8 points;
        place(hits, points);
        for (int row = 0; row < std::min(2, frame.height - y); ++row) {
            const int count     = std::min(4, frame.width - x);
            const std::size_t i = static_cast<std::size_t>(y + row) * frame.width + x;
            if (count == 4)
                store(points, 4 * row, i, 4);
            else
                store(points, 4 * row, i, count);
            for (int k = 4 * row; k < 4 * row + count; ++k)
                if (hits.triangle[k] != kNoTriangle && !points.done[k]) {
                    const bool known = std::isfinite(points.u[k]) && std::isfinite(points.v[k]);
                    set_point(batch_, i + (k & 3), scene_, hits.triangle[k], known ? points.u[k] : hits.u[k],
                              known ? points.v[k] : hits.v[k]);
                }
        }
    }

private:
    struct Points8 {
        TriangleId triangle[8];
        float u[8], v[8], px[8], py[8], pz[8], nx[8], ny[8], nz[8];
        std::uint8_t flipped[8], done[8];
    };

    /// Triangles (a, a + b, a + c) of eight hits, and what follows from them alone.
    struct Triangles8 {
        double a[3][8], b[3][8], c[3][8];
        double n[3][8], length[8];  ///< cross(b, c) and its length
        double sides[8], reach[8];  ///< see keeps_sign
        double two_sided[8];
    };

    void load(const TriangleId* triangles, int count, Triangles8& to) const {
        const double eye_reach = sum_of_magnitudes(to_eye());
        for (int k = 0; k < count; ++k) {
            const TriangleId t = triangles[k];
            if (t == kNoTriangle) {
                for (int d = 0; d < 3; ++d) to.a[d][k] = to.b[d][k] = to.c[d][k] = 0;
                to.two_sided[k] = 1;
                continue;
            }
            const uvec3& corner = scene_.triangles[t];
            const vec3 &p = scene_.positions[corner.x], &q = scene_.positions[corner.y],
                       &r = scene_.positions[corner.z];  // references: copies would pass through the stack
            for (int d = 0; d < 3; ++d) {
                to.a[d][k] = static_cast<double>(p[d]);
                to.b[d][k] = static_cast<double>(q[d]), to.c[d][k] = static_cast<double>(r[d]);
            }
            const auto both = [&] { return scene_.material(t).two_sided; };
            to.two_sided[k] = all_two_sided_ || both() ? 1 : 0;
        }
        for (int k = 0; k < count; ++k) {
            for (int d = 0; d < 3; ++d) to.b[d][k] -= to.a[d][k], to.c[d][k] -= to.a[d][k];
            const double bx = to.b[0][k], by = to.b[1][k], bz = to.b[2][k];
            const double cx = to.c[0][k], cy = to.c[1][k], cz = to.c[2][k];
            const double nx = by * cz - cy * bz, ny = bz * cx - cz * bx, nz = bx * cy - cx * by;
            to.n[0][k] = nx, to.n[1][k] = ny, to.n[2][k] = nz;
            to.length[k] = std::sqrt(nx * nx + ny * ny + nz * nz);
            to.sides[k]  = sum_of_magnitudes(bx, by, bz) * sum_of_magnitudes(cx, cy, cz);
            to.reach[k]  = eye_reach + sum_of_magnitudes(to.a[0][k], to.a[1][k], to.a[2][k]);
        }
    }

    /// Neighbouring pixels mostly see the same triangle.
    void load(const TriangleId (&triangles)[8], Triangles8& to) const {
        const bool same = std::all_of(triangles, triangles + 8, [&](TriangleId t) { return t == triangles[0]; });
        load(triangles, same ? 1 : 8, to);
        if (!same) return;
        const auto spread = [](double(&lanes)[8]) { std::fill_n(lanes + 1, 7, lanes[0]); };
        for (auto* vector : {&to.a, &to.b, &to.c, &to.n})
            for (auto& lanes : *vector) spread(lanes);
        spread(to.length), spread(to.sides), spread(to.reach), spread(to.two_sided);
    }

    /// The eye, or against an orthographic view.
    [[nodiscard]] dvec3 to_eye() const { return window_ ? -batch_.raster->forward : dvec3(batch_.eye); }

    void place(const Hits8& hits, Points8& out) const {
        std::copy_n(hits.triangle, 8, out.triangle);
        if (std::all_of(hits.triangle, hits.triangle + 8, [](TriangleId t) { return t == kNoTriangle; })) {
            for (float* plane : {out.u, out.v, out.px, out.py, out.pz, out.nx, out.ny, out.nz})
                std::fill_n(plane, 8, 0.0f);
            std::fill_n(out.flipped, 8, std::uint8_t{0});
            return;
        }
        Triangles8 t;
        load(hits.triangle, t);
        const double pull = window_ ? 0 : 1;  // to the eye: eye - p, or against an orthographic view
        const dvec3 eye   = to_eye();
        double towards[8];
        for (int k = 0; k < 8; ++k) {
            const double ax = t.a[0][k], ay = t.a[1][k], az = t.a[2][k], bx = t.b[0][k], by = t.b[1][k], bz = t.b[2][k],
                         cx = t.c[0][k], cy = t.c[1][k], cz = t.c[2][k], nx = t.n[0][k], ny = t.n[1][k], nz = t.n[2][k];
            // The ray o + t d meets a + u b + v c. [Tomas Moeller, Ben Trumbore, 1997]
            const double dx = hits.along[0][k], dy = hits.along[1][k], dz = hits.along[2][k];
            const double sx = hits.origin[0][k] - ax, sy = hits.origin[1][k] - ay, sz = hits.origin[2][k] - az;
            const double mx = sy * dz - dy * sz, my = sz * dx - dz * sx, mz = sx * dy - dx * sy;
            const double over = -1 / (nx * dx + ny * dy + nz * dz);
            out.u[k]          = static_cast<float>((mx * cx + my * cy + mz * cz) * over);
            out.v[k]          = static_cast<float>((mx * bx + my * by + mz * bz) * -over);
            const double u = static_cast<double>(out.u[k]), v = static_cast<double>(out.v[k]);
            const double px = ax + u * bx + v * cx, py = ay + u * by + v * cy, pz = az + u * bz + v * cz;
            const double ex = eye.x - pull * px, ey = eye.y - pull * py, ez = eye.z - pull * pz;
            towards[k]          = (nx * ex + ny * ey + nz * ez) * t.two_sided[k];
            const double factor = (towards[k] < 0 ? -1.0 : 1.0) / t.length[k];
            out.px[k] = static_cast<float>(px), out.py[k] = static_cast<float>(py), out.pz[k] = static_cast<float>(pz);
            out.nx[k] = static_cast<float>(nx * factor);
            out.ny[k] = static_cast<float>(ny * factor);
            out.nz[k] = static_cast<float>(nz * factor);
        }
        for (int k = 0; k < 8; ++k) {
            const double sum = static_cast<double>(out.u[k]) + static_cast<double>(out.v[k]);
            out.flipped[k]   = towards[k] < 0;
            const bool sure  = keeps_sign(towards[k], t.sides[k], t.reach[k]) | (t.two_sided[k] == 0);
            out.done[k] =
                (out.u[k] >= 0) & (out.v[k] >= 0) & (sum < 1) & keeps_direction(t.length[k], t.sides[k]) & sure;
        }
        for (int k = 0; k < 8; ++k) {
            if (hits.triangle[k] != kNoTriangle) continue;
            out.u[k] = out.v[k] = out.px[k] = out.py[k] = out.pz[k] = out.nx[k] = out.ny[k] = out.nz[k] = 0;
            out.flipped[k]                                                                              = 0;
        }
    }

    void store(const Points8& points, int lane, std::size_t i, int count) const {
        std::copy_n(points.triangle + lane, count, batch_.triangle.data() + i);
        std::copy_n(points.u + lane, count, batch_.u.data() + i);
        std::copy_n(points.v + lane, count, batch_.v.data() + i);
        std::copy_n(points.px + lane, count, batch_.px.data() + i);
        std::copy_n(points.py + lane, count, batch_.py.data() + i);
        std::copy_n(points.pz + lane, count, batch_.pz.data() + i);
        std::copy_n(points.nx + lane, count, batch_.nx.data() + i);
        std::copy_n(points.ny + lane, count, batch_.ny.data() + i);
        std::copy_n(points.nz + lane, count, batch_.nz.data() + i);
        std::copy_n(points.flipped + lane, count, batch_.flipped.data() + i);
    }

    const Scene& scene_;
    PointBatch& batch_;
    bool window_        = false;
    bool all_two_sided_ = true;
};

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
    const int across = (width + kTileWidth - 1) / kTileWidth, down = (height + kTileHeight - 1) / kTileHeight;
    const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    parallel_ranges(tiles, 8, [&](std::size_t begin, std::size_t end) {
        TileHits hits;
        for (std::size_t tile = begin; tile < end; ++tile) {
            const int x0 = static_cast<int>(tile % across) * kTileWidth;
            const int y0 = static_cast<int>(tile / across) * kTileHeight;
            trace_tile(rays.impl().scene, eye, x0, y0, width, height, hits);
            for (int y = y0; y < std::min(y0 + kTileHeight, height); y += 2)
                for (int x = x0; x < std::min(x0 + kTileWidth, width); x += 4)
                    writer.write(hits[(y - y0) / 2][(x - x0) / 4], x, y);
        }
    });
    face_lights(batch, scene);
}

PointBatch primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width, int height) {
    PointBatch batch;
    primary_points(rays, scene, camera, width, height, batch);
    return batch;
}

}  // namespace umbra
