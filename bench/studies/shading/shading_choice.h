// `umbra shading --max`: the cheapest shading model whose errors stay within limits, and the front of those that no
// other beats in both time and error.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/run/describe.h"

namespace umbra {

/// Of the differences from `phong` in the record of a study.
inline constexpr std::array<std::string_view, 3> kShadingErrors{"rmse", "flip", "perceived"};

/// An error must not exceed `most` in any view.
struct ShadingLimit {
    std::string_view metric;  ///< of kShadingErrors
    double most = 0;
};
/// "METRIC=E", E at least 0. Throws UsageError.
[[nodiscard]] ShadingLimit parse_shading_limit(const std::string& text);

/// Names of models by ascending time: no other has at most the median of `times_ms` and at most the `worst.rmse`, and
/// less of one. Of record["models"].
[[nodiscard]] Json shading_front(const Json& record);

/// {limits: [{metric, most}], model, ms, of_phong, tied: [MODEL], runner_up, nearest}: the model with the least median
/// time whose worst errors of all views are within the limits, and that median; `of_phong` and `runner_up`, the
/// cheapest other one within the limits that is not tied: {model, ratio, low, high, rounds, coverage}, a paired ratio
/// of times with its interval (null: none); `tied`: within the limits, and as cheap as far as noise lets one see
/// (record["noise_bar"]). Where none is within, `model` is null and `nearest` is {model, factor}: the one whose largest
/// error over its limit is least.
[[nodiscard]] Json choose_shading(const Json& record, std::span<const ShadingLimit> limits);

/// Sentences on record["front"] and, where it is there, record["choice"].
[[nodiscard]] std::vector<std::string> shading_findings(const Json& record);

}  // namespace umbra
