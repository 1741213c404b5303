// The parts of a record that come from running a method: its answers' errors, its times, its failure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/lab/turns.h"

namespace umbra {

/// Without its files.
[[nodiscard]] ReferenceRecord reference_record(const Truth& truth, const Scene& scene);

/// Without image, files and times (set_times). `reference`, as typed, is what it was compared with.
[[nodiscard]] MethodRecord served_record(const std::string& id, const PreparedScene& prepared, const Outcome& found,
                                         const std::string& reference);
/// What is known of a method without running it.
[[nodiscard]] MethodRecord unserved_record(const std::string& id, const MethodChoice& choice, const Service& service);

/// Of a method that threw, broke its contract or was cut short.
[[nodiscard]] MethodRecord failed_record(const std::string& id, const MethodChoice& choice, const Scene& scene,
                                         const Failure& failure);

/// Medians of what a method from outside says of the runs behind those of `before`; of all where there are none.
[[nodiscard]] OwnTimesRecord own_times_record(const OwnTimes& times, const OwnTimes& before);

/// Sets the times of a method: all samples, the cold run, the order.
void set_times(MethodRecord& record, const Scene& scene, const TurnTimes& times);

/// What concerns all methods: rounds, calibration, the control that ran twice a round, and how busy the machine was.
/// `load` is the load average of the last minute, before the first round and after the last.
[[nodiscard]] TurnsRecord turns_record(const Turns& turns, const TurnOptions& options, std::pair<double, double> load);

/// "SCENE: METHOD: It failed at light LIGHT: message".
[[nodiscard]] std::string failure_in_words(const std::string& scene, const std::string& method,
                                           const FailureRecord& failed);

/// That of the reference and of every method that failed.
[[nodiscard]] std::vector<std::string> failures(const Results& results);

/// The record with every file name set behind `prefix`.
[[nodiscard]] Results with_prefix(Results results, const std::string& prefix);

}  // namespace umbra
