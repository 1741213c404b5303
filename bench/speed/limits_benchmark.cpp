// How close the G-buffer, one S_j pass and the build come to bare Embree loops on the same scene.
//
// Ours and the bare loops take turns (in_turns.h); ours is divided by the fastest of them. Before the clock starts the
// answers are compared, and a wrong one gets no number. Passes also take turns with loops that touch the memory that
// they must touch, and compute nothing. At the end the ratios are printed once more, as a table.
//
//     limits_benchmark [--scene=FILE] [--size=WxH] [Google Benchmark's options]
#if __has_include(<embree3/rtcore.h>)
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>

#include "umbra/bench/speed/in_turns.h"
#include "umbra/bench/speed/speed_scenes.h"
#include "umbra/bench/speed/timed_loop.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

// ---- scenes --------------------------------------------------------------------------------------------------------

Scene file_scene(const std::string& file) {
    Scene scene     = load_scene(file);
    const Box box   = bounds(scene);
    const vec3 size = vec3(box.diagonal());
    add_lights(scene, box.centre() + size * vec3(0.5f, 1, 0.4f), box.centre(), 0.2f * size.x);
    return scene;
}

// ---- bare Embree ---------------------------------------------------------------------------------------------------

/// Embree without anything around it. `flags`: RTC_SCENE_FLAG_NONE is its fastest, ROBUST what core/ray uses.
class Bare {
public:
    Bare(const Scene& scene, RTCSceneFlags flags) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        std::copy(scene.positions.begin(), scene.positions.end(),
                  static_cast<vec3*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                                             scene.positions.size())));
        std::copy(scene.triangles.begin(), scene.triangles.end(),
                  static_cast<uvec3*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                                              scene.triangles.size())));
        rtcCommitGeometry(g);
        rtcAttachGeometry(scene_, g);
        rtcReleaseGeometry(g);
        rtcSetSceneFlags(scene_, flags);
        rtcCommitScene(scene_);
    }
    ~Bare() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Bare(const Bare&)            = delete;
    Bare& operator=(const Bare&) = delete;

    void intersect(const int* valid, RTCRayHit8& rays) const {
#if RTC_VERSION_MAJOR >= 4
        RTCIntersectArguments a;
        rtcInitIntersectArguments(&a);
        a.flags = RTC_RAY_QUERY_FLAG_COHERENT;
        rtcIntersect8(valid, scene_, &rays, &a);
#else
        RTCIntersectContext c;
        rtcInitIntersectContext(&c);
        c.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcIntersect8(valid, scene_, &c, &rays);
#endif
    }
    void occluded(const int* valid, RTCRay8& rays) const {
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded8(valid, scene_, &rays);
#else
        RTCIntersectContext c;
        rtcInitIntersectContext(&c);
        rtcOccluded8(valid, scene_, &c, &rays);
#endif
    }
    void occluded(RTCRay* rays, unsigned count) const {
#if RTC_VERSION_MAJOR >= 4  // has no streams
        for (unsigned k = 0; k < count; ++k) rtcOccluded1(scene_, rays + k);
#else
        RTCIntersectContext c;
        rtcInitIntersectContext(&c);
        rtcOccluded1M(scene_, &c, rays, count, sizeof(RTCRay));
#endif
    }

private:
    RTCDevice device_;
    RTCScene scene_;
};

struct BareGBuffer {
    std::vector<float> px, py, pz, nx, ny, nz;
    std::vector<std::uint32_t> triangle;
};

constexpr int kTileWidth = 16, kTileHeight = 8, kMostSamples = 64;

template <class Tile>
void for_tiles(int width, int height, const Tile& tile) {
    const int across = width / kTileWidth;
    parallel_ranges(static_cast<std::size_t>(across * (height / kTileHeight)), 8, [&](std::size_t b, std::size_t e) {
        const FlushDenormals flush;
        for (std::size_t i = b; i < e; ++i)
            tile(static_cast<int>(i) % across * kTileWidth, static_cast<int>(i) / across * kTileHeight);
    });
}

