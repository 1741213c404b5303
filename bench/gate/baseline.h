// What became slower or faster than an accepted run of Google Benchmark programs, relative to the calibration loop of
// the same run: a machine that is slower today is slower at both.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/statistics.h"

namespace umbra {

/// Times of one run, milliseconds, one a repetition, by benchmark; and the calibration's of the same run.
struct BenchmarkRun {
    std::map<std::string, std::vector<double>> times;
    std::vector<double> calibration, calibration_again;
};

/// Reads the JSON that Google Benchmark writes (--benchmark_out_format=json): repetitions, not aggregates; benchmarks
/// that failed are left out. Throws InputError: file, what was found, what is expected; also where a file has no
/// calibration.
[[nodiscard]] BenchmarkRun read_benchmark_run(const std::filesystem::path& file);

/// One document of Google Benchmark's own form with the benchmarks of all `files`, in order, and the context of the
/// first. Throws as above, but needs no calibration.
[[nodiscard]] nlohmann::ordered_json merged_benchmarks(const std::vector<std::filesystem::path>& files);

enum class Change { none, slower, faster, added, removed };

struct BenchmarkChange {
    std::string name;
    Change change = Change::none;
    Ratio ratio{};  ///< now / accepted, both relative to their calibration; without pairs where only one run has it
};

struct BaselineReport {
    std::vector<BenchmarkChange> changes;  ///< slowest first, then what is only in one of the runs
    double noise_bar   = 0;                ///< of the calibration against itself, the larger of the two runs
    double calibration = 1;                ///< this machine now / then: what all ratios are divided by
};

/// A benchmark is slower or faster where the interval of its ratio excludes 1 and its ratio is outside the noise bar.
/// Four repetitions against four, or fewer, have no interval, of a benchmark and of the calibration: nothing is said
/// then.
[[nodiscard]] BaselineReport compare_with_baseline(const BenchmarkRun& now, const BenchmarkRun& accepted);

/// The largest ratio of those that are slower; nothing where none is.
[[nodiscard]] std::optional<double> slowest(const BaselineReport& report);

[[nodiscard]] nlohmann::ordered_json baseline_json(const BaselineReport& report);
/// A table in Markdown, and two sentences before it.
[[nodiscard]] std::string baseline_markdown(const BaselineReport& report);

}  // namespace umbra
