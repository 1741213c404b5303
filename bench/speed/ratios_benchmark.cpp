// Passes of the project beside one another: what a frame is made of, two ways of one method, methods beside rays, one
// thread beside two. Contenders take turns (in_turns.h); before the clock starts their answers are compared, and where
// they differ there is no number. At the end the ratios are printed once more, as a table.
//
//     ratios_benchmark [--scene=FILE] [--size=WxH] [Google Benchmark's options]
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <string_view>

#include "umbra/bench/speed/in_turns.h"
#include "umbra/bench/speed/speed_scenes.h"
#include "umbra/bench/speed/timed_loop.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/shade.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

/// A method that is ready to answer. `stage` must outlive it.
struct Ready {
    const SpeedStage& stage;
    std::unique_ptr<const Method> method;
    std::unique_ptr<const Built> built{};
    std::unique_ptr<const Aimed> aimed{};
    VisibilityPlane plane;

    Ready(const SpeedStage& s, std::string_view settings)
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

/// A method, the name of its work in the table, and the work.
struct Side {
    std::string_view settings;
    std::string name;
    void (*work)(Ready&);
    void (*answer)(Ready&) = work;  ///< the work, and S_j where that is no part of it
};
void see(Ready& ready) { ready.see(); }
void all(Ready& ready) { ready.all(); }

/// One method's work over that of another, whose answers may differ by `allowed` on average.
void time_pair(benchmark::State& state, SpeedStage& stage, const Side& one, const Side& other, double allowed) {
    stage.prepare();
    for (const Side* side : {&one, &other})
        if (!parse_method(side->settings).make()->serves(stage.facts))
            return state.SkipWithError(fmt::format("{} does not serve this scene", side->settings).c_str());
    Ready a(stage, one.settings), b(stage, other.settings);
    one.answer(a), other.answer(b);
    if (!agree(state, a, b, allowed)) return;
    in_turns(state, fmt::format("{}: {}", stage.name, one.name), [&] { one.work(a); },
             {{other.name, [&] { other.work(b); }}});
}

/// The sum over the G-buffer, or over a loop that reads the same planes and writes the same picture, and computes
/// nothing.
void time_sum(benchmark::State& state, SpeedStage& stage, bool over_memory) {
    stage.prepare();
    Ready rays(stage, "ray_traced");
    rays.see();
    const PointBatch& p = stage.points;
    PointBatch points;
    const auto touch = [&] {
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
    const auto sum = [&] {
        const Image picture = shade(stage.scene, p, {&rays.plane, 1});
        benchmark::DoNotOptimize(picture.data.data());
    };
    if (over_memory)
        in_turns(state, stage.name + ": the sum, over its memory", sum, {{"reading and writing", touch}});
    else
        in_turns(state, stage.name + ": the sum", sum, {{"G-buffer", [&] { stage.find_points(points); }}});
}

void see_on_threads(Ready& ready, int threads) {
    const ThreadLimit limit(threads);
    ready.see();
}

void add_stage(SpeedStage& s) {
    const auto add = [&](const std::string& pass, auto function, auto... more) {
        add_benchmark(s.name + "/" + pass, function, std::ref(s), more...)->Iterations(5);
    };
    const auto add_see = [&](const char* pass, const char* one, const char* other, double allowed) {
        add(pass, time_pair, Side{one, fmt::format("S_j of {}", one), see}, Side{other, other, see}, allowed);
    };
    const auto add_all = [&](const char* pass, const char* one, const char* other, double allowed) {
        add(pass, time_pair, Side{one, fmt::format("build, aim, S_j of {}", one), all}, Side{other, other, all},
            allowed);
    };
    add("sum/gbuffer", time_sum, false);
    add("sum/memory", time_sum, true);
    add_see("pcf/nearest", "shadow_zbuffer:filter=pcf", "shadow_zbuffer", 0.05);
    add_see("depth_fail/depth_pass", "shadow_volumes:counting=depth_fail", "shadow_volumes", 1e-5);
    add_see("planar/rays", "planar_projection", "ray_traced", 0.002);
    add_all("planar/rays/object_moved", "planar_projection", "ray_traced", 0.002);
    add_see("exact/rays", "exact", "ray_traced", 0.002);
    add_see("alias_free/rays", "alias_free", "ray_traced", 0.002);
    add_all("alias_free/rays/object_moved", "alias_free", "ray_traced", 0.002);
    // A light that moved, before S_j is asked for, over a moved object's frame.
    for (const char* settings : {"shadow_zbuffer:resolution=2048", "shadow_volumes"})
        add(fmt::format("aim/{}", settings), time_pair,
            Side{settings, fmt::format("aim of {}", settings), [](Ready& r) { r.aim(); },
                 [](Ready& r) { r.aim(), r.see(); }},
            Side{settings, "build, aim, S_j", all}, 0.0);
    for (const char* settings : {"planar_projection", "shadow_volumes", "shadow_zbuffer", "shadow_zbuffer:filter=pcf",
                                 "alias_free", "ray_traced", "exact"})
        add(fmt::format("threads/{}", settings), time_pair,
            Side{settings, fmt::format("S_j of {}, one thread", settings), [](Ready& r) { see_on_threads(r, 1); }},
            Side{settings, "two threads", [](Ready& r) { see_on_threads(r, 2); }}, 0.0);
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    using namespace umbra;
    keep_freed_memory();  // as `umbra` does
    const SpeedLine line(argc, argv);
    std::deque<SpeedStage> stages;
    const auto add = [&](const char* name, std::function<Scene()> make) {
        stages.push_back({name, with_point_light_alone(std::move(make)), line.size.width, line.size.height});
        add_stage(stages.back());
    };
    add("simple", simple_scene);
    add("tori", [] { return tori_scene(125, 64); });
    for (const std::string& file : line.scenes) add("file", [file] { return load_scene(file); });
    const int code = run_benchmarks(line.rest);
    print_ratios();
    return code;
}
