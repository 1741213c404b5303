#include "umbra/bench/studies/light/ray_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "umbra/bench/studies/light/optics.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/random_bits.h"
#include "umbra/core/base/stopwatch.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

constexpr std::size_t kMostRays = std::size_t{1} << 24;
constexpr std::size_t kChunk    = 2048;

/// From which opacity on an eye ray sees the surface: by its row and its column. [Bryce Bayer, An Optimum Method for
/// Two-Level Rendition of Continuous-Tone Pictures, 1973]
constexpr float kScreenDoor[4][4] = {{0.5f / 16, 8.5f / 16, 2.5f / 16, 10.5f / 16},
                                     {12.5f / 16, 4.5f / 16, 14.5f / 16, 6.5f / 16},
                                     {3.5f / 16, 11.5f / 16, 1.5f / 16, 9.5f / 16},
                                     {15.5f / 16, 7.5f / 16, 13.5f / 16, 5.5f / 16}};

/// How far a start in ray space may lie off its triangle's plane, and that of a neighbour in this plane, by rounding to
/// float: see StartPlaces::load in shadows/light_rays, which derives the bound.
float start_height(vec3 o, vec3 n) {
    constexpr float u = 0x1p-24f, least = 0x1p-30f;
    float height = least;
    for (int k = 0; k < 3; ++k)
        height += u * std::abs(n[k] * o[k]) + 4 * u * std::abs(n[k]) * std::sqrt(std::max(0.0f, 1 - n[k] * n[k]));
    return height;
}

/// In ray space, beginning where the ray has risen above that height. An eye ray begins at the eye.
ShadowRay in_ray_space(const RaySpace& space, const Ray& ray) {
    const vec3 o = space.point(ray.origin), d(ray.direction), n(ray.normal);
    ShadowRay traced;
    traced.org_x = o.x, traced.org_y = o.y, traced.org_z = o.z;
    traced.dir_x = d.x, traced.dir_y = d.y, traced.dir_z = d.z;
    traced.tnear = ray.from == kNoTriangle ? 0 : start_height(o, n) / std::max(std::abs(glm::dot(n, d)), 1e-30f);
    traced.tfar  = static_cast<float>(ray.reach * static_cast<double>(space.scale));
    traced.id    = ray.from;
    traced.mask  = ray.is_of_eye ? kEyeRay : ~0u;
    return traced;
}

/// Where a ray is on the plane of triangle t: its second and third vertex weigh u and v. Not finite where it runs along
/// the plane.
struct OnPlane {
    double u, v, t;
};
// In the order of the operations of PointWriter in gbuffer.cpp, so that both find the same bits.
OnPlane meet_plane(const Scene& scene, const Ray& ray, TriangleId t) {
    const dvec3 a(scene.vertex(t, 0)), ab = dvec3(scene.vertex(t, 1)) - a, ac = dvec3(scene.vertex(t, 2)) - a;
    const dvec3 from_a = ray.origin - a, n = glm::cross(ab, ac), m = glm::cross(from_a, ray.direction);
    const double over = -1 / glm::dot(n, ray.direction);
    return {glm::dot(m, ac) * over, glm::dot(m, ab) * -over, glm::dot(n, from_a) * over};
}

/// Point i of the batch: where the ray meets triangle t, seen from the ray's side.
void write_point(PointBatch& batch, std::size_t i, const Scene& scene, TriangleId t, const Ray& ray) {
    if (t == kNoTriangle) return;
    const OnPlane on = meet_plane(scene, ray, t);
    const bool known = std::isfinite(on.u) && std::isfinite(on.v);
    set_point(batch, i, scene, t, known ? static_cast<float>(on.u) : 1.0f / 3,
              known ? static_cast<float>(on.v) : 1.0f / 3);
}

