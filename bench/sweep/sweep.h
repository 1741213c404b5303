// `umbra sweep`: many settings of many methods on a scene, in several views: errors, bounds, times, Pareto fronts.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/bench/lab/workload.h"
#include "umbra/bench/sweep/cell.h"
#include "umbra/bench/sweep/sweep_results.h"

namespace umbra {

/// What a sweep computes. Two plans that are equal have the same cells.
struct SweepPlan {
    std::vector<std::filesystem::path> scenes;
    std::vector<std::string> settings;  ///< as typed, with alternatives; empty: the methods' own sweeps
    int views = 5;                      ///< at least 1; bounds need 2
    Size size;
    std::optional<std::string> reference{};
    std::optional<std::uint64_t> points{};
    Budget budget{};  ///< of each cell; no part of the plan in plan.json
};

/// Part `index` of `count`, both from 1: of all cells in their order, each `count`th.
struct Pack {
    std::size_t index = 1, count = 1;
};
[[nodiscard]] Pack parse_pack(const std::string& text);  ///< "3/20"; throws UsageError

struct SweepOptions {
    SweepPlan plan;
    std::filesystem::path out;
    bool times = true;
    TurnOptions turns{.rounds = 7, .budget_ms = 20000};
    double most_noise = kMostNoise;  ///< above this noise bar times are taken again, and then it is warned of
    Workload workload;
    std::string command;
    int threads = 0;
    std::function<void(const std::string&)> progress{};
    std::function<void(const std::string&)> warn{};
};

/// One cell of a plan.
struct PlannedCell {
    std::size_t scene;  ///< index into the plan's scenes
    int view;
    std::string setting;
};

/// The settings for one scene: those of the plan, expanded, that differ there. Throws UsageError.
[[nodiscard]] std::vector<MethodChoice> planned_settings(const SweepPlan& plan, const SceneFacts& facts);

/// All cells, scene by scene and view by view. Loads the scenes. Throws InputError, UsageError.
[[nodiscard]] std::vector<PlannedCell> planned_cells(const SweepPlan& plan);

/// The plan as a command line of `umbra sweep` has it, without -o.
[[nodiscard]] std::string plan_arguments(const SweepPlan& plan);

/// Computes the cells of one pack that OUT/cells lacks, and writes OUT/plan.json. Nothing else is written, no time is
/// measured, and packs may run side by side on machines that share OUT. Returns the number of cells computed. Messages
/// of methods that failed go to `failed`.
std::size_t sweep_pack(const SweepOptions& options, Pack pack, std::vector<std::string>& failed);

/// Computes what OUT/cells lacks, measures times, and returns the record of each scene; the caller writes them. An
/// interrupted run goes on where it stopped.
struct SweepDone {
    std::vector<SweepResults> records;  ///< one a scene
    std::vector<std::string> folders;
    std::vector<std::string> failed;
    std::size_t computed = 0, cells = 0;
};
[[nodiscard]] SweepDone sweep(const SweepOptions& options);

/// Copies the cells of all folders to `options.out` and takes the plan that they share. Throws InputError where a
/// folder has no plan, plans differ, or cells are missing: how many, and the command that computes them.
[[nodiscard]] SweepPlan merged_plan(const std::vector<std::filesystem::path>& folders,
                                    const std::filesystem::path& out);

}  // namespace umbra
