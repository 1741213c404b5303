// Ray-traced shadows: a ray from the surface point to the light asks whether anything lies between; an area light is
// asked at many of its points.
//
// This work is based on:
// Arthur Appel. Some Techniques for Shading Machine Renderings of Solids. 1968
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
// Robert Cook, Thomas Porter, Loren Carpenter. Distributed Ray Tracing. 1984
// Carsten Waechter, Nikolaus Binder. A Fast and Robust Method for Avoiding Self-Intersection. 2019
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/light_points.h"

namespace umbra {
namespace {

/// How a shadow ray keeps from hitting the surface that it starts on.
enum class OffsetPolicy : std::uint8_t {
    skip_triangle,   ///< starts at the point; its own triangle, by id, is no hit, nor is what lies within the point's
                     ///< rounding
    integer_offset,  ///< moves the start along the normal by a few float steps
                     ///< [Carsten Waechter, Nikolaus Binder, A Fast and Robust Method for Avoiding Self-Intersection,
                     ///< 2019]
    epsilon          ///< starts at a constant distance (a share of the scene's diagonal) along the normal
};

struct Options {
    OffsetPolicy offset = OffsetPolicy::skip_triangle;
    double epsilon      = 1e-4;
    int samples         = 16;
    Sampler sampler     = Sampler::sobol;
    int seed            = 0;
    Measure measure     = Measure::area;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::offset>({.name    = "offset",
                                 .doc     = "How a ray keeps from hitting the surface that it starts on.",
                                 .phase   = Phase::visibility,
                                 .choices = "skip_triangle|integer_offset|epsilon"}),
    parameter<&Options::epsilon>({.name  = "epsilon",
                                  .doc   = "offset=epsilon: distance along the normal at which a ray starts.",
                                  .unit  = "scene diagonals",
                                  .phase = Phase::visibility,
                                  .min   = 0,
                                  .max   = 1}),
    parameter<&Options::samples>({.name  = "samples",
                                  .doc   = "Rays from a point to an area light; other lights take one.",
                                  .unit  = "rays a point",
                                  .phase = Phase::aim,
                                  .min   = 1,
                                  .max   = 65536,
                                  .sweep = "1|4|16|64|256"}),
    parameter<&Options::sampler>({.name    = "sampler",
                                  .doc     = "How the samples of an area light are spread; sobol is Owen-scrambled.",
                                  .phase   = Phase::aim,
                                  .choices = kSamplers,
                                  .sweep   = "random|stratified|sobol"}),
    parameter<&Options::seed>({.name  = "seed",
                               .doc   = "Picks the samples; equal seeds give equal bits.",
                               .phase = Phase::aim,
                               .min   = 0,
                               .max   = 2147483647}),
    parameter<&Options::measure>({.name = "measure",
                                  .doc  = "Which fraction of an area light S_j is. area: of its area; irradiance: each "
                                          "sample counts by the irradiance it sends, as in most renderers.",
                                  .phase   = Phase::visibility,
                                  .choices = "area|irradiance"}),
};

/// Rays end this fraction of the segment to the light before it, so that triangles on which the light lies, as those of
/// its own shape, do not block it. 256 float steps: enough for incidence down to about a degree. Triangles in that last
/// part before a hard light that do not touch it are tested apart.
constexpr double kUntraced = 0x1p-16;
constexpr float kTraced    = 1 - 0x1p-16f;

/// A triangle near a hard light, in the part of some segment to it that rays do not trace: its corners less the light's
/// position, which is exact in double for any two floats within 2^29 of each other, and the side of its plane that the
/// light is on.
struct NearLight {
    TriangleId triangle = kNoTriangle;
    dvec3 a{0}, b{0}, c{0};
    int light_side = 0;
};

/// The squared distance from the origin to a triangle, from below: to its box.
double squared_distance(const NearLight& t) {
    const dvec3 low = glm::min(glm::min(t.a, t.b), t.c), high = glm::max(glm::max(t.a, t.b), t.c);
    const dvec3 gap = glm::max(glm::max(low, -high), dvec3(0));
    return glm::dot(gap, gap);
}

/// The triangles in the untraced part of some segment to the light. Those whose plane holds the light, as those of its
/// own shape, are not among them: a segment that ends in a plane does not pass through it.
std::vector<NearLight> near_light(const Scene& scene, vec3 light) {
    const Box box          = bounds(scene);
    const dvec3 farthest   = glm::max(glm::abs(dvec3(box.min) - dvec3(light)), glm::abs(dvec3(box.max) - dvec3(light)));
    const double untraced2 = kUntraced * kUntraced * glm::dot(farthest, farthest);
    std::vector<NearLight> near;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
        NearLight n{t, dvec3(a) - dvec3(light), dvec3(b) - dvec3(light), dvec3(c) - dvec3(light), 0};
        if (squared_distance(n) > untraced2) continue;
        n.light_side = side_of_plane(a, b, c, light);
        if (n.light_side != 0) near.push_back(n);
    }
    return near;
}

/// Whether the segment from the light to `p` (less the light's position) passes through the triangle.
bool passes_through(const NearLight& t, dvec3 p) {
    const dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    if (glm::dot(normal, p - t.a) * t.light_side >= 0) return false;  // both ends on one side
    const double ab = glm::dot(glm::cross(t.a, t.b), p), bc = glm::dot(glm::cross(t.b, t.c), p),
                 ca = glm::dot(glm::cross(t.c, t.a), p);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// The light in ray space. Rays to a light whose farthest point is at distance D run in units of `unit`, a power of two
/// near D where D is far beyond the scene and 1 else, so that nothing over- or underflows.
struct Target {
    LightKind kind = LightKind::point;
    double unit    = 1;
    float per_unit = 1;         ///< 1 / unit; 0 where the scene is a point for the light
    float reach    = kTraced;   ///< tfar: where rays end, in ray space
    vec3 centre{0};             ///< in units; directional: the unit vector to the light
    vec3 axis_u{0}, axis_v{0};  ///< in units: rectangle: half edges; disk: perpendicular radii
    dvec3 sphere{0};            ///< sphere: centre and radius, not in units
    double radius = 0;
};

Target make_target(const Light& light, const RaySpace& space) {
    Target target;
    target.kind = light.kind;
    if (light.kind == LightKind::directional) {
        target.centre = vec3(-glm::normalize(dvec3(light.direction)));
        return target;
    }
    const double scale = space.scale;
    const dvec3 centre = (dvec3(light.position) - dvec3(space.centre)) * scale;
    DiskAxes axes{dvec3(light.edge_u) * 0.5, dvec3(light.edge_v) * 0.5};
    if (light.kind == LightKind::disk) axes = disk_axes(light);
    double farthest = glm::length(centre);
    if (light.kind == LightKind::rectangle || light.kind == LightKind::disk)
        farthest = std::max({farthest, glm::length(axes.u) * scale, glm::length(axes.v) * scale});
    if (farthest > 0x1p20) target.unit = std::exp2(std::floor(std::log2(farthest)));
    target.per_unit = static_cast<float>(1 / target.unit);
    target.reach    = kTraced * static_cast<float>(std::min(target.unit, 0x1p100));
    target.centre   = vec3(centre / target.unit);
    target.sphere   = centre;
    target.radius   = static_cast<double>(light.radius) * scale;
    target.axis_u   = vec3(axes.u * (scale / target.unit));
    target.axis_v   = vec3(axes.v * (scale / target.unit));
    return target;
}

/// Where the rays of up to eight points start, in ray space.
struct Starts {
    float x[8]{}, y[8]{}, z[8]{};
    float nx[8]{}, ny[8]{}, nz[8]{};
    float height[8]{};  ///< what the ray meets before it has risen so far above the point's plane is no hit
    TriangleId id[8]{};
};

/// Lane `lane` as lane 0; the other lanes are zero.
Starts lane_alone(const Starts& starts, int lane) {
    Starts alone;
    for (const auto member :
         {&Starts::x, &Starts::y, &Starts::z, &Starts::nx, &Starts::ny, &Starts::nz, &Starts::height})
        (alone.*member)[0] = (starts.*member)[lane];
    alone.id[0] = starts.id[lane];
    return alone;
}

/// Whether any of `count` points asks for S_j, by their facing.
bool any_asks(const Facing* facing, std::size_t count) {
    return std::any_of(facing, facing + count, [](Facing f) { return f >= Facing::partly; });
}

/// Moves p along n by float steps, which grow with the distance from the origin as the rounding of p does, or by a
/// constant close to the origin, where they would vanish.
vec3 integer_offset(vec3 p, vec3 n) {
    constexpr float near = 1 / 32.0f, constant = 1 / 65536.0f, steps = 256;
    for (int k = 0; k < 3; ++k) {
        const auto step = static_cast<std::int32_t>(steps * n[k]);
        const auto bits = std::bit_cast<std::int32_t>(p[k]);
        p[k] = std::abs(p[k]) < near ? p[k] + constant * n[k] : std::bit_cast<float>(bits + (p[k] < 0 ? -step : step));
    }
    return p;
}

class RayTraced final : public MethodWith<Options> {
public:
    [[nodiscard]] Measure measures() const override { return options.measure; }

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only)
            return {How::approximately, fmt::format("area lights are sampled, {} rays a point", options.samples)};
        if (options.offset != OffsetPolicy::skip_triangle)
            return {How::approximately, "rays start off the surface, so that contact shadows move"};
        // Compared with `exact`, one point in a hundred thousand is wrong where two bodies pass through each other: its
        // ray starts, in float, on the wrong side of the other surface.
        return {How::approximately,
                "one ray in float arithmetic decides each point: correct except for rounding at creases"};
    }