/// Turns the normals of two-sided points, which set_point turned to the eye, to where their rays came from.
void face_ray(PointBatch& batch, std::size_t i, const Scene& scene, dvec3 direction) {
    if (batch.triangle[i] == kNoTriangle || !scene.material(batch.triangle[i]).two_sided) return;
    if (glm::dot(dvec3(batch.normal(i)), direction) <= 0) return;
    batch.nx[i] = -batch.nx[i], batch.ny[i] = -batch.ny[i], batch.nz[i] = -batch.nz[i];
    batch.flipped[i] = batch.flipped[i] == 0 ? 1 : 0;
}

/// Calls write(points, i, scene, t, ray) for every point of the batch, with the triangle t that `ray_of(i)` meets.
template <class RayOf, class Write>
void meet(const RayScene& rays, const Scene& scene, PointBatch& points, const RayOf& ray_of, const Write& write) {
    parallel_ranges(points.size(), 512, [&](std::size_t begin, std::size_t end) {
        std::vector<TriangleId> met(end - begin);
        {
            const FlushDenormals flush;
            for (std::size_t i = begin; i < end; ++i) met[i - begin] = first_by_tree(rays, ray_of(i));
        }
        for (std::size_t i = begin; i < end; ++i) write(points, i, scene, met[i - begin], ray_of(i));
    });
}

bool lies_on_body(const RayLevel& level, std::size_t i) {
    return !level.on_body.empty() && level.on_body[i].body != kNoBody;
}

/// The side of a surface on which a ray arrives, with unit normals on that side.
struct Side {
    dvec3 face, smooth;
    bool outside;  ///< the side of the winding
};
Side side_of(const Scene& scene, const RayLevel& level, std::size_t i, dvec3 d) {
    const PointBatch& points = level.points;
    const dvec3 normal = lies_on_body(level, i) ? level.on_body[i].normal : glm::normalize(dvec3(points.normal(i)));
    const double turn  = glm::dot(normal, d) > 0 ? -1 : 1;  // one-sided, from behind
    Side side{turn * normal, turn * shading_normal(scene, level, i), (points.flipped[i] != 0) == (turn < 0)};
    if (glm::dot(side.smooth, d) >= 0) side.smooth = side.face;
    return side;
}

dvec3 mirrored_at(const Side& side, dvec3 d) {
    const dvec3 out = mirrored(d, side.smooth);
    return glm::normalize(glm::dot(out, side.face) > 0 ? out : mirrored(d, side.face));
}

std::optional<dvec3> refracted_at(const Side& side, dvec3 d, float index) {
    const double n = static_cast<double>(index), ratio = side.outside ? 1 / n : n;
    std::optional<dvec3> out = refracted(d, side.smooth, ratio);
    if (out && glm::dot(*out, side.face) >= 0) out = refracted(d, side.face, ratio);
    if (out) out = glm::normalize(*out);
    return out;
}

/// The rays that start at some points of a level.
class Spawner {
public:
    Spawner(const Scene& scene, const RayTree& tree, std::size_t level, const TreeOptions& options)
        : scene_(scene), tree_(tree), level_(level), options_(options) {}

    void at(std::size_t i) {
        const PointBatch& points = tree_.levels[level_].points;
        if (points.triangle[i] == kNoTriangle) return;
        ++counts.met;
        const Material& material = scene_.material(points.triangle[i]);
        double k_r = static_cast<double>(material.reflect), k_t = static_cast<double>(material.transmit);
        const double behind = k_t == 0 && material.opacity < 1 ? seen_behind(i, material.opacity) : 0;
        if (behind > 0) own.push_back({i, static_cast<float>(1 - behind)});
        if (k_r == 0 && k_t == 0 && behind == 0 && !options_.everywhere) return;
        const dvec3 d   = incoming(tree_, level_, i);
        const Side side = side_of(scene_, tree_.levels[level_], i, d);
        std::optional<dvec3> through;
        if (k_t > 0) {
            through = refracted_at(side, d, material.index_of_refraction);
            if (!through) {
                k_r += k_t;
                ++counts.total;
            }
        }
        if (k_r > 0 || options_.everywhere) {
            const dvec3 out = mirrored_at(side, d);
            add(i, options_.glossy ? spread(i, side, out, material.shininess) : out, k_r, RayKind::reflected);
        }
        if (through) add(i, *through, k_t, RayKind::refracted);
        if (behind > 0) add(i, d, behind, RayKind::refracted);
    }

