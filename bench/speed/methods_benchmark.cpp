// Every method x phase x scene, and visibility by threads and by resolution. SCENE/METHOD/PHASE, milliseconds:
//
//     small     9,000 triangles, medium 65,000, million 1,024,000 (speed_scenes.h); 640x360 pixels, or as the name says
//     build     geometry alone; aim: one point light; look: the points alone, for all lights; point, area: visibility
//               of that light, of a rectangle light (methods without penumbrae get a scene that has the point light
//               alone)
//
// A method that is too slow for a whole picture answers for a sample of its points; the label says how many. Before the
// clock starts the answers are compared with those of `exact`, and a method whose answers are wrong is not timed.
//
//     methods_benchmark [Google Benchmark's options]
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "umbra/bench/speed/speed_scenes.h"
#include "umbra/bench/speed/timed_loop.h"
#include "umbra/core/base/memory.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

constexpr LightId kPoint = 0, kArea = 1;
constexpr std::size_t kChecked = 512;   ///< points that answers are compared at
constexpr std::size_t kSampled = 2048;  ///< points that a slow method is asked for

constexpr Size kUsual{640, 360};

/// A scene with what all methods share.
struct Stage : SpeedStage {
    std::map<int, PointBatch> other_points{};       ///< at other sizes, by width
    std::map<LightId, VisibilityPlane> expected{};  ///< at `checked`
    std::vector<std::uint32_t> checked{};
    std::map<std::string, std::optional<std::string>> verdicts{};  ///< of "METHOD LIGHT": what is wrong with it

    const PointBatch& at(Size size) {
        if (size.width == width) return points;
        auto [found, added] = other_points.try_emplace(size.width);
        if (added) found->second = primary_points(*rays, scene, scene.camera, size.width, size.height);
        return found->second;
    }
};

std::vector<std::uint32_t> spread(const PointBatch& points, std::size_t wanted) {
    std::vector<std::uint32_t> surface;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] != kNoTriangle) surface.push_back(i);
    std::vector<std::uint32_t> some;
    for (std::size_t k = 0; k < wanted && !surface.empty(); ++k) some.push_back(surface[k * surface.size() / wanted]);
    return some;
}

/// Too slow for a whole picture: exact visibility of an area light, and every point against every triangle.
bool is_slow(const MethodInfo& info, LightId light) {
    return info.name == "brute_force" || (info.reference && light == kArea);
}

/// Too slow even once: polygons of a million triangles are clipped for minutes.
bool is_hopeless(const MethodInfo& info, const Stage& stage) {
    return info.name == "atherton_weiler" && stage.scene.triangles.size() > 100'000;
}

PointBatch points_for(Stage& stage, const MethodInfo& info, LightId light, Size size) {
    const PointBatch& all = stage.at(size);
    return is_slow(info, light) ? pick(all, spread(all, kSampled)) : all;
}

std::unique_ptr<const Built> build(const Method& method, const Stage& stage) {
    method.warm_up(stage.scene, stage.facts);
    return method.build(stage.scene, stage.facts);
}

VisibilityPlane answers(const Stage& stage, const MethodInfo& info, const PointBatch& points, LightId light) {
    const auto method = info.make();
    const auto built  = build(*method, stage);
    VisibilityPlane plane(points.size());
    method->visibility(*method->aim(*built, light), *method->look(*built, points), plane.out());
    return plane;
}

/// What is wrong with a method's answers for a light: where `exact` says that all of it or none of it is seen, at most
/// 1 % of the points may be off by half. The worst method of the report, the shadow z-buffer, has 0.04 % of its points
/// wrong; one that answers at random has 50 %.
std::optional<std::string> what_is_wrong(Stage& stage, const MethodInfo& info, LightId light) {
    const PointBatch& all = stage.points;
    if (stage.checked.empty()) stage.checked = spread(all, kChecked);
    const PointBatch checked = pick(all, stage.checked);
    auto [expected, unknown] = stage.expected.try_emplace(light);
    if (unknown) expected->second = answers(stage, find_method("exact"), checked, light);
    const bool whole             = info.needs_raster;
    const VisibilityPlane mine   = answers(stage, info, whole ? all : checked, light);
    const VisibilityPlane& truth = expected->second;
    std::size_t compared = 0, wrong = 0;
    for (std::size_t k = 0; k < checked.size(); ++k) {
        const std::size_t i = whole ? stage.checked[k] : k;
        if (!checked.asks(light, k) || !mine.defined(i) || truth.answer[k] != Answer::given) continue;
        if (truth.s[k] > 0 && truth.s[k] < 1) continue;
        ++compared;
        wrong += !(std::abs(mine.s[i] - truth.s[k]) < 0.5f);
    }
    if (compared == 0) return "no point to compare at";
    if (100 * wrong > compared) return fmt::format("wrong at {} of {} points", wrong, compared);
    return std::nullopt;
}

