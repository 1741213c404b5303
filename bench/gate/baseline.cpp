#include "umbra/bench/gate/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "umbra/bench/base/field.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kCalibration = "calibration", kControl = "calibration/again";

Json read(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw InputError(fmt::format("{}: cannot be opened", file.string()));
    Json document = Json::parse(in, nullptr, false);
    if (!document.is_object() || !document.contains("benchmarks") || !document["benchmarks"].is_array())
        throw InputError(
            fmt::format("{}: expected the JSON that Google Benchmark writes, an object with an array \"benchmarks\"",
                        file.string()));
    return document;
}

std::string text_of(const fs::path& file, const Json& entry, const char* key) {
    if (!entry.is_object() || !entry.contains(key) || !entry[key].is_string())
        throw InputError(fmt::format("{}: a benchmark without \"{}\", expected a string", file.string(), key));
    return entry[key].get<std::string>();
}

double milliseconds(const fs::path& file, const Json& entry) {
    const std::string unit = text_of(file, entry, "time_unit");
    const double factor    = unit == "ms" ? 1 : unit == "us" ? 1e-3 : unit == "ns" ? 1e-6 : unit == "s" ? 1e3 : 0;
    if (factor == 0 || !entry.contains("real_time") || !entry["real_time"].is_number())
        throw InputError(fmt::format("{}: {}: expected \"real_time\" and a \"time_unit\" of s, ms, us or ns",
                                     file.string(), text_of(file, entry, "name")));
    return factor * entry["real_time"].get<double>();
}

/// The name without what Google Benchmark adds for manual time.
std::string plain(std::string name) {
    if (const auto at = name.find("/manual_time"); at != std::string::npos) name.erase(at, 12);
    return name;
}

/// Relative to the calibrations: the bounds of two intervals that together hold at least kCoverage.
Ratio ratio_of(const std::vector<double>& now, const BenchmarkRun& new_run, const std::vector<double>& then,
               const BenchmarkRun& old_run) {
    constexpr double level = (1 + kCoverage) / 2;
    const Ratio times      = ratio_of_samples(now, then, level);
    const Ratio machine    = ratio_of_samples(new_run.calibration, old_run.calibration, level);
    Ratio ratio{.median = times.median / machine.median, .pairs = times.pairs};
    if (!times.has_interval() || !machine.has_interval()) return ratio;
    ratio.interval = {times.interval.low / machine.interval.high, times.interval.high / machine.interval.low};
    ratio.coverage = times.coverage + machine.coverage - 1;
    return ratio;
}

/// The bound of the calibration against itself. Its two benchmarks run at different times, so that they are not pairs.
double control_bar(const BenchmarkRun& run) {
    if (run.calibration_again.empty()) return noise_bar({});
    return noise_bar(ratio_of_samples(run.calibration_again, run.calibration));
}

std::string_view word(Change change) {
    switch (change) {
        case Change::none: return "no difference";
        case Change::slower: return "slower";
        case Change::faster: return "faster";
        case Change::added: return "new";
        case Change::removed: return "gone";
    }
    return "";
}

}  // namespace

BenchmarkRun read_benchmark_run(const fs::path& file) {
    BenchmarkRun run;
    const Json document = read(file);
    for (const Json& entry : document["benchmarks"]) {
        const std::string name = plain(text_of(file, entry, "name"));
        if (entry.value("run_type", "iteration") != "iteration" || entry.value("error_occurred", false)) continue;
        const double ms = milliseconds(file, entry);
        if (!(std::isfinite(ms) && ms > 0)) continue;
        if (name == kCalibration)
            run.calibration.push_back(ms);
        else if (name == kControl)
            run.calibration_again.push_back(ms);
        else
            run.times[name].push_back(ms);
    }
    if (run.calibration.empty())
        throw InputError(
            fmt::format("{}: no benchmark \"{}\", which all others are relative to", file.string(), kCalibration));
    return run;
}