    std::vector<SecondaryRay> rays;
    std::vector<std::pair<std::size_t, float>> own;  ///< RayLevel::own of the points where it is not 1
    RayCounts counts;

private:
    /// The eye ray that point i comes of.
    [[nodiscard]] std::size_t eye_ray(std::size_t i) const {
        for (std::size_t level = level_; level > 0; --level) i = tree_.levels[level].rays[i].parent;
        return i;
    }

    /// A direction about `axis`, of a density that is proportional to cos^n of its angle from it. Keyed by the eye ray
    /// and the depth, so that it is the same whichever other rays are traced; `axis` where it would leave through the
    /// surface.
    [[nodiscard]] dvec3 spread(std::size_t i, const Side& side, dvec3 axis, float n) const {
        const std::uint64_t bits = mixed_bits(mixed_bits(eye_ray(i)) + level_);
        const double u           = (static_cast<double>(bits >> 32) + 0.5) * 0x1p-32,
                     v           = (static_cast<double>(bits & 0xffffffffu) + 0.5) * 0x1p-32;
        const double cosine      = std::pow(u, 1 / (static_cast<double>(n) + 1)),
                     sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), angle = 2 * kPi * v;
        const Axes across = axes_across(axis);
        const dvec3 out =
            glm::normalize(cosine * axis + sine * (std::cos(angle) * across.u + std::sin(angle) * across.v));
        return glm::dot(out, side.face) > 0 ? out : axis;
    }

    /// The share of what lies behind point i, on a surface of this opacity.
    [[nodiscard]] double seen_behind(std::size_t i, float opacity) const {
        if (options_.transparency == Transparency::blend) return 1 - static_cast<double>(opacity);
        i                = eye_ray(i);
        const auto width = static_cast<std::size_t>(tree_.levels[0].points.raster->width);
        return kScreenDoor[i / width % 4][i % width % 4] < opacity ? 0 : 1;
    }

    void add(std::size_t parent, dvec3 direction, double factor, RayKind kind) {
        double weight = factor * (level_ == 0 ? 1 : tree_.levels[level_].rays[parent].weight);
        if (weight < options_.least_weight) {
            ++counts.too_light;
            if (!options_.everywhere) return;
            factor = weight = 0;  // traced in vain
        }
        if (static_cast<int>(level_) + 1 >= options_.depth)
            ++counts.too_deep;
        else
            rays.push_back({direction, factor, weight, static_cast<std::uint32_t>(parent), kind});
    }

    const Scene& scene_;
    const RayTree& tree_;
    std::size_t level_;
    const TreeOptions& options_;
};

/// The rays that start at a level; its counts of what they are.
std::vector<SecondaryRay> spawn(const Scene& scene, RayTree& tree, std::size_t level, const TreeOptions& options) {
    const std::size_t n = tree.levels[level].points.size();
    std::vector<Spawner> chunks((n + kChunk - 1) / kChunk, Spawner(scene, tree, level, options));
    parallel_ranges(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::size_t i = c * kChunk; i < std::min(n, (c + 1) * kChunk); ++i) chunks[c].at(i);
    });
    std::vector<SecondaryRay> rays;
    RayCounts& counts = tree.levels[level].counts;
    for (const Spawner& chunk : chunks) {
        rays.insert(rays.end(), chunk.rays.begin(), chunk.rays.end());
        if (!chunk.own.empty()) tree.levels[level].own.resize(n, 1);
        for (const auto& [point, share] : chunk.own) tree.levels[level].own[point] = share;
        counts.met += chunk.counts.met, counts.total += chunk.counts.total;
        counts.too_light += chunk.counts.too_light, counts.too_deep += chunk.counts.too_deep;
    }
    if (rays.size() > kMostRays)
        throw InputError(
            fmt::format("{}: {} rays at depth {}, expected at most {}: lower the depth, the size of the "
                        "picture or the samples of a pixel",
                        scene.source.empty() ? scene.name : scene.source, rays.size(), level + 2, kMostRays));
    return rays;
}

