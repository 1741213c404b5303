// results.json of a sweep (bench/sweep/sweep.schema.json), from cells and times.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/time/workload.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// One setting of a sweep.
struct MeasuredSetting {
    MethodChoice choice;
    std::vector<Json> views;  ///< cells, view 0 first
    Json times;               ///< of SceneLab::times; null where it has none
};

/// Milliseconds of a frame of this workload, by the medians of the times; nothing where there are none.
[[nodiscard]] std::optional<double> cost_of(const Json& times, const Workload& workload);

/// `sweep` of results.json. The fronts hold, for each metric, the settings that no other one beats in both the cost of
/// a frame and the error of the worst view, of those that answer the points and have a time. `turns` as of
/// TimedTogether; null where nothing was timed.
[[nodiscard]] Json sweep_json(std::span<const MeasuredSetting> settings, int views, const Workload& workload,
                              const Json& turns);

/// Of a scene's results.json: the front of the first metric, a line a setting. All settings that may be on a front, in
/// the order of the record, where times vary too much to rank them.
[[nodiscard]] std::string front_in_words(const Json& record);

}  // namespace umbra
