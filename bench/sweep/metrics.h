// Metrics: the columns of results.json as single numbers that a limit can be set for. Less is better, for all of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/edge_figure.h"
#include "umbra/bench/sweep/cell_record.h"
#include "umbra/bench/sweep/sweep_results.h"

namespace umbra {

struct Metric {
    enum class Kind : std::uint8_t {
        share,    ///< points of some classes, over the points compared, of all lights together
        rms,      ///< root mean square over the points of all lights
        mean,     ///< mean over the points of all lights
        largest,  ///< the largest of all lights
        entry     ///< one value a setting
    };
    std::string_view name;  ///< as typed, and as records name it: "edge_displacement_px.p95"
    std::string_view unit;  ///< empty for pure numbers
    std::string_view doc;   ///< one sentence
    Kind kind;
    // Where it is found, one of these; nothing where the record does not say.
    std::optional<double> (*of_light)(const ErrorRecord&)  = nullptr;  ///< a count for `share`
    std::optional<EdgeFigure> (*of_edge)(const WholeEdge&) = nullptr;
    std::optional<double> (*of_cell)(const Cell&)          = nullptr;  ///< for `entry`
};

/// In the order of tables.
[[nodiscard]] std::span<const Metric> metrics();

/// Throws UsageError with near matches.
[[nodiscard]] const Metric& find_metric(std::string_view name);

/// A metric of one cell. Nothing where it was not judged: no point compared, none of some light that has points, no
/// reference that names the class, no edge there, or a brief cell that does not know it.
[[nodiscard]] std::optional<double> metric_value(const Metric& metric, const Cell& cell);

/// Whether a brief cell has no value of it.
[[nodiscard]] inline bool needs_whole_cell(const Metric& metric) {
    return (metric.kind == Metric::Kind::share && metric.name != "terminator.wrong") || metric.of_edge != nullptr ||
           metric.name == "memory_mb";
}

/// The largest of the views; nothing where one was not judged, or where there is none.
[[nodiscard]] std::optional<double> largest_value(const Metric& metric, std::span<const Cell> views);

/// Whether the value is the least that it may be: shadow edges lie beyond the reach in which they are looked for.
[[nodiscard]] bool is_at_least(const Metric& metric, const Cell& cell);

/// The count behind a share, and the points that it is a share of; nothing for other kinds, and where not judged.
struct Counted {
    std::uint64_t wrong = 0, of = 0;
};
[[nodiscard]] std::optional<Counted> counted(const Metric& metric, const Cell& cell);

/// Points compared in a cell, of all lights.
[[nodiscard]] std::uint64_t points_compared(const Cell& cell);

[[nodiscard]] std::vector<MetricRecord> metric_records();

/// What is typed for a limit: "rmse=0.01".
struct LimitText {
    std::string metric;  ///< as typed; any word
    double most = 0;
};
/// "METRIC=E" as typed after --max, E finite and at least 0; `expected` ends the error where there is no "=", as
/// "METRIC=LIMIT, as rmse=0.01". Throws UsageError.
[[nodiscard]] LimitText parse_limit_text(const std::string& text, std::string_view expected);

}  // namespace umbra