std::uint64_t asked(const PointBatch& points) {
    std::uint64_t pairs = 0;
    for (LightId j = 0; j < points.facing.size(); ++j)
        for (std::size_t i = 0; i < points.size(); ++i) pairs += points.asks(j, i) ? 1 : 0;
    return pairs;
}

}  // namespace

RayTree trace_rays(const Scene& scene, RayLevel eye, const TreeOptions& options, const MeetRays& meet) {
    if (!eye.points.raster) throw std::logic_error("trace_rays: the batch has no raster");
    RayTree tree;
    tree.eye_places = options.eye_places, tree.side = options.side;
    eye.counts     = {};
    eye.counts.eye = eye.points.size();
    tree.levels.push_back(std::move(eye));
    for (std::size_t level = 0;; ++level) {
        const Stopwatch start;
        std::vector<SecondaryRay> next = spawn(scene, tree, level, options);
        tree.spawn_ms += start.ms();
        tree.levels[level].counts.shadow = asked(tree.levels[level].points);
        if (next.empty()) return tree;
        RayLevel& below = tree.levels.emplace_back();
        below.rays      = std::move(next);
        for (const SecondaryRay& ray : below.rays)
            ++(ray.kind == RayKind::reflected ? below.counts.reflected : below.counts.refracted);
        meet(tree, level + 1);
    }
}

RayTree trace_rays(const RayScene& rays, const Scene& scene, PointBatch eye, const TreeOptions& options) {
    RayLevel first;
    first.points = std::move(eye);
    return trace_rays(scene, std::move(first), options, [&](RayTree& tree, std::size_t level) {
        const Stopwatch traced;
        PointBatch& points = tree.levels[level].points;
        points.eye         = tree.levels[0].points.eye;
        points.resize(tree.levels[level].rays.size());
        meet(
            rays, scene, points, [&](std::size_t i) { return secondary_ray(scene, tree, level, i); }, set_met_point);
        tree.trace_ms += traced.ms();
        const Stopwatch met;
        face_lights(points, scene);
        tree.face_ms += met.ms();
    });
}

dvec3 shading_normal(const Scene& scene, const RayLevel& level, std::size_t i) {
    return lies_on_body(level, i) ? level.on_body[i].normal : shading_normal(scene, level.points, i);
}

void set_met_point(PointBatch& batch, std::size_t i, const Scene& scene, TriangleId t, const Ray& ray) {
    write_point(batch, i, scene, t, ray);
    face_ray(batch, i, scene, ray.direction);
}

dvec2 eye_place(const CameraFrame& raster, EyePlaces places, int side, std::size_t i) {
    const auto width = static_cast<std::size_t>(raster.width), step = static_cast<std::size_t>(side);
    const std::size_t column = i % width, row = i / width;
    const dvec2 corner(static_cast<double>(column), static_cast<double>(row));
    if (places == EyePlaces::regular) return corner + 0.5;
    const std::uint64_t bits = mixed_bits(i);
    const dvec2 within = dvec2(static_cast<double>(bits >> 32), static_cast<double>(bits & 0xffffffffu)) * 0x1p-32;
    if (places == EyePlaces::jittered) return corner + within;
    return dvec2(static_cast<double>(column - column % step), static_cast<double>(row - row % step)) +
           static_cast<double>(side) * within;
}

