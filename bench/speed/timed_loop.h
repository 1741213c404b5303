// What the benchmark programs share: their options, a loop in which only the work is inside the clock, the calibration.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/calibration.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/core/base/error.h"

namespace umbra {

/// One call of `work` an iteration, wall clock; `before` runs ahead of each, outside the clock. For benchmarks with
/// UseManualTime. `items`: how many of them a call processes; 0: none are counted.
inline void timed_loop(benchmark::State& state, std::size_t items, const std::function<void()>& work,
                       const std::function<void()>& before = {}) {
    for (auto _ : state) {
        if (before) before();
        const auto start = std::chrono::steady_clock::now();
        work();
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    if (items > 0) state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
}

/// Registers function(state, arguments...), which times itself (UseManualTime); milliseconds.
template <class Function, class... Arguments>
benchmark::internal::Benchmark* add_benchmark(const std::string& name, Function function, Arguments... arguments) {
    return benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

/// "calibration" and, as a control, the same again: what times of two runs of a program are relative to.
inline void add_calibration() {
    for (const char* name : {"calibration", "calibration/again"})
        add_benchmark(name, [](benchmark::State& state) { timed_loop(state, 0, calibration_work); });
}

/// The options that are not Google Benchmark's: --size=WxH, and --scene=FILE, any number of times.
struct SpeedLine {
    Size size{1920, 1080};
    std::vector<std::string> scenes;
    std::vector<char*> rest;

    /// Ends the program with a message where a size is none.
    SpeedLine(int argc, char** argv) {
        for (int i = 0; i < argc; ++i) {
            const std::string_view argument = argv[i];
            if (argument.starts_with("--scene="))
                scenes.emplace_back(argument.substr(8));
            else if (argument.starts_with("--size="))
                try {
                    size = parse_size(std::string(argument.substr(7)));
                } catch (const UsageError& e) {
                    std::fprintf(stderr, "%s\n", e.what());
                    std::exit(2);
                }
            else
                rest.push_back(argv[i]);
        }
    }
};

/// What was registered; the exit code.
inline int run_benchmarks(std::vector<char*> arguments) {
    int count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

}  // namespace umbra
