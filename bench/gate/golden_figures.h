// The figures of goldens: errors against `exact`, pinned or as ranges, and their file.
#pragma once

#include <filesystem>
#include <string>

#include "umbra/bench/gate/golden_planes.h"
#include "umbra/bench/lab/describe.h"

namespace umbra {

/// {light: {figure: N}}
[[nodiscard]] Json figures_of(const PreparedScene& prepared, const MethodRun& run, const MethodRun& exact);

/// Adds what is not as accepted. Accepted figures alone may be ranges.
void add_figure_changes(const Json& accepted, const Json& now, Changes& changes);

/// The figures as ranges, for the lights whose answers are sampled.
[[nodiscard]] Json with_ranges(Json figures, const PreparedScene& prepared, const MethodChoice& choice,
                               const MethodRun& exact);

/// What figures.json says.
struct Figures {
    std::string machine;
    Json methods = Json::object();  ///< {method: {light: {figure: N or [low, high]}}}
};
/// Empty where there is no such file. Throws InputError.
[[nodiscard]] Figures read_figures(const std::filesystem::path& file);

/// A line a light, methods in the order of the report.
[[nodiscard]] std::string figures_text(const Figures& figures);

}  // namespace umbra