Json merged_benchmarks(const std::vector<fs::path>& files) {
    Json merged;
    for (const fs::path& file : files) {
        Json document = read(file);
        if (merged.is_null())
            merged = std::move(document);
        else
            for (Json& entry : document["benchmarks"]) merged["benchmarks"].push_back(std::move(entry));
    }
    return merged;
}

BaselineReport compare_with_baseline(const BenchmarkRun& now, const BenchmarkRun& accepted) {
    BaselineReport report;
    report.noise_bar   = std::max(control_bar(now), control_bar(accepted));
    report.calibration = median(now.calibration) / median(accepted.calibration);
    for (const auto& [name, times] : now.times) {
        const auto then = accepted.times.find(name);
        if (then == accepted.times.end()) {
            report.changes.push_back({name, Change::added});
            continue;
        }
        BenchmarkChange change{name, Change::none, ratio_of(times, now, then->second, accepted)};
        if (differs(change.ratio, report.noise_bar))
            change.change = change.ratio.median > 1 ? Change::slower : Change::faster;
        report.changes.push_back(std::move(change));
    }
    for (const auto& [name, times] : accepted.times)
        if (!now.times.contains(name)) report.changes.push_back({name, Change::removed});
    const auto key = [](const BenchmarkChange& c) { return c.ratio.pairs > 0 ? c.ratio.median : -1; };
    std::stable_sort(report.changes.begin(), report.changes.end(),
                     [&](const BenchmarkChange& a, const BenchmarkChange& b) { return key(a) > key(b); });
    return report;
}

std::optional<double> slowest(const BaselineReport& report) {
    for (const BenchmarkChange& c : report.changes)
        if (c.change == Change::slower) return c.ratio.median;
    return std::nullopt;
}

Json baseline_json(const BaselineReport& report) {
    Json changes = Json::array();
    for (const BenchmarkChange& c : report.changes) {
        Json entry = {{"name", c.name}, {"change", word(c.change)}};
        if (c.ratio.pairs > 0) {
            entry["ratio"]    = c.ratio.median;
            entry["interval"] = {nullptr, nullptr};
            if (c.ratio.has_interval()) entry["interval"] = {c.ratio.interval.low, c.ratio.interval.high};
            entry["coverage"]    = c.ratio.coverage;
            entry["repetitions"] = c.ratio.pairs;
        }
        changes.push_back(std::move(entry));
    }
    return {{"noise_bar", number(report.noise_bar)}, {"calibration", report.calibration}, {"benchmarks", changes}};
}

std::string baseline_markdown(const BaselineReport& report) {
    const auto many = [&](Change which) {
        return std::count_if(report.changes.begin(), report.changes.end(),
                             [&](const BenchmarkChange& c) { return c.change == which; });
    };
    std::string text = fmt::format("{} benchmarks: {} slower, {} faster, {} without a difference, {} new, {} gone. ",
                                   report.changes.size(), many(Change::slower), many(Change::faster),
                                   many(Change::none), many(Change::added), many(Change::removed));
    text += std::isfinite(report.noise_bar) ? fmt::format("Noise bar {:.1f} %; ", 100 * report.noise_bar)
                                            : std::string("No control, so that nothing can be said to differ; ");
    text += fmt::format(
        "the calibration loop took {:.2f} times what it took in the accepted run, and all ratios are "
        "divided by that.\n\n| benchmark | change | ratio | interval, which holds the true ratio in "
        "|\n|---|---|--:|--:|\n",
        report.calibration);
    for (const BenchmarkChange& c : report.changes) {
        if (c.ratio.pairs == 0)
            text += fmt::format("| {} | {} | | |\n", c.name, word(c.change));
        else
            text +=
                fmt::format("| {} | {} | {:.3f} | {} |\n", c.name, word(c.change), c.ratio.median,
                            c.ratio.has_interval() ? fmt::format("{:.3f}–{:.3f}, {:.1f} %", c.ratio.interval.low,
                                                                 c.ratio.interval.high, 100 * c.ratio.coverage)
                                                   : fmt::format("none: {} repetitions are too few", c.ratio.pairs));
    }
    return text;
}

}  // namespace umbra
