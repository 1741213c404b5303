// The tree of rays: what eye rays meet, what the rays mirrored and refracted there meet, and so on. Geometry alone; the
// light that comes back along it is in whitted.h.
//
// This work is based on:
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
// Roy Hall, Donald Greenberg. A Testbed for Realistic Image Synthesis. 1983
// Robert Cook, Thomas Porter, Loren Carpenter. Distributed Ray Tracing. 1984 (rough mirrors)
// Robert Cook. Stochastic Sampling in Computer Graphics. 1986 (eye rays at random places)
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "umbra/bench/studies/light/bodies.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// How surfaces are drawn that let light through unbent: opacity below 1, and transmit 0.
enum class Transparency : std::uint8_t {
    blend,       ///< opacity of what they give by themselves and 1 - opacity of what is behind them
    screen_door  ///< of 16 neighbouring eye rays, 16 times opacity see the surface alone and the others what is behind
                 ///< it alone: the same rays for all surfaces, so that equal ones hide one another
};

/// Where eye rays pass through the pixels of a raster that has `side` x `side` of them for one pixel of the picture.
enum class EyePlaces : std::uint8_t {
    regular,   ///< the middle of each
    jittered,  ///< anywhere in each, evenly
    random     ///< anywhere in the pixel of the picture, evenly and independently
};
inline constexpr std::array kEyePlaces{EyePlaces::regular, EyePlaces::jittered, EyePlaces::random};
[[nodiscard]] constexpr std::string_view to_string(EyePlaces places) {
    constexpr std::array<std::string_view, 3> names{"regular", "jittered", "random"};
    return names[static_cast<std::size_t>(places)];
}
/// Of eye ray i, in pixels of the raster from its top left. The same every time.
[[nodiscard]] dvec2 eye_place(const CameraFrame& raster, EyePlaces places, int side, std::size_t i);

struct TreeOptions {
    int depth           = 5;      ///< rays on a path, the eye ray included; >= 1
    double least_weight = 0;      ///< a ray is not traced where the product of k_r and k_t on its path is below that
    bool everywhere     = false;  ///< a mirrored ray starts from every surface, also where its factor is 0, and rays
                                  ///< below least_weight are traced and count 0: the same picture with more rays
    Transparency transparency = Transparency::blend;
    bool glossy               = false;  ///< a mirrored ray is one of many of the material's lobe: the cosine of its
                                        ///< angle from the mirrored direction, to the power of the shininess. What it
                                        ///< brings is noise, which several eye rays a pixel average out
    EyePlaces eye_places = EyePlaces::regular;  ///< through which the eye rays were traced
    int side             = 1;                   ///< see EyePlaces
};

enum class RayKind : std::uint8_t {
    reflected,
    refracted  ///< or, through surfaces that do not bend light, continued
};

/// A ray that starts at a surface.
struct SecondaryRay {
    dvec3 direction{0};        ///< unit, world
    double factor        = 0;  ///< k_r or k_t of that surface: what the light that it brings is multiplied with
    double weight        = 0;  ///< product of the factors on the path from the eye
    std::uint32_t parent = 0;  ///< index of that surface's point one depth before
    RayKind kind         = RayKind::reflected;
};

/// Rays of one depth, and what became of them. Eye rays have depth 1.
struct RayCounts {
    std::uint64_t eye = 0, reflected = 0, refracted = 0;  ///< traced
    std::uint64_t met       = 0;                          ///< of these, met a surface; the others left the scene
    std::uint64_t shadow    = 0;  ///< pairs of such a point and a light in front of it: S_j is asked
    std::uint64_t total     = 0;  ///< points beyond the critical angle, where nothing is refracted
    std::uint64_t too_light = 0;  ///< rays from these points that were not traced: below least_weight
    std::uint64_t too_deep  = 0;  ///< the same: beyond the depth
    [[nodiscard]] std::uint64_t traced() const { return eye + reflected + refracted; }
};

/// Where a ray met a body by its formula, instead of one of the triangles that stand for it.
struct OnBody {
    std::uint32_t body = kNoBody;  ///< index into Bodies::list; kNoBody: it met a triangle, or nothing
    dvec3 position{0}, normal{0};  ///< world; the latter unit, on the side of the point's normal
};

/// All rays of one depth: ray i met points[i]; kNoTriangle: it left the scene.
struct RayLevel {
    PointBatch points;               ///< of the first level a raster; normals are on the side that the ray sees
    std::vector<OnBody> on_body;     ///< one a point; empty: no ray met a body by formula
    std::vector<SecondaryRay> rays;  ///< by parent, mirrored before refracted; empty at the first level
    std::vector<float> own;          ///< one a point: the share of what leaves it by itself that counts; empty: 1
    RayCounts counts;
};

