// Kernels that all methods stand on: camera rays, shadow rays, exact signs, facing, facts, shading. Each is checked
// before it is timed, by what is known of the scene without it.
//
//     kernels_benchmark [Google Benchmark's options]
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <deque>
#include <functional>
#include <optional>

#include "umbra/bench/speed/speed_scenes.h"
#include "umbra/bench/speed/timed_loop.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

constexpr int kWidth = 640, kHeight = 360;

void time_tree(benchmark::State& state, const SpeedStage& stage) {
    std::optional<RayScene> rays;
    timed_loop(
        state, stage.scene.triangles.size(), [&] { rays.emplace(stage.scene); }, [&] { rays.reset(); });
}

/// Checked: each point lies on its pixel's ray, within a pixel.
void time_camera_rays(benchmark::State& state, const SpeedStage& stage) {
    PointBatch batch;
    const auto work = [&] { stage.find_points(batch); };
    work();
    const CameraFrame f = *batch.raster;
    for (std::size_t i = 0; i < batch.size(); i += 97) {
        if (batch.triangle[i] == kNoTriangle) continue;
        const dvec3 to           = dvec3(batch.position(i)) - dvec3(f.eye);
        const double deep        = glm::dot(to, dvec3(f.forward));
        const double x           = (glm::dot(to, dvec3(f.right)) / deep / f.half_width + 1) * kWidth / 2;
        const std::size_t column = i % kWidth, row = i / kWidth;
        const double y = (1 - glm::dot(to, dvec3(f.up)) / deep / f.half_height) * kHeight / 2;
        if (std::abs(x - static_cast<double>(column) - 0.5) > 1 || std::abs(y - static_cast<double>(row) - 0.5) > 1)
            return state.SkipWithError(fmt::format("point {} is not on its pixel's ray", i).c_str());
    }
    timed_loop(state, batch.size(), work);
}

constexpr std::size_t kRays = std::size_t{1} << 16;

/// Ray k starts over the floor, on a grid of 256 x 256 that covers the bodies, and goes up (even k) or down to the
/// floor.
struct VerticalRay {
    vec3 origin;
    float rise;
};
VerticalRay vertical_ray(const RaySpace& space, std::size_t k) {
    const auto column = static_cast<float>(k % 256), row = static_cast<float>(k >> 8);
    return {space.point(vec3(6 * column / 256 - 3, 0.1f, 6 * row / 256 - 3)),
            static_cast<float>(k % 2 == 0 ? 3 : -1) * space.scale};
}

/// Whether a triangle blocks a vertical ray, in double: the origin's x and z are inside the triangle's, and the height
/// there is on the way.
bool blocks(const Scene& scene, const RaySpace& space, TriangleId t, const VerticalRay& ray) {
    dvec3 v[3];
    for (int k = 0; k < 3; ++k) v[k] = dvec3(space.point(scene.vertex(t, k))) - dvec3(ray.origin);
    double weight[3], sum = 0;
    for (int k = 0; k < 3; ++k) {
        const dvec3 &p = v[(k + 1) % 3], &q = v[(k + 2) % 3];
        sum += weight[k] = p.x * q.z - p.z * q.x;
    }
    const bool inside =
        (weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0) || (weight[0] <= 0 && weight[1] <= 0 && weight[2] <= 0);
    if (!inside || sum == 0) return false;
    const double height = (weight[0] * v[0].y + weight[1] * v[1].y + weight[2] * v[2].y) / sum / ray.rise;
    return height > 0 && height <= 1;
}

using Blocked = std::vector<std::uint8_t>;  ///< one a ray

/// Checked: 64 of the rays against every triangle.
void time_shadow_rays(benchmark::State& state, const SpeedStage& stage, void (*trace)(const RayScene&, Blocked&)) {
    Blocked blocked(kRays);
    trace(*stage.rays, blocked);
    for (std::size_t k = 7; k < kRays; k += kRays / 64 + 1) {
        const VerticalRay ray = vertical_ray(stage.rays->space(), k);
        bool expected         = false;
        for (TriangleId t = 0; t < stage.scene.triangles.size() && !expected; ++t)
            expected = blocks(stage.scene, stage.rays->space(), t, ray);
        if (expected != (blocked[k] != 0)) return state.SkipWithError(fmt::format("ray {} is wrong", k).c_str());
    }
    timed_loop(state, kRays, [&] { trace(*stage.rays, blocked); });
}

void trace_packets(const RayScene& scene, Blocked& blocked) {
    const FlushDenormals flush;
    for (std::size_t first = 0; first < blocked.size(); first += 8) {
        ShadowPacket packet;
        for (std::size_t k = 0; k < 8; ++k) {
            const VerticalRay ray = vertical_ray(scene.space(), first + k);
            packet.org_x[k] = ray.origin.x, packet.org_y[k] = ray.origin.y, packet.org_z[k] = ray.origin.z;
            packet.dir_y[k] = ray.rise, packet.tfar[k] = 1, packet.id[k] = kNoTriangle, packet.valid[k] = -1;
        }
        scene.occluded(packet);
        for (std::size_t k = 0; k < 8; ++k) blocked[first + k] = packet.tfar[k] < 0;
    }
}

