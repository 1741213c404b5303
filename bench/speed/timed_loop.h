// What the benchmark programs share: a loop in which only the work is inside the clock, and the calibration.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <functional>

#include "umbra/bench/time/calibration.h"

namespace umbra {

/// One call of `work` an iteration, wall clock; `before` runs ahead of each, outside the clock. For benchmarks with
/// UseManualTime.
inline void timed_loop(benchmark::State& state, const std::function<void()>& work,
                       const std::function<void()>& before = {}) {
    for (auto _ : state) {
        if (before) before();
        const auto start = std::chrono::steady_clock::now();
        work();
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
}

/// "calibration" and, as a control, the same again: what times of two runs of a program are relative to.
inline void add_calibration() {
    for (const char* name : {"calibration", "calibration/again"})
        benchmark::RegisterBenchmark(name, [](benchmark::State& state) { timed_loop(state, calibration_work); })
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
}

}  // namespace umbra
