// `umbra motion`: three animations of scenes under several methods, as data, a table and a page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/studies/motion/motion_run.h"

namespace umbra {

struct MotionCommand {
    std::vector<std::string> methods{};   ///< as typed; empty: those that run by default
    std::vector<MethodChoice> choices{};  ///< further methods, as objects
    Size size{320, 180};
    double max_rmse = 0.02;  ///< for the second row of winners, (0, 1]
    MotionOptions options{};
    std::filesystem::path out;
    std::string command;  ///< for the record
    int threads = 0;
};

/// Runs the scenes and writes OUT/results.json and OUT/index.html. Returns the record. The
/// messages of scenes that cannot be read, or show no surface, are appended to `unreadable`, and these are skipped.
/// What threw is in the record's `failed`. Without any scene nothing is written. Throws UsageError, InputError.
MotionRecord measure_motion(const std::vector<std::filesystem::path>& files, const MotionCommand& command,
                            std::vector<std::string>& unreadable);

/// The record's scenes as tables for a terminal.
[[nodiscard]] std::string motion_table(const MotionRecord& record);

/// OUT/index.html and its style, from the record of `umbra motion` alone.
void write_motion_page(const MotionRecord& record, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
