// Passes of the project beside one another: what a frame is made of, two ways of one method, methods beside rays, one
// thread beside two. Contenders take turns (in_turns.h); before the clock starts their answers are compared, and where
// they differ there is no number. At the end the ratios are printed once more, as a table.
//
//     ratios_benchmark [--scene=FILE] [--size=WxH] [Google Benchmark's options]
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <string_view>

#include "umbra/bench/speed/in_turns.h"
#include "umbra/bench/speed/speed_scenes.h"
#include "umbra/bench/speed/timed_loop.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

/// A scene with its point light alone, and what all passes share, made at the first use.
struct Stage {
    std::string name;
    std::function<Scene()> make;
    int width = 1920, height = 1080;
    Scene scene{};
    SceneFacts facts{};
    std::unique_ptr<RayScene> rays{};
    PointBatch points{};

    void prepare() {
        if (rays) return;
        scene = make();
        scene.lights.resize(1);
        facts  = find_facts(scene);
        rays   = std::make_unique<RayScene>(scene);
        points = primary_points(*rays, scene, scene.camera, width, height);
    }
};

/// A method that is ready to answer. `stage` must outlive it.
struct Ready {
    const Stage& stage;
    std::unique_ptr<const Method> method;
    std::unique_ptr<const Built> built{};
    std::unique_ptr<const Aimed> aimed{};
    VisibilityPlane plane;

    Ready(const Stage& s, std::string_view settings)
        : stage(s), method(parse_method(settings).make()), plane(s.points.size()) {
        build();
        aim();
    }
    void build() {
        aimed.reset(), built.reset();
        method->warm_up(stage.scene, stage.facts);  // nothing, of the methods here
        built = method->build(stage.scene, stage.facts);
    }
    void aim() {
        aimed.reset();
        aimed = method->aim(*built, 0);
    }
    /// A camera's frame of one light: look and visibility.
    void see() { method->visibility(*aimed, *method->look(*built, stage.points), plane.out()); }
    /// A moved object's frame.
    void all() { build(), aim(), see(); }
};

/// Skips the benchmark, and says so, where the mean difference of the answers is above `allowed`.
bool agree(benchmark::State& state, const Ready& a, const Ready& b, double allowed) {
    double difference = 0, count = 0;
    for (std::size_t i = 0; i < a.plane.s.size(); ++i) {
        if (!a.stage.points.asks(0, i)) continue;
        ++count;
        if (a.plane.answer[i] == Answer::undefined || b.plane.answer[i] == Answer::undefined) continue;
        difference += std::abs(static_cast<double>(a.plane.s[i]) - static_cast<double>(b.plane.s[i]));
    }
    if (difference <= allowed * count) return true;
    state.SkipWithError(fmt::format("the answers differ by {} on average", difference / count).c_str());
    return false;
}

/// S_j of one method over that of another.
void time_see(benchmark::State& state, Stage& stage, std::string_view one, std::string_view other, double allowed) {
    stage.prepare();
    for (const std::string_view settings : {one, other})
        if (!parse_method(settings).make()->serves(stage.facts))
            return state.SkipWithError(fmt::format("{} does not serve this scene", settings).c_str());
    Ready a(stage, one), b(stage, other);
    a.see(), b.see();
    if (!agree(state, a, b, allowed)) return;
    in_turns(state, fmt::format("{}: S_j of {}", stage.name, one), [&] { a.see(); },
             {{std::string(other), [&] { b.see(); }}});
}

/// Build, aim and S_j of one method over those of another.
void time_all(benchmark::State& state, Stage& stage, std::string_view one, std::string_view other, double allowed) {
    stage.prepare();
    Ready a(stage, one), b(stage, other);
    a.see(), b.see();
    if (!agree(state, a, b, allowed)) return;
    in_turns(state, fmt::format("{}: build, aim, S_j of {}", stage.name, one), [&] { a.all(); },
             {{std::string(other), [&] { b.all(); }}});
}

/// What a light that moved costs before S_j is asked for, over a moved object's frame.
void time_aim(benchmark::State& state, Stage& stage, std::string_view settings) {
    stage.prepare();
    if (!parse_method(settings).make()->serves(stage.facts))
        return state.SkipWithError(fmt::format("{} does not serve this scene", settings).c_str());
    Ready aimed(stage, settings), all(stage, settings);
    aimed.aim();  // once more, as below
    aimed.see(), all.all();
    if (!agree(state, aimed, all, 0)) return;
    in_turns(state, fmt::format("{}: aim of {}", stage.name, settings), [&] { aimed.aim(); },
             {{"build, aim, S_j", [&] { all.all(); }}});
}

