// The parts of results.json that compare alone writes, by the names of bench/run/results.schema.json.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/explain.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/run/reference.h"
#include "umbra/bench/time/turns.h"

namespace umbra {

/// `reference` without its files; `failed` is what it replaces.
[[nodiscard]] Json reference_json(const Reference& reference, const ReferenceRun& ran, const Scene& scene,
                                  const std::optional<Failure>& failed);

/// An entry of `methods`, without image and files, and with null for the times (set_times); `explained` is one a light,
/// against `reference`, as typed.
[[nodiscard]] Json served_json(const std::string& id, const PreparedScene& prepared, const MethodRun& run,
                               std::span<const Explained> explained, const std::string& reference);
[[nodiscard]] Json unserved_json(const std::string& id, const MethodChoice& choice, const Service& service);

/// Writes the times of an entry: all samples, the cold run, the order.
void set_times(Json& entry, const Scene& scene, const TurnTimes& times);

/// What concerns all methods: rounds, calibration, the control that ran twice a round, and how busy the machine was.
/// `load` is the load average of the last minute, before the first round and after the last.
[[nodiscard]] Json turns_json(const Turns& turns, const TurnOptions& options, std::pair<double, double> load);

/// The entry of a method that threw or broke its contract, at `light` if it was about one. It serves `not`, since it
/// has no answers.
[[nodiscard]] Json failed_json(const std::string& id, const MethodChoice& choice, const Scene& scene,
                               std::optional<LightId> light, const std::string& message);

/// "SCENE: METHOD: It failed at light LIGHT: message" for the reference and every method of a results.json that failed.
[[nodiscard]] std::vector<std::string> failures(const Json& record);

/// The record with every file name set behind `prefix`.
[[nodiscard]] Json with_prefix(Json record, const std::string& prefix);

}  // namespace umbra
