// The parts of results.json that compare alone writes, by the names of bench/run/results.schema.json.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/outcome.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/time/turns.h"

namespace umbra {

/// `reference` without its files.
[[nodiscard]] Json reference_json(const Truth& truth, const Scene& scene);

/// An entry of `methods`, without image and files, and with null for the times (set_times). `reference`, as typed, is
/// what it was compared with.
[[nodiscard]] Json served_json(const std::string& id, const PreparedScene& prepared, const Outcome& found,
                               const std::string& reference);
[[nodiscard]] Json unserved_json(const std::string& id, const MethodChoice& choice, const Service& service);

/// Writes the times of an entry: all samples, the cold run, the order.
void set_times(Json& entry, const Scene& scene, const TurnTimes& times);

/// What concerns all methods: rounds, calibration, the control that ran twice a round, and how busy the machine was.
/// `load` is the load average of the last minute, before the first round and after the last.
[[nodiscard]] Json turns_json(const Turns& turns, const TurnOptions& options, std::pair<double, double> load);

/// The entry of a method that threw, broke its contract or was cut short. It serves `not`, since it has no answers.
[[nodiscard]] Json failed_json(const std::string& id, const MethodChoice& choice, const Scene& scene,
                               const Failure& failure);

/// "SCENE: METHOD: It failed at light LIGHT: message", of an entry of a method, or of the reference, that has `failed`.
[[nodiscard]] std::string failure_in_words(const std::string& scene, const std::string& method, const Json& failed);

/// That of the reference and every method of a results.json that failed.
[[nodiscard]] std::vector<std::string> failures(const Json& record);

/// The record with every file name set behind `prefix`.
[[nodiscard]] Json with_prefix(Json record, const std::string& prefix);

}  // namespace umbra
