// Comparing and climbing with progress and warnings on the terminal: what `compare`, `ladder` and `report` share.
#pragma once

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/ladder_command.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/report/lecture_texts.h"
#include "umbra/bench/sweep/sweep.h"

namespace umbra {

struct CompareOutput {
    std::function<std::vector<std::filesystem::path>()> then{};  ///< called once scenes are compared: makes further
                                                                 ///< folders that the pages are about
    Language language = Language::english;                       ///< of the page of the lectures
    bool as_json      = false;  ///< prints each scene's record instead of the first page's path
};
/// Compares the scenes and writes the pages of the results, the first page also in between. Prints to standard error the
/// messages of the scenes that failed.
ScenesDone compare_on_terminal(const std::vector<std::filesystem::path>& files, CompareOptions options,
                               const Common& common, const CompareOutput& output = {});

/// 0; 4 where scenes could not be read; 5 where a method failed.
[[nodiscard]] int exit_code(const ScenesDone& done);

/// Climbs; returns the record. Prints what failed to standard error.
LaddersRecord climb_on_terminal(LadderOptions options, const Common& common);

/// Sweeps, writes OUT/<scene>/results.json, OUT/results.json and the page OUT/index.html. Prints what failed to
/// standard error.
SweepDone sweep_on_terminal(SweepOptions options, const Common& common);

}  // namespace umbra
