// `umbra growth`: how times and memory grow with triangles, pixels, lights, samples, and where methods cross.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/studies/motion/growth_record.h"

namespace umbra {

struct GrowthCommand {
    std::vector<std::string> over{};      ///< families; empty: all
    std::vector<std::string> methods{};   ///< as typed; empty: those that run by default, and for pixels the two ways
                                          ///< of shadow volumes that are compared with others' figures
    std::vector<MethodChoice> choices{};  ///< further methods, as objects
    std::optional<double> most{};         ///< the largest x, of one family
    GrowthOptions options{};
    std::filesystem::path out;
    std::string command;  ///< for the record
    int threads = 0;
};

/// Runs the families and writes OUT/results.json and OUT/index.html. Returns the record. A family
/// that throws is in its `failed`; a method that throws has its message in its series. Throws UsageError, InputError.
GrowthRecord measure_growth(const GrowthCommand& command);

/// The record's families as tables for a terminal.
[[nodiscard]] std::string growth_table(const GrowthRecord& record);

/// OUT/index.html and its style, from the record of `umbra growth` alone.
void write_growth_page(const GrowthRecord& record, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
