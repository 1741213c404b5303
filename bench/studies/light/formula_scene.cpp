#include "umbra/bench/studies/light/formula_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/stopwatch.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/sampling.h"

namespace umbra {

/// A ray, and the body on which it starts.
struct FormulaScene::Start {
    Ray ray;
    std::uint32_t body = kNoBody;
};

namespace {

constexpr double kForever = static_cast<double>(kInfinity);
// Before the light, a shadow ray ends by this part of its length: what touches the light does not hide it.
constexpr double kBeforeTheLight = 1 - 1e-5;

/// These triangles of the scene: what a RayScene takes of a scene, and no more.
Scene rest_of(const Scene& scene, const std::vector<TriangleId>& kept_ones) {
    Scene rest;
    rest.positions   = scene.positions;
    rest.materials   = scene.materials;
    rest.objects     = scene.objects;
    rest.transparent = scene.transparent;
    for (const TriangleId t : kept_ones) {
        rest.triangles.push_back(scene.triangles[t]);
        rest.triangle_object.push_back(scene.triangle_object[t]);
    }
    return rest;
}

/// Triangles that no body replaces.
std::vector<TriangleId> kept(const Scene& scene, const Bodies& bodies) {
    std::vector<TriangleId> numbers;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        if (bodies.of_mesh[t] == kNoBody) numbers.push_back(t);
    return numbers;
}

std::vector<TriangleId> numbered(const Scene& scene, const std::vector<TriangleId>& kept_ones) {
    std::vector<TriangleId> numbers(scene.triangles.size(), kNoTriangle);
    for (TriangleId t = 0; t < kept_ones.size(); ++t) numbers[kept_ones[t]] = t;
    return numbers;
}

BodyTree tree_of(const Scene& scene, const Bodies& bodies) {
    std::vector<vec3> passes;
    std::vector<std::uint8_t> seen;
    for (const Body& body : bodies.list) {
        passes.push_back(scene.lets_through(body.holder));
        seen.push_back(scene.switches(body.holder).seen_by_camera ? 1 : 0);
    }
    return {bodies.list, std::move(passes), std::move(seen)};
}

/// Least and greatest height of a light over the plane through p with the unit normal n.
std::pair<double, double> heights_of(const Light& light, dvec3 p, dvec3 n) {
    if (light.kind == LightKind::directional) {
        const double height = -glm::dot(n, dvec3(light.direction));
        return {height, height};
    }
    const double height = glm::dot(n, dvec3(light.position) - p);
    double reach        = 0;
    if (light.kind == LightKind::rectangle)
        reach = 0.5 * (std::abs(glm::dot(n, dvec3(light.edge_u))) + std::abs(glm::dot(n, dvec3(light.edge_v))));
    if (light.kind == LightKind::disk)
        reach = static_cast<double>(light.radius) * glm::length(glm::cross(n, glm::normalize(dvec3(light.direction))));
    if (light.kind == LightKind::sphere) reach = static_cast<double>(light.radius);
    return {height - reach, height + reach};
}

Facing facing_of(const Light& light, const OnBody& at) {
    const auto [low, high] = heights_of(light, at.position, at.normal);
    if (high <= 0) return Facing::away;
    if (low >= 0) return Facing::front;
    const bool inside = light.kind == LightKind::sphere &&
                        glm::distance(at.position, dvec3(light.position)) <= static_cast<double>(light.radius);
    return inside ? Facing::unshadowed : Facing::partly;
}

/// Faces all points of a level to all lights, those on bodies by the tangent plane.
void face_level(RayLevel& level, const Scene& scene) {
    face_lights(level.points, scene);
    parallel_ranges(level.points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for (LightId j = 0; j < scene.lights.size() && level.on_body[i].body != kNoBody; ++j)
                level.points.facing[j][i] =
                    as_received(scene, level.points.triangle[i], facing_of(scene.lights[j], level.on_body[i]));
    });
}

/// What an area light's samples are, seen from p.
std::array<dvec3, kFormulaLightSamples> points_of_light(const Light& light, dvec3 p, const SampleSet& samples,
                                                        std::uint64_t point) {
    dvec3 centre(light.position), u(light.edge_u), v(light.edge_v);
    if (light.kind == LightKind::disk) {
        const Axes across = axes_across(glm::normalize(dvec3(light.direction)));
        u = static_cast<double>(light.radius) * across.u, v = static_cast<double>(light.radius) * across.v;
    }
    if (TangentDisk disk; light.kind == LightKind::sphere) {
        const bool outside = tangent_disk(p, centre, static_cast<double>(light.radius), disk);
        if (outside) centre = disk.centre;
        u = outside ? disk.axis_u : dvec3(0), v = outside ? disk.axis_v : dvec3(0);
    }
    std::array<dvec3, kFormulaLightSamples> on_light{};
    const PointKey key = samples.key(point);
    for (int first = 0; first < kFormulaLightSamples; first += 8) {
        Samples8 eight;
        samples.eight(key, first, eight);
        if (light.kind != LightKind::rectangle) map_to_disk(eight);
        const double middle = light.kind == LightKind::rectangle ? 0.5 : 0;
        for (int k = 0; k < 8; ++k)
            on_light[static_cast<std::size_t>(first + k)] = centre + (static_cast<double>(eight.x[k]) - middle) * u +
                                                            (static_cast<double>(eight.y[k]) - middle) * v;
    }
    return on_light;
}

}  // namespace