    void build(const Scene& scene, const SceneFacts&) override {
        scene_    = &scene;
        diagonal_ = bounds(scene).diagonal();
        rays_.emplace(scene);
    }

    void aim(LightId light) override {
        target_     = make_target(scene_->lights[light], rays_->space());
        near_light_ = find_near_light(light);
        set_.emplace(options.sampler, is_area(target_.kind) ? options.samples : 1,
                     static_cast<std::uint32_t>(options.seed) + 0x9e3779b9u * light);
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override;

    /// What the ray to the light meets first; of an area light, the first ray that meets anything. Samples are
    /// keyed by the point's index in the batch, so that these rays differ from those of visibility, and are as good.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override;

    [[nodiscard]] std::size_t memory_bytes() const override {
        return (rays_ ? rays_->memory_bytes() : 0) + (set_ ? set_->memory_bytes() : 0) +
               near_light_.capacity() * sizeof(NearLight);
    }

private:
    [[nodiscard]] std::vector<NearLight> find_near_light(LightId light) const;
    [[nodiscard]] vec3 exact_start(const PointBatch& points, std::size_t i) const;
    [[nodiscard]] TriangleId blocker_near_light(const PointBatch& points, LightId light, std::size_t i) const;
    void load_starts(const PointBatch& points, std::size_t first, std::size_t count, Starts& starts) const;
    std::size_t hard_light_rays(const Starts& starts, const Facing* facing, std::size_t count, ShadowRay* rays) const;
    void trace_hard_light(const PointBatch& points, LightId light, const PointTile& tile, std::span<float> s) const;
    template <class Body>
    bool for_each_packet(const Starts& starts, int lane, PointKey key, const Body& body) const;
    [[nodiscard]] float visible_irradiance(const Starts& starts, int lane, PointKey key) const;
    [[nodiscard]] float visible_fraction(const Starts& starts, int lane, PointKey key) const;
    void trace_area_light(const PointBatch& points, LightId light, const PointTile& tile, std::span<float> s) const;
    [[nodiscard]] TriangleId first_blocker(const Starts& starts, int lane, Facing facing, std::size_t point) const;

    const Scene* scene_ = nullptr;
    float diagonal_     = 0;  ///< of the scene
    std::optional<RayScene> rays_;
    Target target_;
    std::optional<SampleSet> set_;
    std::vector<NearLight> near_light_;
};

/// The triangles in the untraced part of some segment to a hard light. Mostly there are none, and the tree finds that
/// at once.
std::vector<NearLight> RayTraced::find_near_light(LightId light) const {
    const double distance = glm::length(target_.sphere);
    if (target_.kind != LightKind::point && target_.kind != LightKind::spot) return {};
    // Ray space holds the scene within 2 each way. What is farther than that from it is far from every triangle, too.
    constexpr double scene_radius = 4;
    if (distance > 2 * scene_radius) return {};
    const double stretch = kUntraced * (distance + scene_radius);
    if (rays_->clearance(target_.sphere, stretch) >= stretch) return {};
    return near_light(*scene_, scene_->lights[light].position);
}

/// The point from its name, rounded in ray space only: where that is moved, its floats are finer than the world's.
vec3 RayTraced::exact_start(const PointBatch& points, std::size_t i) const {
    const TriangleId t    = points.triangle[i];
    const RaySpace& space = rays_->space();
    const dvec3 a(space.point(scene_->vertex(t, 0))), b(space.point(scene_->vertex(t, 1))),
        c(space.point(scene_->vertex(t, 2)));
    return vec3(a + double(points.u[i]) * (b - a) + double(points.v[i]) * (c - a));
}

/// Which triangle close before a hard light hides it from the point; kNoTriangle where none does.
TriangleId RayTraced::blocker_near_light(const PointBatch& points, LightId light, std::size_t i) const {
    if (near_light_.empty()) return kNoTriangle;
    const TriangleId t = points.triangle[i];
    const dvec3 a(scene_->vertex(t, 0)), b(scene_->vertex(t, 1)), c(scene_->vertex(t, 2));
    const dvec3 p =
        (a - dvec3(scene_->lights[light].position)) + double(points.u[i]) * (b - a) + double(points.v[i]) * (c - a);
    for (const NearLight& n : near_light_)
        if (n.triangle != t && passes_through(n, p)) return n.triangle;
    return kNoTriangle;
}

/// Where the rays of the points first .. first + count - 1 start, at most eight. Lanes from `count` on stay as they
/// were.
void RayTraced::load_starts(const PointBatch& points, std::size_t first, std::size_t count, Starts& starts) const {
    const RaySpace& space = rays_->space();
    const auto load       = [&](const auto& from, auto& to) {
        if (count == 8)
            std::copy_n(from.data() + first, 8, to);
        else
            std::copy_n(from.data() + first, count, to);
    };
    load(points.px, starts.x), load(points.py, starts.y), load(points.pz, starts.z);
    load(points.nx, starts.nx), load(points.ny, starts.ny), load(points.nz, starts.nz);
    load(points.triangle, starts.id);
    if (options.offset != OffsetPolicy::skip_triangle) {
        const float lift = static_cast<float>(options.epsilon) * diagonal_;
        for (int k = 0; k < 8; ++k) {
            const vec3 p(starts.x[k], starts.y[k], starts.z[k]), n(starts.nx[k], starts.ny[k], starts.nz[k]);
            const vec3 q = options.offset == OffsetPolicy::epsilon ? p + lift * n : integer_offset(p, n);
            starts.x[k] = q.x, starts.y[k] = q.y, starts.z[k] = q.z;
            starts.id[k] = kNoTriangle;
        }
    }
    for (int k = 0; k < 8; ++k) {
        starts.x[k] = (starts.x[k] - space.centre.x) * space.scale;
        starts.y[k] = (starts.y[k] - space.centre.y) * space.scale;
        starts.z[k] = (starts.z[k] - space.centre.z) * space.scale;
    }
    if (options.offset != OffsetPolicy::skip_triangle) return;
    if (space.centre != vec3(0)) {
        for (std::size_t k = 0; k < count; ++k) {
            if (starts.id[k] == kNoTriangle) continue;
            const vec3 p = exact_start(points, first + k);
            starts.x[k] = p.x, starts.y[k] = p.y, starts.z[k] = p.z;
        }
    }
    // How far the start may lie below its plane, with u = 2^-24 and unit normal n:
    //   p's coordinates are rounded once, each by at most u |p_k|: together by sum |n_k| u |p_k| along n;
    //   a triangle in that plane (a neighbour, a duplicate) is met where Embree's (v - p).N vanishes, v a vertex, N its
    //   normal. v - p lies in the plane, so |v_k - p_k| <= E sqrt(1 - n_k^2), E <= 2 the scene's extent; the
    //   difference, N's coordinates, the products and their sums are rounded, each by a few u of that.
    // Both vanish for planes that the axes span: a floor at y = 0 needs no tolerance. It gets a billionth of the scene,
    // since a ray that starts after 0 need not visit the floor's flat box.
    constexpr float u = 0x1p-24f, least = 0x1p-30f;
    for (int k = 0; k < 8; ++k) {
        const float nx = starts.nx[k], ny = starts.ny[k], nz = starts.nz[k];
        const auto term  = [](float n) { return std::abs(n) * std::sqrt(std::max(0.0f, 1 - n * n)); };
        starts.height[k] = u * (std::abs(nx * starts.x[k]) + std::abs(ny * starts.y[k]) + std::abs(nz * starts.z[k])) +
                           (4 * u) * (term(nx) + term(ny) + term(nz)) + least;
    }
}

/// Writes one ray for each of the `count` points that faces the light, from `rays` on. Returns how many.
std::size_t RayTraced::hard_light_rays(const Starts& starts, const Facing* facing, std::size_t count,
                                       ShadowRay* rays) const {
    const bool parallel  = target_.kind == LightKind::directional;
    const float per_unit = parallel ? 0 : target_.per_unit;
    float dx[8], dy[8], dz[8], tnear[8];
    for (int k = 0; k < 8; ++k) {
        dx[k]            = target_.centre.x - per_unit * starts.x[k];
        dy[k]            = target_.centre.y - per_unit * starts.y[k];
        dz[k]            = target_.centre.z - per_unit * starts.z[k];
        const float rise = starts.nx[k] * dx[k] + starts.ny[k] * dy[k] + starts.nz[k] * dz[k];
        tnear[k]         = starts.height[k] / std::max(rise, 1e-30f);
    }
    const float tfar    = parallel ? kInfinity : target_.reach;
    std::size_t written = 0;
    for (std::size_t k = 0; k < count; ++k) {
        if (facing[k] < Facing::partly) continue;
        rays[written++] = {starts.x[k], starts.y[k], starts.z[k], tnear[k], dx[k],        dy[k],
                           dz[k],       0,           tfar,        ~0u,      starts.id[k], 0};
    }
    return written;
}

/// Calls body(packet) for each eight samples of the light, with their rays ready, until it returns false. Lanes are
/// valid where there is a sample and it lies in front of the point's plane. False where the point lies within the
/// light.
template <class Body>
bool RayTraced::for_each_packet(const Starts& starts, int lane, PointKey key, const Body& body) const {
    const vec3 o(starts.x[lane], starts.y[lane], starts.z[lane]), n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
    vec3 to_centre = target_.centre - o * target_.per_unit, axis_u = target_.axis_u, axis_v = target_.axis_v;
    if (target_.kind == LightKind::sphere) {
        TangentDisk disk;
        if (!tangent_disk(dvec3(o), target_.sphere, target_.radius, disk)) return false;
        const double per_unit = 1 / target_.unit;
        to_centre             = vec3((disk.centre - dvec3(o)) * per_unit);
        axis_u                = vec3(disk.axis_u * per_unit);
        axis_v                = vec3(disk.axis_v * per_unit);
    }
    ShadowPacket packet;
    for (int k = 0; k < 8; ++k) {
        packet.org_x[k] = o.x, packet.org_y[k] = o.y, packet.org_z[k] = o.z;
        packet.id[k] = starts.id[lane];
    }
    for (int first = 0; first < options.samples; first += 8) {
        Samples8 samples;
        set_->eight(key, first, samples);
        if (target_.kind == LightKind::rectangle)
            for (int k = 0; k < 8; ++k) samples.x[k] = 2 * samples.x[k] - 1, samples.y[k] = 2 * samples.y[k] - 1;
        else
            map_to_disk(samples);
        for (int k = 0; k < 8; ++k) {
            const float dx   = to_centre.x + samples.x[k] * axis_u.x + samples.y[k] * axis_v.x;
            const float dy   = to_centre.y + samples.x[k] * axis_u.y + samples.y[k] * axis_v.y;
            const float dz   = to_centre.z + samples.x[k] * axis_u.z + samples.y[k] * axis_v.z;
            const float rise = n.x * dx + n.y * dy + n.z * dz;
            packet.dir_x[k] = dx, packet.dir_y[k] = dy, packet.dir_z[k] = dz;
            packet.tnear[k] = starts.height[lane] / std::max(rise, 1e-30f);
            packet.tfar[k]  = target_.reach;
            packet.valid[k] = rise > 0 && first + k < options.samples ? -1 : 0;
        }
        if (!body(packet)) return true;
    }
    return true;
}

/// Stands for S_j where the point's plane leaves so little of the light that no sample is in front of it: there is no
/// irradiance to take a fraction of.
constexpr float kNoSample = -1;

/// The fraction of the light's irradiance that arrives at the point. Towards a flat light the cosine at the light is
/// the same height over the distance for all samples, so that one of direction d counts n.d / |d|^4; the disk that a
/// point sees of a sphere spans the directions that the sphere does.
float RayTraced::visible_irradiance(const Starts& starts, int lane, PointKey key) const {
    const vec3 n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
    double seen = 0, all = 0;
    const bool outside = for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
        double weight[8];
        for (int k = 0; k < 8; ++k) {
            const dvec3 d(packet.dir_x[k], packet.dir_y[k], packet.dir_z[k]);
            const double square = glm::dot(d, d);
            weight[k]           = packet.valid[k] != 0 ? glm::dot(dvec3(n), d) / (square * square) : 0;
        }
        rays_->occluded(packet);
        for (int k = 0; k < 8; ++k) {
            all += weight[k];
            if (packet.tfar[k] >= 0) seen += weight[k];
        }
        return true;
    });
    if (!outside) return 1;
    return all > 0 ? static_cast<float>(seen / all) : kNoSample;
}

