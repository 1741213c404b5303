// A sweep's settings as its record has them, from cells and times.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/lab/workload.h"
#include "umbra/bench/sweep/cell_record.h"
#include "umbra/bench/sweep/sweep_results.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// One setting of a sweep.
struct MeasuredSetting {
    MethodChoice choice;
    std::vector<Cell> views;                 ///< view 0 first
    std::optional<TurnTimesRecord> times{};  ///< of SceneLab::times, where it has some
};

/// Milliseconds of a frame of this workload, by the medians of the times; nothing where there are none.
[[nodiscard]] std::optional<double> cost_of(const std::optional<TurnTimesRecord>& times, const Workload& workload);

/// The fronts hold, for each metric, the settings that no other one beats in both the cost of a frame and the error of
/// the worst view, of those that answer the points and have a time. `turns` as of TimedTogether.
[[nodiscard]] SweepRecord sweep_record(std::span<const MeasuredSetting> settings, int views, const Workload& workload,
                                       const std::optional<SweptTurnsRecord>& turns);

/// The front of the first metric, a line a setting. All settings that may be on a front, in the order of the record,
/// where times vary too much to rank them.
[[nodiscard]] std::string front_in_words(const std::string& scene, const SweepRecord& sweep);

}  // namespace umbra