FormulaScene::FormulaScene(const Scene& scene, const Bodies& bodies)
    : scene_(&scene),
      in_scene_(kept(scene, bodies)),
      in_rest_(numbered(scene, in_scene_)),
      rest_(rest_of(scene, in_scene_)),
      shadow_rest_(rest_of(scene, in_scene_),
                   scene.transparent == TransparentOccluders::multiply ? Met::all : Met::blocking),
      bodies_(tree_of(scene, bodies)) {}

TriangleId FormulaScene::first_triangle(const RayScene& rays, Ray ray) const {
    if (ray.from != kNoTriangle) ray.from = in_rest_[ray.from];
    const TriangleId met = first_by_tree(rays, ray);
    return met == kNoTriangle ? kNoTriangle : in_scene_[met];
}

void FormulaScene::set_point_on_body(RayLevel& level, std::size_t i, BodyMeeting met, const Ray& ray) const {
    const Body& body   = bodies_.body(met.body);
    const OnSurface on = onto_surface(body, ray.origin + met.t * ray.direction);
    const dvec3 wound  = body.inside_out ? -on.normal : on.normal;
    const bool flip    = scene_->material(body.holder).two_sided && glm::dot(wound, ray.direction) > 0;
    const dvec3 normal = flip ? -wound : wound;
    level.on_body[i]   = {met.body, on.position, normal};
    PointBatch& points = level.points;
    points.triangle[i] = body.holder;
    points.flipped[i]  = flip ? 1 : 0;
    const vec3 p(on.position), n(normal);
    points.px[i] = p.x, points.py[i] = p.y, points.pz[i] = p.z;
    points.nx[i] = n.x, points.ny[i] = n.y, points.nz[i] = n.z;
}

/// What `count` rays meet: the nearest of triangle and body.
void FormulaScene::meet(RayLevel& level, std::size_t count, const std::function<Start(std::size_t)>& start_of) const {
    level.points.resize(count);
    level.on_body.assign(count, OnBody());
    parallel_ranges(count, 512, [&](std::size_t begin, std::size_t end) {
        std::vector<TriangleId> triangles(end - begin);
        std::vector<BodyMeeting> bodies(end - begin);
        {
            const FlushDenormals flush;
            for (std::size_t i = begin; i < end; ++i) {
                const Start start  = start_of(i);
                const TriangleId t = first_triangle(rest_, start.ray);
                double reach       = kForever;
                if (t != kNoTriangle) reach = distance_to_plane(*scene_, start.ray, t);
                if (!std::isfinite(reach)) reach = kForever;
                triangles[i - begin] = t;
                bodies[i - begin] =
                    bodies_.first({start.ray.origin, start.ray.direction, start.body, reach, start.ray.is_of_eye});
            }
        }
        for (std::size_t i = begin; i < end; ++i) {
            const Ray ray = start_of(i).ray;
            if (bodies[i - begin].body != kNoBody)
                set_point_on_body(level, i, bodies[i - begin], ray);
            else
                set_met_point(level.points, i, *scene_, triangles[i - begin], ray);
        }
    });
}