/// `claims`: has the processor load the memory that a tile is written to before its rays are traced, as the project
/// does.
void bare_gbuffer(const Bare& bare, const CameraFrame& f, BareGBuffer& g, bool claims) {
    const std::size_t pixels = static_cast<std::size_t>(f.width) * static_cast<std::size_t>(f.height);
    for (auto* plane : {&g.px, &g.py, &g.pz, &g.nx, &g.ny, &g.nz}) plane->resize(pixels);
    g.triangle.resize(pixels);
    const vec3 eye(f.eye), forward(f.forward), right(f.right * f.half_width), up(f.up * f.half_height);
    const float sx = 2.0f / static_cast<float>(f.width), sy = 2.0f / static_cast<float>(f.height);
    for_tiles(f.width, f.height, [&](int x0, int y0) {
        alignas(32) const int valid[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
        if (claims)
            PointTile{static_cast<std::size_t>(x0), static_cast<std::size_t>(y0), static_cast<std::size_t>(f.width),
                      static_cast<std::size_t>(f.height), pixels}
                .load_for_writing(g.triangle, g.px, g.py, g.pz, g.nx, g.ny, g.nz);
        for (int y = y0; y < y0 + kTileHeight; y += 2)
            for (int x = x0; x < x0 + kTileWidth; x += 4) {
                RTCRayHit8 h;
                vec3 d[8];
                for (int k = 0; k < 8; ++k) {
                    d[k] = forward + right * (sx * (static_cast<float>(x + (k & 3)) + 0.5f) - 1) -
                           up * (sy * (static_cast<float>(y + (k >> 2)) + 0.5f) - 1);
                    h.ray.org_x[k] = eye.x, h.ray.org_y[k] = eye.y, h.ray.org_z[k] = eye.z;
                    h.ray.dir_x[k] = d[k].x, h.ray.dir_y[k] = d[k].y, h.ray.dir_z[k] = d[k].z;
                    h.ray.tnear[k] = 0, h.ray.tfar[k] = kInfinity, h.ray.time[k] = 0;
                    h.ray.mask[k] = ~0u, h.ray.flags[k] = 0, h.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
                }
                bare.intersect(valid, h);
                for (int k = 0; k < 8; ++k) {
                    const int i   = (y + (k >> 2)) * f.width + x + (k & 3);
                    g.triangle[i] = kNoTriangle;
                    if (h.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
                    g.triangle[i] = h.hit.primID[k];
                    vec3 n        = glm::normalize(vec3(h.hit.Ng_x[k], h.hit.Ng_y[k], h.hit.Ng_z[k]));
                    if (glm::dot(n, d[k]) > 0) n = -n;
                    const vec3 p = eye + d[k] * h.ray.tfar[k] + n * 1e-3f;
                    g.px[i] = p.x, g.py[i] = p.y, g.pz[i] = p.z, g.nx[i] = n.x, g.ny[i] = n.y, g.nz[i] = n.z;
                }
            }
    });
}

/// Bare shadow rays from its own G-buffer; visible samples a pixel. Jitters across x across of them; one is aimed at
/// the centre.
struct BareShadows {
    const Bare& bare;
    const CameraFrame& frame;
    const BareGBuffer& g;
    const Light& light;
    int across;
    std::vector<std::uint8_t> seen;
    int samples = across * across;

    [[nodiscard]] bool facing(int i) const {
        const vec3 d = light.position - vec3(g.px[i], g.py[i], g.pz[i]);
        return g.triangle[i] != kNoTriangle && g.nx[i] * d.x + g.ny[i] * d.y + g.nz[i] * d.z > 0;
    }
    [[nodiscard]] vec3 target(int k, std::uint32_t& random) const {
        if (samples == 1) return light.position;
        const auto next = [&] {
            random = random * 1664525u + 1013904223u;
            return static_cast<float>(random >> 8) * 0x1p-24f;
        };
        const int column = k % across, row = k / across;
        const float u = (static_cast<float>(column) + next()) / static_cast<float>(across) - 0.5f;
        const float v = (static_cast<float>(row) + next()) / static_cast<float>(across) - 0.5f;
        return light.position + light.edge_u * u + light.edge_v * v;
    }

    void packets() {
        for_tiles(frame.width, frame.height, [&](int x0, int y0) {
            auto random = static_cast<std::uint32_t>(y0 * frame.width + x0);
            RTCRay8 r;
            for (int k = 0; k < 8; ++k) r.tnear[k] = 0, r.time[k] = 0, r.mask[k] = ~0u, r.flags[k] = 0, r.id[k] = 0;
            alignas(32) int valid[8];
            const auto aim = [&](int k, int i, vec3 at) {
                r.org_x[k] = g.px[i], r.org_y[k] = g.py[i], r.org_z[k] = g.pz[i];
                r.dir_x[k] = at.x - g.px[i], r.dir_y[k] = at.y - g.py[i], r.dir_z[k] = at.z - g.pz[i];
                r.tfar[k] = 0.9999f;
            };
            if (samples == 1) {
                for (int y = y0; y < y0 + kTileHeight; y += 2)
                    for (int x = x0; x < x0 + kTileWidth; x += 4) {
                        int any = 0;
                        for (int k = 0; k < 8; ++k) {
                            const int i = (y + (k >> 2)) * frame.width + x + (k & 3);
                            valid[k]    = facing(i) ? -1 : 0;
                            any |= valid[k];
                            aim(k, i, light.position);
                        }
                        if (any == 0) continue;
                        bare.occluded(valid, r);
                        for (int k = 0; k < 8; ++k)
                            if (valid[k] != 0) seen[(y + (k >> 2)) * frame.width + x + (k & 3)] = r.tfar[k] >= 0;
                    }
                return;
            }
            std::fill_n(valid, 8, -1);
            for (int y = y0; y < y0 + kTileHeight; ++y)
                for (int x = x0; x < x0 + kTileWidth; ++x) {
                    const int i = y * frame.width + x;
                    if (!facing(i)) continue;
                    int n = 0;
                    for (int first = 0; first < samples; first += 8) {
                        for (int k = 0; k < 8; ++k) aim(k, i, target(first + k, random));
                        bare.occluded(valid, r);
                        for (int k = 0; k < 8; ++k) n += r.tfar[k] >= 0;
                    }
                    seen[i] = static_cast<std::uint8_t>(n);
                }
        });
    }

    void streams() {
        for_tiles(frame.width, frame.height, [&](int x0, int y0) {
            auto random = static_cast<std::uint32_t>(y0 * frame.width + x0);
            alignas(64) static thread_local RTCRay rays[kTileWidth * kTileHeight * kMostSamples];
            static thread_local int pixel[kTileWidth * kTileHeight * kMostSamples];
            unsigned count = 0;
            for (int y = y0; y < y0 + kTileHeight; ++y)
                for (int x = x0; x < x0 + kTileWidth; ++x) {
                    const int i = y * frame.width + x;
                    if (!facing(i)) continue;
                    seen[i] = 0;
                    for (int k = 0; k < samples; ++k) {
                        const vec3 at = target(k, random);
                        pixel[count]  = i;
                        rays[count++] = {
                            g.px[i], g.py[i], g.pz[i], 0, at.x - g.px[i], at.y - g.py[i], at.z - g.pz[i], 0,
                            0.9999f, ~0u,     0,       0};
                    }
                }
            if (count > 0) bare.occluded(rays, count);
            for (unsigned k = 0; k < count; ++k)
                seen[pixel[k]] = static_cast<std::uint8_t>(seen[pixel[k]] + (rays[k].tfar >= 0));
        });
    }
};

// ---- the passes ----------------------------------------------------------------------------------------------------

/// One scene with what all passes need, made at the first use.
struct Bench : SpeedStage {
    std::unique_ptr<Bare> fast{}, robust{};
    BareGBuffer bare_points{};

    void prepare() {
        if (rays) return;
        SpeedStage::prepare();
        fast   = std::make_unique<Bare>(scene, RTC_SCENE_FLAG_NONE);
        robust = std::make_unique<Bare>(scene, RTC_SCENE_FLAG_ROBUST);
        bare_gbuffer(*fast, *points.raster, bare_points, true);
    }
};

void time_build(benchmark::State& state, Bench& bench) {
    bench.prepare();
    in_turns(state, bench.name + "/build", [&] { RayScene(bench.scene); },
             {{"bare", [&] { Bare(bench.scene, RTC_SCENE_FLAG_NONE); }},
              {"robust", [&] { Bare(bench.scene, RTC_SCENE_FLAG_ROBUST); }}});
    state.counters["triangles"] = static_cast<double>(bench.scene.triangles.size());
}

/// Against loops as they are usually written, or `claims`.
void time_gbuffer(benchmark::State& state, Bench& bench, bool claims) {
    bench.prepare();
    std::size_t differ = 0;
    for (std::size_t i = 0; i < bench.points.size(); ++i)
        differ += bench.points.triangle[i] != bench.bare_points.triangle[i];
    if (differ * 2000 > bench.points.size())  // rays through edges may go either way
        return state.SkipWithError(fmt::format("{} pixels see other triangles", differ).c_str());
    BareGBuffer scratch;
    PointBatch points;
    const CameraFrame f = *bench.points.raster;
    in_turns(state, bench.name + (claims ? "/gbuffer_claimed" : "/gbuffer"), [&] { bench.find_points(points); },
             {{"bare", [&] { bare_gbuffer(*bench.fast, f, scratch, claims); }},
              {"robust", [&] { bare_gbuffer(*bench.robust, f, scratch, claims); }}});
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * bench.points.size()));
}