/// The fraction of the light's samples that the point sees. What is behind the point's plane is not seen.
float RayTraced::visible_fraction(const Starts& starts, int lane, PointKey key) const {
    if (options.measure == Measure::irradiance) return visible_irradiance(starts, lane, key);
    int seen           = 0;
    const bool outside = for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
        rays_->occluded(packet);
        for (int k = 0; k < 8; ++k) seen += packet.valid[k] != 0 && packet.tfar[k] >= 0;
        return true;
    });
    return outside ? static_cast<float>(seen) / static_cast<float>(options.samples) : 1;
}

/// Hard lights: all rays of a tile are one list, since neighbours meet the same triangles.
void RayTraced::trace_hard_light(const PointBatch& points, LightId light, const PointTile& tile,
                                 std::span<float> s) const {
    const FlushDenormals flush;
    const Facing* facing = points.facing[light].data();
    Starts starts;
    ShadowRay rays[PointTile::kPoints];
    std::size_t traced = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        if (!any_asks(facing + first, count)) return;
        load_starts(points, first, count, starts);
        traced += hard_light_rays(starts, facing + first, count, rays + traced);
    });
    if (traced == 0) return;
    rays_->occluded(std::span(rays, traced));
    std::size_t next = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) {
            if (!points.asks(light, i)) continue;
            const bool blocked = rays[next++].tfar < 0 || blocker_near_light(points, light, i) != kNoTriangle;
            s[i]               = blocked ? 0.0f : 1.0f;
        }
    });
}

