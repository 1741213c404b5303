// `umbra ladder`: climbs ladders and writes the results.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/lab/budget.h"
#include "umbra/bench/ladders/ladder_record.h"

namespace umbra {

struct LadderOptions {
    std::vector<std::string> names;    ///< empty: all
    std::vector<std::string> methods;  ///< as typed; empty: all that reports show (MethodInfo::is_shown) but `exact`,
                                       ///< the reference, with their defaults and in their textbook form
    bool only_by_default = false;      ///< of these, those that run on every scene alone: minutes less
    double patience_s    = 20;         ///< as climb_ladder takes it, and the budget
    Budget budget{};
    std::filesystem::path out;
    std::string command;  ///< for the record
    int threads = 0;
    std::function<void(const std::string&)> progress;  ///< receives status messages; may be empty
};

/// Climbs and writes OUT: results.json, breaks/ with a small scene and pictures of each break, index.html. The folder
/// is written under another name and then renamed. Returns the record in results.json. Throws UsageError, InputError.
LaddersRecord climb_ladders(const LadderOptions& options);

}  // namespace umbra