/// `across`: light samples are across times across.
void time_visibility(benchmark::State& state, Bench& bench, LightId light, int across) {
    bench.prepare();
    const int samples = across * across;
    const auto method = parse_method(fmt::format("ray_traced:samples={}", samples)).make();
    const auto built  = method->build(bench.scene, bench.facts);
    const auto aimed  = method->aim(*built, light);
    VisibilityPlane plane(bench.points.size());
    const std::vector<float>& s = plane.s;
    const CameraFrame f         = *bench.points.raster;
    const auto shadows          = [&](const Bare& bare) {
        return BareShadows{bare,
                           f,
                           bench.bare_points,
                           bench.scene.lights[light],
                           across,
                           std::vector<std::uint8_t>(bench.points.size())};
    };
    BareShadows fast = shadows(*bench.fast), robust = shadows(*bench.robust);
    const auto ours = [&] { method->visibility(*aimed, *method->look(*built, bench.points), plane.out()); };

    ours();
    fast.packets();
    double difference = 0, count = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (bench.points.facing[light][i] < Facing::front) continue;
        difference += std::abs(static_cast<double>(s[i]) - fast.seen[i] / static_cast<double>(samples));
        ++count;
    }
    if (difference > count * (samples == 1 ? 0.002 : 0.02))
        return state.SkipWithError(fmt::format("differs from bare rays by {} on average", difference / count).c_str());

    std::vector<Contender> bare{{"packet", [&] { fast.packets(); }},
                                {"stream", [&] { fast.streams(); }},
                                {"robust_packet", [&] { robust.packets(); }},
                                {"robust_stream", [&] { robust.streams(); }}};
    in_turns(state, fmt::format("{}/{}", bench.name, light == 0 ? "point" : fmt::format("area{}", samples)), ours,
             bare);
    state.counters["difference"] = difference / count;
    state.SetItemsProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) * count * samples));
}