/// The sum over the G-buffer.
void time_sum(benchmark::State& state, Stage& stage) {
    stage.prepare();
    Ready rays(stage, "ray_traced");
    rays.see();
    PointBatch points;
    in_turns(state, stage.name + ": the sum",
             [&] {
                 const Image picture = shade(stage.scene, stage.points, {&rays.plane, 1});
                 benchmark::DoNotOptimize(&picture);
             },
             {{"G-buffer", [&] {
                   primary_points(*stage.rays, stage.scene, stage.scene.camera, stage.width, stage.height, points);
               }}});
}

/// The sum over a loop that reads the same planes and writes the same picture, and computes nothing.
void time_sum_of_memory(benchmark::State& state, Stage& stage) {
    stage.prepare();
    Ready rays(stage, "ray_traced");
    rays.see();
    const PointBatch& p = stage.points;
    const auto touch    = [&] {
        Image picture(stage.width, stage.height, {"R", "G", "B"});
        float* const to = picture.data.data();
        parallel_ranges(p.size(), 16384, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const float read = p.px[i] + p.py[i] + p.pz[i] + p.nx[i] + p.ny[i] + p.nz[i] + p.u[i] + p.v[i] +
                                   rays.plane.s[i] + static_cast<float>(p.triangle[i]);
                to[3 * i] = read, to[3 * i + 1] = read, to[3 * i + 2] = read;
            }
        });
        benchmark::DoNotOptimize(picture.data.data());
    };
    in_turns(state, stage.name + ": the sum, over its memory",
             [&] {
                 const Image picture = shade(stage.scene, p, {&rays.plane, 1});
                 benchmark::DoNotOptimize(picture.data.data());
             },
             {{"reading and writing", touch}});
}

/// One thread over two.
void time_threads(benchmark::State& state, Stage& stage, std::string_view settings) {
    stage.prepare();
    if (!parse_method(settings).make()->serves(stage.facts))
        return state.SkipWithError(fmt::format("{} does not serve this scene", settings).c_str());
    Ready one(stage, settings), two(stage, settings);
    const auto see = [](Ready& ready, int threads) {
        const ThreadLimit limit(threads);
        ready.see();
    };
    see(one, 1), see(two, 2);
    if (!agree(state, one, two, 0)) return;
    in_turns(state, fmt::format("{}: S_j of {}, one thread", stage.name, settings), [&] { see(one, 1); },
             {{"two threads", [&] { see(two, 2); }}});
}

void add_stage(Stage& s) {
    const auto add = [&](const std::string& pass, auto&& function) {
        benchmark::RegisterBenchmark((s.name + "/" + pass).c_str(), function)
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond)
            ->Iterations(5);
    };
    const auto see = [&](const std::string& pass, const char* one, const char* other, double allowed) {
        add(pass, [&s, one, other, allowed](benchmark::State& state) { time_see(state, s, one, other, allowed); });
    };
    add("sum/gbuffer", [&s](benchmark::State& state) { time_sum(state, s); });
    add("sum/memory", [&s](benchmark::State& state) { time_sum_of_memory(state, s); });
    see("pcf/nearest", "shadow_zbuffer:filter=pcf", "shadow_zbuffer", 0.05);
    see("depth_fail/depth_pass", "shadow_volumes:counting=depth_fail", "shadow_volumes", 1e-5);
    see("planar/rays", "planar_projection", "ray_traced", 0.002);
    add("planar/rays/object_moved",
        [&s](benchmark::State& state) { time_all(state, s, "planar_projection", "ray_traced", 0.002); });
    see("exact/rays", "exact", "ray_traced", 0.002);
    see("alias_free/rays", "alias_free", "ray_traced", 0.002);
    add("alias_free/rays/object_moved",
        [&s](benchmark::State& state) { time_all(state, s, "alias_free", "ray_traced", 0.002); });
    for (const char* settings : {"shadow_zbuffer:resolution=2048", "shadow_volumes"})
        add(fmt::format("aim/{}", settings), [&s, settings](benchmark::State& state) { time_aim(state, s, settings); });
    for (const char* settings : {"planar_projection", "shadow_volumes", "shadow_zbuffer", "shadow_zbuffer:filter=pcf",
                                 "alias_free", "ray_traced", "exact"})
        add(fmt::format("threads/{}", settings),
            [&s, settings](benchmark::State& state) { time_threads(state, s, settings); });
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    using namespace umbra;
    keep_freed_memory();  // as `umbra` does
    const SpeedLine line(argc, argv);
    std::deque<Stage> stages;
    stages.push_back({"simple", simple_scene});
    stages.push_back({"tori", [] { return tori_scene(125, 64); }});
    for (const std::string& file : line.scenes) stages.push_back({"file", [file] { return load_scene(file); }});
    for (Stage& s : stages) {
        s.width = line.size.width, s.height = line.size.height;
        add_stage(s);
    }
    const int code = run_benchmarks(line.rest);
    print_ratios();
    return code;
}