RayTree FormulaScene::trace(const CameraFrame& raster, const TreeOptions& options) const {
    const auto width  = static_cast<std::size_t>(raster.width);
    const auto eye_at = [&](std::size_t i) {
        const dvec2 at = eye_place(raster, options.eye_places, options.side, i);
        return Start{{raster.ray_origin(at.x, at.y), glm::normalize(raster.ray_direction(at.x, at.y)), kNoTriangle,
                      dvec3(0), kForever, true},
                     kNoBody};
    };
    RayLevel eye;
    eye.points.raster = raster;
    eye.points.eye    = vec3(raster.eye);
    const Stopwatch start;
    meet(eye, width * static_cast<std::size_t>(raster.height), eye_at);
    const double eye_ms = start.ms();
    const Stopwatch faced;
    face_level(eye, *scene_);
    const double face_ms = faced.ms();
    RayTree tree         = trace_rays(*scene_, std::move(eye), options, [&](RayTree& grown, std::size_t level) {
        const Stopwatch traced;
        const std::vector<OnBody>& before = grown.levels[level - 1].on_body;
        const auto secondary_at           = [&](std::size_t i) {
            return Start{secondary_ray(*scene_, grown, level, i), before[grown.levels[level].rays[i].parent].body};
        };
        RayLevel& here  = grown.levels[level];
        here.points.eye = grown.levels[0].points.eye;
        meet(here, here.rays.size(), secondary_at);
        grown.trace_ms += traced.ms();
        const Stopwatch met;
        face_level(here, *scene_);
        grown.face_ms += met.ms();
    });
    tree.trace_ms += eye_ms, tree.face_ms += face_ms;
    return tree;
}

/// What is left of light after all surfaces on a ray, per channel.
dvec3 FormulaScene::passes(const Start& to_light) const {
    dvec3 share =
        bodies_.lets_through({to_light.ray.origin, to_light.ray.direction, to_light.body, to_light.ray.reach});
    for (Ray ray = to_light.ray; share != dvec3(0);) {
        const TriangleId t = first_triangle(shadow_rest_, ray);
        if (t == kNoTriangle) break;
        share *= dvec3(scene_->lets_through(t));
        const double distance = distance_to_plane(*scene_, ray, t);
        if (!std::isfinite(distance)) break;
        ray = {ray.origin + distance * ray.direction, ray.direction, t, glm::normalize(area_normal(*scene_, t)),
               ray.reach - distance};
    }
    return share;
}

std::vector<VisibilityPlane> FormulaScene::visibility(const RayTree& tree, std::size_t level) const {
    const RayLevel& here     = tree.levels[level];
    const PointBatch& points = here.points;
    const SampleSet samples(Sampler::sobol, kFormulaLightSamples, 0);
    const bool is_coloured = has_coloured_filters(*scene_);
    std::vector<VisibilityPlane> planes(scene_->lights.size(), VisibilityPlane(points.size(), is_coloured));
    const auto start_at = [&](std::size_t i) {
        const OnBody& on = here.on_body[i];
        if (on.body != kNoBody) return Start{{on.position, dvec3(0), kNoTriangle, dvec3(0)}, on.body};
        return Start{{exact_position(*scene_, points, i), dvec3(0), points.triangle[i], dvec3(points.normal(i))},
                     kNoBody};
    };
    const auto passes_to = [&](Start start, dvec3 to) {
        const dvec3 d       = to - start.ray.origin;
        start.ray.reach     = kBeforeTheLight * glm::length(d);
        start.ray.direction = glm::normalize(d);
        return start.ray.reach > 0 ? passes(start) : dvec3(1);
    };
    for (LightId j = 0; j < planes.size(); ++j) {
        write_decided(*scene_, points, j, planes[j].out());
        const Light& light   = scene_->lights[j];
        const auto s_of_area = [&](std::size_t i, const Start& start) {
            const dvec3 normal = start.body == kNoBody ? start.ray.normal : here.on_body[i].normal;
            dvec3 sum(0);
            for (const dvec3& to : points_of_light(light, start.ray.origin, samples, (std::uint64_t{level} << 32) + i))
                if (points.facing[j][i] == Facing::front || glm::dot(normal, to - start.ray.origin) > 0)
                    sum += passes_to(start, to);
            return sum / static_cast<double>(kFormulaLightSamples);
        };
        parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
            const FlushDenormals flush;
            for (std::size_t i = begin; i < end; ++i) {
                if (!points.asks(j, i)) continue;
                Start start = start_at(i);
                dvec3 s(0);
                if (light.kind == LightKind::directional) {
                    start.ray.direction = -glm::normalize(dvec3(light.direction));
                    s                   = passes(start);
                } else {
                    s = is_area(light.kind) ? s_of_area(i, start) : passes_to(start, dvec3(light.position));
                }
                planes[j].s[i] = mean_of(vec3(s));
                if (is_coloured) planes[j].colour[i] = vec3(s);
            }
        });
    }
    return planes;
}

}  // namespace umbra
