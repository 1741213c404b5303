// What `umbra compare` takes for one method besides the method itself: differences of the pictures, and the files.
// PASS/SCENE, milliseconds; 1920x1080 pixels, `shadow_zbuffer` beside 16 rays a point:
//
//     figures   RMSE, PSNR, SSIM, both FLIPs
//     all       the same, and beside it the EXR and all PNGs
//
//     comparison_benchmark [--size=WxH] [Google Benchmark's options]
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>

#include "umbra/bench/base/scratch_folder.h"
#include "umbra/bench/compare/method_files.h"
#include "umbra/bench/speed/timed_loop.h"
#include "umbra/core/base/memory.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// Two methods' answers on one scene, made at the first use.
struct Stage {
    std::string name;
    Size size{};
    std::unique_ptr<PreparedScene> prepared{};
    std::optional<MethodRun> one{}, other{};
    Rendered of_one{}, of_other{};
    std::vector<Explained> explained{};
    FinePicture none{};

    void prepare() {
        if (prepared) return;
        prepared =
            std::make_unique<PreparedScene>(prepare_scene(fs::path(UMBRA_SCENES_FOLDER) / (name + ".json"), size));
        const auto& p    = *prepared;
        const auto asked = [&](std::string_view settings) {
            return run_method(parse_method(settings), p.scene, p.facts, p.points);
        };
        one      = asked("shadow_zbuffer");
        other    = asked("ray_traced");
        of_one   = render_planes(p.scene, p.points, one->planes);
        of_other = render_planes(p.scene, p.points, other->planes);
        for (LightId j = 0; j < p.scene.lights.size(); ++j)
            explained.push_back(explain(p.scene, p.points, j, *one, *other));
    }
    [[nodiscard]] Answers answers() const { return {*one, of_one, none}; }
    [[nodiscard]] Answers reference() const { return {*other, of_other, none}; }
};

/// Skips the benchmark, and says so, where a picture differs from itself or not from another one.
bool figures_mean_something(benchmark::State& state, const Stage& s) {
    const ImageRecord same   = image_figures(s.other->planes, s.of_other, s.of_other).figures;
    const ImageRecord others = image_figures(s.one->planes, s.of_one, s.of_other).figures;
    for (const auto figure : {&ImageRecord::rmse, &ImageRecord::flip, &ImageRecord::flip_hdr})
        if (same.*figure != 0 || !(others.*figure > 0)) {
            state.SkipWithError(fmt::format("a figure of a picture and itself is {}, of two pictures {}",
                                            (same.*figure).value_or(NAN), (others.*figure).value_or(NAN))
                                    .c_str());
            return false;
        }
    return true;
}

void time_figures(benchmark::State& state, Stage& s) {
    s.prepare();
    if (!figures_mean_something(state, s)) return;
    for (auto _ : state) benchmark::DoNotOptimize(image_figures(s.one->planes, s.of_one, s.of_other));
}

void time_all(benchmark::State& state, Stage& s) {
    s.prepare();
    if (!figures_mean_something(state, s)) return;
    const ScratchFolder folder;
    for (auto _ : state)
        write_compared_files({folder.path(), "one", ""}, *s.prepared, s.answers(), s.reference(), s.explained);
}

}  // namespace
}  // namespace umbra

int main(int argc, char** argv) {
    using namespace umbra;
    keep_freed_memory();  // as `umbra` does
    const SpeedLine line(argc, argv);
    std::deque<Stage> stages;
    for (const char* name : {"stairs", "umbra_penumbra", "light_sizes"}) {
        Stage& s       = stages.emplace_back(Stage{name, line.size});
        const auto add = [&](const char* pass, void (*function)(benchmark::State&, Stage&)) {
            benchmark::RegisterBenchmark(fmt::format("{}/{}", pass, name).c_str(), function, std::ref(s))
                ->UseRealTime()
                ->Unit(benchmark::kMillisecond)
                ->MinTime(2);
        };
        add("figures", time_figures);
        add("all", time_all);
    }
    return run_benchmarks(line.rest);
}
