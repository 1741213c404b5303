// Ratios of times: contenders take turns round after round, so that a machine whose speed drifts cannot favour one.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/base/statistics.h"

namespace umbra {

/// Milliseconds on the clock, and of all processors together: the second is what a busy machine leaves comparable.
struct Cost {
    double wall = 0, cpu = 0;
};

inline Cost cost_of(const std::function<void()>& f) {
    const auto begin        = std::chrono::steady_clock::now();
    const std::clock_t work = std::clock();
    f();
    return {std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count(),
            1e3 * static_cast<double>(std::clock() - work) / CLOCKS_PER_SEC};
}

struct Contender {
    std::string name;
    std::function<void()> run;
};

/// What the table at the end has: a line a benchmark.
struct RatioLine {
    std::string name, against;
    double ours = 0, theirs = 0;                     ///< ms, medians
    double ratio = 0, least = 0, most = 0, cpu = 0;  ///< median, least and most of the rounds; median of processor time
};
inline std::vector<RatioLine>& ratio_lines() {
    static std::vector<RatioLine> lines;
    return lines;
}

/// Runs ours and the others round after round, in an order that turns, after one round that does not count. Reported is
/// ours; the counters hold the medians in ms, `ratio`, the median over the rounds of ours by the fastest of the others,
/// and `cpu_ratio`, the same of processor time.
inline void in_turns(benchmark::State& state, const std::string& name, const std::function<void()>& ours,
                     const std::vector<Contender>& others) {
    std::vector<Contender> all{{"ours", ours}};
    all.insert(all.end(), others.begin(), others.end());
    for (const Contender& c : all) c.run();
    std::vector<std::vector<double>> wall(all.size());
    std::vector<double> ratios, cpu_ratios;
    std::size_t round = 0;
    for (auto _ : state) {
        std::vector<Cost> costs(all.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            const std::size_t which = (k + round) % all.size();
            costs[which]            = cost_of(all[which].run);
        }
        ++round;
        for (std::size_t k = 0; k < all.size(); ++k) wall[k].push_back(costs[k].wall);
        const auto ratio = [&](double Cost::*of) {
            return costs[0].*of / ((*std::ranges::min_element(costs.begin() + 1, costs.end(), {}, of)).*of);
        };
        ratios.push_back(ratio(&Cost::wall));
        cpu_ratios.push_back(ratio(&Cost::cpu));
        state.SetIterationTime(costs[0].wall / 1e3);
    }
    std::size_t fastest = 1;
    for (std::size_t k = 0; k < all.size(); ++k) {
        state.counters[all[k].name + "_ms"] = median(wall[k]);
        if (k > 0 && median(wall[k]) < median(wall[fastest])) fastest = k;
    }
    state.counters["ratio"]     = median(ratios);
    state.counters["cpu_ratio"] = median(cpu_ratios);
    ratio_lines().push_back({name, all[fastest].name, median(wall[0]), median(wall[fastest]), median(ratios),
                             *std::ranges::min_element(ratios), *std::ranges::max_element(ratios), median(cpu_ratios)});
}

/// As a table in Markdown.
inline void print_ratios() {
    if (ratio_lines().empty()) return;
    std::printf("\n| | ms | against | ms | ratio | rounds | of processor time |\n|---|--:|---|--:|--:|--:|--:|\n");
    for (const RatioLine& l : ratio_lines())
        std::printf("| %s | %.4g | %s | %.4g | %.2f | %.2f to %.2f | %.2f |\n", l.name.c_str(), l.ours,
                    l.against.c_str(), l.theirs, l.ratio, l.least, l.most, l.cpu);
}

}  // namespace umbra