// ---- what a pass must touch ----------------------------------------------------------------------------------------

/// Against a loop that writes the arrays of a batch and computes nothing.
void time_gbuffer_touched(benchmark::State& state, Bench& bench) {
    bench.prepare();
    PointBatch points, touched = bench.points;
    const auto touch = [&] {
        parallel_ranges(touched.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
            const auto fill = [&](auto& array, auto value) {
                std::fill(array.begin() + static_cast<std::ptrdiff_t>(begin),
                          array.begin() + static_cast<std::ptrdiff_t>(end), value);
            };
            fill(touched.triangle, TriangleId{1});
            for (auto* array :
                 {&touched.u, &touched.v, &touched.px, &touched.py, &touched.pz, &touched.nx, &touched.ny, &touched.nz})
                fill(*array, 1.0f);
            fill(touched.flipped, std::uint8_t{1});
            for (auto& facing : touched.facing) fill(facing, Facing::front);
        });
        benchmark::ClobberMemory();
    };
    in_turns(state, bench.name + "/gbuffer_touched", [&] { bench.find_points(points); }, {{"touch", touch}});
    state.counters["bytes_a_point"] =
        sizeof(TriangleId) + 8 * sizeof(float) + 1 + static_cast<double>(touched.facing.size());
}

/// Against a loop that reads triangle, position and facing of each point, and writes S_j.
void time_visibility_touched(benchmark::State& state, Bench& bench, const char* text) {
    bench.prepare();
    const auto method = parse_method(text).make();
    if (!verdict(*method, bench.facts)) return state.SkipWithError("does not serve");
    const auto built  = method->build(bench.scene, bench.facts);
    const auto aimed  = method->aim(*built, 0);
    const auto looked = method->look(*built, bench.points);
    VisibilityPlane plane(bench.points.size());
    std::vector<float> touched(bench.points.size());
    const PointBatch& points = bench.points;
    const auto touch         = [&] {
        parallel_ranges(points.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                touched[i] = points.asks(0, i) && points.triangle[i] != kNoTriangle
                                         ? points.px[i] + points.py[i] + points.pz[i]
                                         : 0.0f;
        });
        benchmark::ClobberMemory();
    };
    in_turns(state, fmt::format("{}/touched/{}", bench.name, text),
             [&] { method->visibility(*aimed, *looked, plane.out()); }, {{"touch", touch}});
    state.counters["bytes_a_point"] = sizeof(TriangleId) + 4 * sizeof(float) + sizeof(Facing);
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    using namespace umbra;
    keep_freed_memory();  // as `umbra` does
    std::deque<Bench> benches;
    const SpeedLine line(argc, argv);
    // The bare loops know whole tiles only.
    const int width      = std::max(1, line.size.width / kTileWidth) * kTileWidth;
    const int height     = std::max(1, line.size.height / kTileHeight) * kTileHeight;
    const auto add_bench = [&](const char* name, std::function<Scene()> make) {
        Bench& bench   = benches.emplace_back(Bench{{name, std::move(make), width, height}});
        const auto add = [&](const std::string& pass, int rounds, auto function, auto... more) {
            add_benchmark(bench.name + "/" + pass, function, std::ref(bench), more...)->Iterations(rounds);
        };
        add("build", 5, time_build);
        add("gbuffer", 11, time_gbuffer, false);
        add("gbuffer_claimed", 11, time_gbuffer, true);
        add("point", 11, time_visibility, LightId{0}, 1);
        add("area16", 5, time_visibility, LightId{1}, 4);
        add("area64", 5, time_visibility, LightId{1}, 8);
        add("gbuffer_touched", 11, time_gbuffer_touched);
        for (const char* text : {"ray_traced", "shadow_zbuffer", "shadow_zbuffer:filter=pcf", "planar_projection",
                                 "exact", "shadow_volumes", "shadow_volumes:counting=depth_fail"})
            add(fmt::format("touched/{}", text), 9, time_visibility_touched, text);
    };
    add_bench("simple", simple_scene);
    add_bench("tori", [] { return tori_scene(125, 64); });
    for (const std::string& file : line.scenes) add_bench("file", [file] { return file_scene(file); });
    const int code = run_benchmarks(line.rest);
    print_ratios();
    return code;
}