PointBatch trace_eye_rays(const RayScene& rays, const Scene& scene, const CameraFrame& raster, EyePlaces places,
                          int side) {
    PointBatch points;
    points.raster = raster;
    points.eye    = vec3(raster.eye);
    points.resize(static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height));
    const RaySpace& space = rays.space();
    const bool window     = raster.projection == Projection::orthographic;
    const double scale = static_cast<double>(space.scale), unit = 1 / scale;
    // As EyeRays in gbuffer.cpp has them, operation by operation.
    const auto ray_of = [&](std::size_t i) {
        const dvec2 at_pixel     = eye_place(raster, places, side, i);
        const double zoom        = window ? scale : 1;
        const dvec3 column       = raster.half_width * (2 * at_pixel.x / raster.width - 1) * raster.right * zoom,
                    row          = raster.half_height * (2 * at_pixel.y / raster.height - 1) * raster.up * zoom;
        constexpr double forever = static_cast<double>(kInfinity);
        if (!window) return Ray{raster.eye, raster.forward + (column - row), kNoTriangle, dvec3(0), forever, true};
        const dvec3 at = (raster.eye - dvec3(space.centre)) * scale + (column - row);
        return Ray{at * unit + dvec3(space.centre), raster.forward, kNoTriangle, dvec3(0), forever, true};
    };
    meet(rays, scene, points, ray_of, write_point);
    face_lights(points, scene);
    return points;
}

Ray secondary_ray(const Scene& scene, const RayTree& tree, std::size_t level, std::size_t i) {
    const SecondaryRay& ray = tree.levels[level].rays[i];
    const RayLevel& from    = tree.levels[level - 1];
    if (lies_on_body(from, ray.parent))
        return {from.on_body[ray.parent].position, ray.direction, kNoTriangle, dvec3(0)};
    const PointBatch& points = from.points;
    return {exact_position(scene, points, ray.parent), ray.direction, points.triangle[ray.parent],
            dvec3(points.normal(ray.parent))};
}

TriangleId first_by_tree(const RayScene& rays, const Ray& ray) {
    return rays.first_hit(in_ray_space(rays.space(), ray));
}

double least_distance(const RayScene& rays, const Ray& ray) {
    return static_cast<double>(in_ray_space(rays.space(), ray).tnear) / static_cast<double>(rays.space().scale);
}

TriangleId first_by_search(const RayScene& rays, const Scene& scene, const Ray& ray) {
    const double start = least_distance(rays, ray);
    TriangleId first   = kNoTriangle;
    double nearest     = ray.reach;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        if (t == ray.from || (ray.is_of_eye && !scene.switches(t).seen_by_camera)) continue;
        const OnPlane on = meet_plane(scene, ray, t);
        if (on.u >= 0 && on.v >= 0 && on.u + on.v <= 1 && on.t > start && on.t < nearest) first = t, nearest = on.t;
    }
    return first;
}

double distance_to_plane(const Scene& scene, const Ray& ray, TriangleId t) { return meet_plane(scene, ray, t).t; }

dvec3 incoming(const RayTree& tree, std::size_t level, std::size_t i) {
    if (level > 0) return tree.levels[level].rays[i].direction;
    const CameraFrame& raster = *tree.levels[0].points.raster;
    const dvec2 place         = eye_place(raster, tree.eye_places, tree.side, i);
    return glm::normalize(raster.ray_direction(place.x, place.y));
}

std::vector<std::uint32_t> rays_by_eye_ray(const RayTree& tree) {
    std::vector<std::uint32_t> below;  // of one level: each ray and those that come of it
    for (std::size_t level = tree.levels.size(); level-- > 0;) {
        std::vector<std::uint32_t> here(tree.levels[level].points.size(), 1);
        for (std::size_t i = 0; i < below.size(); ++i) here[tree.levels[level + 1].rays[i].parent] += below[i];
        below = std::move(here);
    }
    return below;
}

}  // namespace umbra
