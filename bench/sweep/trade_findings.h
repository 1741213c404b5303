// What a sweep says: the Pareto front of a metric, the staircase in words, the cheapest setting within an error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/sweep/swept_scene.h"

namespace umbra {

/// Whether a setting takes part in the trade of a metric: timed, compared, and its answers cover the points.
[[nodiscard]] bool takes_part(const SweptSetting& setting, std::size_t metric);

/// Whether times of a scene vary too much (kMostNoise) to rank its settings by them.
[[nodiscard]] bool is_loud(const SweptScene& scene);

/// Whether noise tells that `dearer` costs more than `cheaper`, milliseconds.
[[nodiscard]] bool costs_more(const SweptScene& scene, double dearer, double cheaper);

/// Indices of settings that no other setting beats in both cost and error (of the worst view), by ascending cost. None
/// where the scene is loud.
[[nodiscard]] std::vector<std::size_t> front_of(const SweptScene& scene, std::size_t metric);

/// The staircase of a metric in one sentence: "Cheapest down to an error of 0.021: Shadow z-buffer; below that down to
/// 0.0031: Ray-traced shadows; exactly 0: Exact visibility, at 3.10 times the cost of the step before." In brackets
/// after a method stand others that are within its errors at a cost that noise does not tell from its own. Says why
/// where there is no staircase.
[[nodiscard]] std::string staircase_in_words(const SweptScene& scene, std::size_t metric);

/// One problem of the comparison at fixed errors: a scene and an error, and the cheapest setting of each method.
struct FixedError {
    std::size_t scene = 0;
    double error      = 0;
    std::vector<std::optional<std::size_t>> cheapest;  ///< [method]: index of a setting of the scene
    std::vector<double> costs;                         ///< [method]: milliseconds a frame; infinite where none is
    double least = 0;                                  ///< of `costs`; infinite where no method is within the error
};

/// Every scene that has the metric with every error, scene by scene.
[[nodiscard]] std::vector<FixedError> at_fixed_errors(const std::vector<SweptScene>& scenes,
                                                      const std::vector<SweptMethod>& methods,
                                                      const std::string& metric, const std::vector<double>& errors);

}  // namespace umbra