/// Area lights: eight rays of one point are a packet.
void RayTraced::trace_area_light(const PointBatch& points, LightId light, const PointTile& tile,
                                 std::span<float> s) const {
    const FlushDenormals flush;
    const Facing* facing = points.facing[light].data();
    Starts starts;
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        if (!any_asks(facing + first, count)) return;
        load_starts(points, first, count, starts);
        for (std::size_t k = 0; k < count; ++k)
            if (points.asks(light, first + k))
                s[first + k] = visible_fraction(starts, static_cast<int>(k), set_->key(first + k));
    });
}

void RayTraced::visibility(const PointBatch& points, LightId light, Visibility out) const {
    for_each_tile(points, [&](const PointTile& tile) {
        if (is_area(target_.kind))
            trace_area_light(points, light, tile, out.s);
        else
            trace_hard_light(points, light, tile, out.s);
    });
    if (options.measure == Measure::area) return;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (out.s[i] == kNoSample) out.s[i] = 0, out.answer[i] = Answer::undefined;
}

TriangleId RayTraced::first_blocker(const Starts& starts, int lane, Facing facing, std::size_t point) const {
    if (!is_area(target_.kind)) {
        ShadowRay ray;
        hard_light_rays(lane_alone(starts, lane), &facing, 1, &ray);
        return rays_->first_hit(ray);
    }
    // Where little of the light is hidden one set of samples may miss it: sixteen are tried.
    TriangleId blocker = kNoTriangle;
    for (std::uint64_t attempt = 0; attempt < 16 && blocker == kNoTriangle; ++attempt)
        for_each_packet(starts, lane, set_->key(16 * point + attempt), [&](const ShadowPacket& packet) {
            for (int k = 0; k < 8 && blocker == kNoTriangle; ++k)
                if (packet.valid[k] != 0)
                    blocker = rays_->first_hit({packet.org_x[k], packet.org_y[k], packet.org_z[k], packet.tnear[k],
                                                packet.dir_x[k], packet.dir_y[k], packet.dir_z[k], 0, packet.tfar[k],
                                                ~0u, packet.id[k], 0});
            return blocker == kNoTriangle;
        });
    return blocker;
}