void trace_lists(const RayScene& scene, Blocked& blocked) {
    const FlushDenormals flush;
    std::vector<ShadowRay> list(128);
    for (std::size_t first = 0; first < blocked.size(); first += list.size()) {
        for (std::size_t k = 0; k < list.size(); ++k) {
            const VerticalRay ray = vertical_ray(scene.space(), first + k);
            list[k]               = {ray.origin.x, ray.origin.y, ray.origin.z, 0, 0, ray.rise, 0, 0, 1};
        }
        scene.occluded(list);
        for (std::size_t k = 0; k < list.size(); ++k) blocked[first + k] = list[k].tfar < 0;
    }
}

void trace_first_hits(const RayScene& scene, Blocked& blocked) {
    const FlushDenormals flush;
    for (std::size_t k = 0; k < blocked.size(); ++k) {
        const VerticalRay ray = vertical_ray(scene.space(), k);
        blocked[k] =
            scene.first_hit({ray.origin.x, ray.origin.y, ray.origin.z, 0, 0, ray.rise, 0, 0, 1}) != kNoTriangle;
    }
}

/// Points over, under and in the plane x + y + z = 3; `lift` is their height. In the plane, floating point does not
/// decide and rationals do.
void time_signs(benchmark::State& state, float lift, int expected) {
    const vec3 a(3, 0, 0), b(0, 3, 0), c(0, 0, 3);
    const auto work = [&] {
        int sum = 0;
        for (int k = 0; k < 4096; ++k) {
            const float u = static_cast<float>(k % 64) / 64, v = static_cast<float>(k >> 6) / 64;  // exact in binary
            sum += side_of_plane(a, b, c, vec3(u + lift, v, 3 - u - v));
        }
        return sum;
    };
    if (work() != 4096 * expected) return state.SkipWithError("a sign is wrong");
    timed_loop(state, 4096, [&] { benchmark::DoNotOptimize(work()); });
}

void time_facing(benchmark::State& state, const SpeedStage& stage) {
    PointBatch points = stage.points;
    for (auto& of : points.facing) of.assign(points.size(), Facing::none);
    face_lights(points, stage.scene);
    if (points.facing != stage.points.facing) return state.SkipWithError("differs from the first answer");
    timed_loop(state, points.size(), [&] { face_lights(points, stage.scene); });
}

void time_facts(benchmark::State& state, const SpeedStage& stage) {
    if (find_facts(stage.scene).triangles != stage.scene.triangles.size())
        return state.SkipWithError("the number of triangles is wrong");
    timed_loop(state, stage.scene.triangles.size(), [&] { benchmark::DoNotOptimize(find_facts(stage.scene)); });
}

/// Checked: lights add light, so that no pixel is darker where all of them are seen than where none is, and some are
/// brighter.
void time_shading(benchmark::State& state, const SpeedStage& stage) {
    const std::size_t lights = stage.scene.lights.size();
    std::vector<VisibilityPlane> umbra(lights, VisibilityPlane(stage.points.size())), lit = umbra;
    for (VisibilityPlane& plane : lit) plane.s.assign(plane.size(), 1.0f);
    const Image dark = shade(stage.scene, stage.points, umbra), bright = shade(stage.scene, stage.points, lit);
    bool brighter = false;
    for (std::size_t i = 0; i < dark.data.size(); ++i) {
        if (bright.data[i] < dark.data[i]) return state.SkipWithError("a light darkens");
        brighter = brighter || bright.data[i] > dark.data[i];
    }
    if (!brighter) return state.SkipWithError("lights add nothing");
    timed_loop(state, stage.points.size(), [&] { benchmark::DoNotOptimize(shade(stage.scene, stage.points, lit)); });
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    using namespace umbra;
    keep_freed_memory();  // as `umbra` does
    std::deque<SpeedStage> stages;
    add_calibration();
    for (const auto& [name, make] : scenes_of_three_sizes()) {
        SpeedStage& s = stages.emplace_back(SpeedStage{name, make, kWidth, kHeight});
        s.prepare();
        const auto add = [&](const char* kernel, auto function, auto... more) {
            add_benchmark(fmt::format("{}/{}", s.name, kernel), function, std::cref(s), more...);
        };
        add("tree", time_tree);
        add("camera_rays", time_camera_rays);
        add("ray_packets", time_shadow_rays, trace_packets);
        add("ray_lists", time_shadow_rays, trace_lists);
        add("first_hits", time_shadow_rays, trace_first_hits);
        add("facing", time_facing);
        add("facts", time_facts);
        add("shading", time_shading);
    }
    add_benchmark("signs/clear", time_signs, 1.0f, 1);
    add_benchmark("signs/in_plane", time_signs, 0.0f, 0);
    return run_benchmarks({argv, argv + argc});
}
