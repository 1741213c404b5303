// bench_baseline: joins the files of several Google Benchmark programs, and compares them with an accepted run.
// ./umbra bench calls it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/gate/baseline.h"
#include "umbra/core/base/error.h"

namespace {

/// 0, or 1 where something is slower by more than was allowed.
int run(int argc, char** argv) {
    using namespace umbra;
    CLI::App app("Joins files of Google Benchmark programs, and compares them with an accepted run.", "bench_baseline");
    std::vector<std::filesystem::path> files;
    std::filesystem::path out, baseline, report, json;
    double fail_slower = 0;
    app.add_option("FILE", files, "what the programs wrote with --benchmark_out_format=json")->required();
    app.add_option("--out", out, "the files joined, in the same format")->required();
    app.add_option("--baseline", baseline, "such a file of an accepted run");
    app.add_option("--report", report, "the comparison as Markdown");
    app.add_option("--json", json, "the comparison as JSON");
    app.add_option("--fail-slower", fail_slower, "exit code 1 where a benchmark is slower by a factor above this")
        ->check(CLI::Range(1.0, 1e9));
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 64;
    }
    // Read first: the accepted run may be the file that is about to be replaced.
    std::optional<BenchmarkRun> accepted;
    if (!baseline.empty()) accepted = read_benchmark_run(baseline);
    StagedFiles joined;
    joined.write(out, merged_benchmarks(files).dump(1) + "\n");
    joined.commit();
    if (!accepted) return 0;
    const BaselineReport result = compare_with_baseline(read_benchmark_run(out), *accepted);
    StagedFiles staged;
    if (!report.empty()) staged.write(report, baseline_markdown(result));
    if (!json.empty()) staged.write(json, baseline_json(result).dump(1) + "\n");
    staged.commit();
    fmt::print("{}", baseline_markdown(result));
    const auto worst = slowest(result);
    return fail_slower > 0 && worst && *worst > fail_slower ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const umbra::InputError& e) {
        fmt::print(stderr, "bench_baseline: {}\n", e.what());
        return 4;
    } catch (const std::exception& e) {
        fmt::print(stderr, "bench_baseline: {}\n", e.what());
        return 5;
    }
}