void RayTraced::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    const std::vector<Facing>& facing = points.facing[light];
    parallel_ranges((points.size() + 7) / 8, 8, [&](std::size_t begin, std::size_t end) {
        const FlushDenormals flush;
        Starts starts;
        for (std::size_t first = 8 * begin; first < std::min(8 * end, points.size()); first += 8) {
            const std::size_t count = std::min<std::size_t>(8, points.size() - first);
            load_starts(points, first, count, starts);
            for (std::size_t k = 0; k < count; ++k) {
                TriangleId& blocker = blockers[first + k];
                blocker             = kNoTriangle;
                if (facing[first + k] < Facing::partly) continue;
                blocker = first_blocker(starts, static_cast<int>(k), facing[first + k], first + k);
                if (blocker == kNoTriangle) blocker = blocker_near_light(points, light, first + k);
            }
        }
    });
}

}  // namespace

extern const MethodInfo ray_traced;
const MethodInfo ray_traced{
    .name  = "ray_traced",
    .title = "Ray-traced shadows",
    .paper =
        "Arthur Appel, Some Techniques for Shading Machine Renderings of Solids, 1968; Turner Whitted, An Improved "
        "Illumination Model for Shaded Display, 1980; Robert Cook, Thomas Porter, Loren Carpenter, Distributed Ray "
        "Tracing, 1984",
    .summary =
        "A ray from each surface point to the light, or to many points of an area light, asks whether anything "
        "lies between. Errs by noise in penumbrae, and by the offset that keeps rays off their own surface. "
        "Limit: what is finer than a millionth of the scene, as gaps, slivers or relief under grazing light.",
    .parameters = kParameters,
    .presets    = {{"textbook", "offset=epsilon,sampler=random",
                    "Starts rays at an offset along the normal; independent samples."},
                   {"fast", "samples=4", "Four rays a point to an area light."},
                   {"best", "samples=256", "256 rays a point to an area light."}},
    .seed       = "seed",
    .stand_in   = "samples=256",
    .create     = create<RayTraced>};

}  // namespace umbra