bool refused(benchmark::State& state, Stage& stage, const MethodInfo& info, LightId light) {
    auto [found, added] = stage.verdicts.try_emplace(fmt::format("{} {}", info.name, light));
    if (added) found->second = what_is_wrong(stage, info, light);
    if (found->second) state.SkipWithError(found->second->c_str());
    return found->second.has_value();
}

void time_build(benchmark::State& state, Stage& stage, const MethodInfo& info) {
    if (refused(state, stage, info, kPoint)) return;
    const auto method = info.make();
    std::unique_ptr<const Built> built;
    timed_loop(
        state, stage.scene.triangles.size(), [&] { built = method->build(stage.scene, stage.facts); },
        [&] { built.reset(), method->warm_up(stage.scene, stage.facts); });
    state.counters["memory_bytes"] = static_cast<double>(built->memory_bytes());
}

void time_aim(benchmark::State& state, Stage& stage, const MethodInfo& info) {
    if (refused(state, stage, info, kPoint)) return;
    const auto method = info.make();
    const auto built  = build(*method, stage);
    std::unique_ptr<const Aimed> aimed;
    timed_loop(
        state, 0, [&] { aimed = method->aim(*built, kPoint); }, [&] { aimed.reset(); });
    state.counters["memory_bytes"] = static_cast<double>(built->memory_bytes() + aimed->memory_bytes());
}

void time_look(benchmark::State& state, Stage& stage, const MethodInfo& info) {
    if (refused(state, stage, info, kPoint)) return;
    const PointBatch points = points_for(stage, info, kPoint, kUsual);
    const auto method       = info.make();
    const auto built        = build(*method, stage);
    std::unique_ptr<const Looked> looked;
    timed_loop(
        state, points.size(), [&] { looked = method->look(*built, points); }, [&] { looked.reset(); });
    state.counters["memory_bytes"] = static_cast<double>(looked->memory_bytes());
    if (is_slow(info, kPoint)) state.SetLabel(fmt::format("{} points", points.size()));
}

void time_visibility(benchmark::State& state, Stage& stage, const MethodInfo& info, LightId light, Size size,
                     int threads) {
    if (refused(state, stage, info, light)) return;
    const ThreadLimit limit(threads);
    const PointBatch points = points_for(stage, info, light, size);
    const auto method       = info.make();
    const auto built        = build(*method, stage);
    const auto aimed        = method->aim(*built, light);
    const auto looked       = method->look(*built, points);
    VisibilityPlane plane(points.size());
    std::size_t asked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) asked += points.asks(light, i);
    timed_loop(
        state, asked, [&] { method->visibility(*aimed, *looked, plane.out()); }, [&] { plane.clear(); });
    if (is_slow(info, light)) state.SetLabel(fmt::format("{} points", points.size()));
}

void add_method(Stage& stage, const MethodInfo& info) {
    const auto add = [&](const std::string& what, auto function, auto... more) {
        return add_benchmark(fmt::format("{}/{}/{}", stage.name, info.name, what), function, std::ref(stage),
                             std::cref(info), more...);
    };
    add("build", time_build);
    add("aim", time_aim);
    add("look", time_look)->MinTime(0.1);  // most have nothing to do
    add("point", time_visibility, kPoint, kUsual, 0);
    if (stage.scene.lights.size() > kArea) add("area", time_visibility, kArea, kUsual, 0);
    if (stage.name != "medium") return;
    const int most = static_cast<int>(std::thread::hardware_concurrency());
    for (int threads = 1; threads < 2 * most; threads *= 2)  // all of them last, whether a power of two or not
        add(fmt::format("point/threads:{}", std::min(threads, most)), time_visibility, kPoint, kUsual,
            std::min(threads, most));
    for (const Size size : {Size{320, 180}, Size{1280, 720}})
        add(fmt::format("point/{}x{}", size.width, size.height), time_visibility, kPoint, size, 0);
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    using namespace umbra;
    keep_freed_memory();       // as `umbra` does
    std::deque<Stage> stages;  // of each scene with both lights, and with the point light alone
    add_calibration();
    for (const auto& [name, make] : scenes_of_three_sizes()) {
        Stage& both = stages.emplace_back(Stage{{name, make, kUsual.width, kUsual.height}});
        Stage& hard = stages.emplace_back(Stage{{name, with_point_light_alone(make), kUsual.width, kUsual.height}});
        both.prepare();
        hard.prepare();
        for (const MethodInfo* info : methods())
            for (Stage* stage : {&both, &hard})
                if (!is_hopeless(*info, *stage) && info->make()->serves(stage->facts)) {
                    add_method(*stage, *info);
                    break;
                }
    }
    return run_benchmarks({argv, argv + argc});
}