struct RayTree {
    std::vector<RayLevel> levels;  ///< [depth - 1]; the last has rays
    EyePlaces eye_places = EyePlaces::regular;
    int side             = 1;
    double trace_ms      = 0;  ///< finding what secondary rays meet, and where on it
    double spawn_ms      = 0;  ///< finding where they go
    double face_ms       = 0;  ///< finding which lights are in front of these points
};

/// The tree over the points of a raster (primary_points, or the same at subpixels), faced to all lights.
///
/// From a surface with reflect > 0 starts a mirrored ray, with transmit > 0 one refracted by index_of_refraction: the
/// inside is the side against the winding, around every body is vacuum. Beyond the critical angle the mirrored ray has
/// the factor reflect + transmit, since nothing is lost there (Whitted drops the transmitted light). Through a surface
/// of opacity below 1 that has no transmit, the ray runs on as it came: see Transparency. Normals are interpolated;
/// where they would send a ray to the wrong side of its triangle, the triangle's own counts.
///
/// Parallel; the same bits for any number of threads. Throws InputError where a depth has more than 2^24 secondary
/// rays, std::logic_error for a batch without a raster.
[[nodiscard]] RayTree trace_rays(const RayScene& rays, const Scene& scene, PointBatch eye, const TreeOptions& options);

/// The same where `meet` finds what the rays of a level meet. It is called with a tree whose last level is `level` and
/// has rays, writes the points of that level, faced to all lights, and adds to the tree's times. `eye`: points alone,
/// or those on bodies too. Throws what `meet` throws.
using MeetRays = std::function<void(RayTree& tree, std::size_t level)>;
[[nodiscard]] RayTree trace_rays(const Scene& scene, RayLevel eye, const TreeOptions& options, const MeetRays& meet);

/// N of point i of a level, unit: as of its batch, or of the body that it is on.
[[nodiscard]] dvec3 shading_normal(const Scene& scene, const RayLevel& level, std::size_t i);

/// The points of the raster (a camera's frame), one ray at a time: with regular places as primary_points finds them, in
/// packets.
[[nodiscard]] PointBatch trace_eye_rays(const RayScene& rays, const Scene& scene, const CameraFrame& raster,
                                        EyePlaces places = EyePlaces::regular, int side = 1);

/// One ray, in world space.
struct Ray {
    dvec3 origin{0}, direction{0};                    ///< the latter unit
    TriangleId from = kNoTriangle;                    ///< on which it starts, and which it does not meet
    dvec3 normal{0};                                  ///< of that triangle, unit, any side
    double reach   = static_cast<double>(kInfinity);  ///< what is farther away is not met
    bool is_of_eye = false;                           ///< it passes through objects that the camera does not see
};
/// Ray i of a level after the first. One that starts on a body starts on no triangle.
[[nodiscard]] Ray secondary_ray(const Scene& scene, const RayTree& tree, std::size_t level, std::size_t i);

/// Writes point i < batch.size(): where a ray meets the plane of triangle t, with its normal on the side that the ray
/// sees. Writes nothing for kNoTriangle.
void set_met_point(PointBatch& batch, std::size_t i, const Scene& scene, TriangleId t, const Ray& ray);

/// The triangle that a ray meets first, kNoTriangle where it leaves the scene: by the tree of boxes, and by a test of
/// every triangle, in double. Both ignore what lies within the rounding of the start.
[[nodiscard]] TriangleId first_by_tree(const RayScene& rays, const Ray& ray);  ///< call under FlushDenormals
[[nodiscard]] TriangleId first_by_search(const RayScene& rays, const Scene& scene, const Ray& ray);

/// What lies nearer along the ray is within the rounding of its start.
[[nodiscard]] double least_distance(const RayScene& rays, const Ray& ray);

/// Distance from a ray's origin to the plane of a triangle, along the ray; not finite where it runs along the plane.
[[nodiscard]] double distance_to_plane(const Scene& scene, const Ray& ray, TriangleId t);

/// Direction of the ray that met point i of a level: unit, world.
[[nodiscard]] dvec3 incoming(const RayTree& tree, std::size_t level, std::size_t i);

/// How many rays each eye ray's tree has, the eye ray included.
[[nodiscard]] std::vector<std::uint32_t> rays_by_eye_ray(const RayTree& tree);

}  // namespace umbra
