// Times of the methods of a comparison: measured in turns, after all of them have answered.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/time/turns.h"

namespace umbra {

/// A method's entry of the record, and the times of the run that its answers are from; none where it has no answers.
struct Answered {
    Json entry;
    std::optional<RunTimes> first{};
};

/// Of a run in which each phase ran once.
[[nodiscard]] RunTimes times_of(const MethodRun& run);

/// Runs those that have answers in turns, at most `repeats.max_runs` rounds and `repeats.budget_ms` for each phase of
/// each, and writes the times into their entries. One that throws gets the entry of a method that failed, and its files
/// in `folder` go. Returns `turns` of the record: what concerns all of them. `answered` is one a choice.
[[nodiscard]] Json time_methods(const std::filesystem::path& folder, const PreparedScene& prepared,
                                std::span<const MethodChoice> choices, std::vector<Answered>& answered,
                                const Repeats& repeats, const std::function<void(const std::string&)>& tell);

}  // namespace umbra
