#include "umbra/bench/sweep/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "umbra/bench/run/edge_figure.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/errors/shadow_edges.h"

namespace umbra {
namespace {

using Kind = Metric::Kind;

constexpr std::array kMetrics{
    Metric{"rmse", "", "Root mean square error of S_j.", Kind::rms, "rmse"},
    Metric{"mae", "", "Mean absolute error of S_j.", Kind::mean, "mae"},
    Metric{"max", "", "Largest error of S_j.", Kind::largest, "max"},
    Metric{"interior", "share of points", "Wrong points outside the edge band.", Kind::share,
           "false_shadow.interior+false_light.interior"},
    Metric{"edge", "share of points", "Wrong points in the edge band.", Kind::share,
           "false_shadow.edge+false_light.edge"},
    Metric{"false_shadow.interior", "share of points", "False shadow outside the edge band.", Kind::share,
           "false_shadow.interior"},
    Metric{"false_shadow.edge", "share of points", "False shadow in the edge band.", Kind::share, "false_shadow.edge"},
    Metric{"false_shadow.acne", "share of points", "False shadow by the point's own surface.", Kind::share,
           "false_shadow.acne"},
    Metric{"false_light.interior", "share of points", "False light outside the edge band.", Kind::share,
           "false_light.interior"},
    Metric{"false_light.edge", "share of points", "False light in the edge band.", Kind::share, "false_light.edge"},
    Metric{"false_light.detachment", "share of points", "False light at a contact.", Kind::share,
           "false_light.detachment"},
    Metric{"false_light.leak", "share of points", "False light elsewhere.", Kind::share, "false_light.leak"},
    Metric{"penumbra_error", "share of points", "Wrong points in penumbrae of a method that has no penumbra there.",
           Kind::share, "penumbra_error.false_shadow+penumbra_error.false_light"},
    Metric{"noise_error", "share of points", "Points that random numbers make wrong.", Kind::share,
           "noise_error.false_shadow+noise_error.false_light"},
    Metric{"terminator.wrong", "share of points", "Wrong points where shading normal and facet disagree.", Kind::share,
           "terminator.wrong"},
    Metric{"edge_displacement_px.mean", "pixels",
           "Mean distance of shadow edges from the true ones; pieces not found within 8 pixels count as 8.",
           Kind::largest, "edge_displacement_px.mean"},
    Metric{"edge_displacement_px.p95", "pixels",
           "95 % of the pieces of shadow edges lie at most this far off; one not found within 8 pixels counts as 8.",
           Kind::largest, "edge_displacement_px.p95"},
    Metric{"edge_displacement_px.max", "pixels",
           "Largest distance of a shadow edge from the true one; 8 where a piece is not found within 8 pixels.",
           Kind::largest, "edge_displacement_px.max"},
    Metric{"image_rmse", "", "Root mean square error of the linear picture.", Kind::entry, "image.rmse"},
    Metric{"flip", "", "Mean FLIP of the displayed picture.", Kind::entry, "image.flip"},
    Metric{"flip_hdr", "", "Mean FLIP of the linear picture.", Kind::entry, "image.flip_hdr"},
    Metric{"undefined", "share of points", "Points that the method has no answer for.", Kind::entry, "undefined"},
    Metric{"memory_mb", "MB", "Memory held after build and aim.", Kind::entry, "memory_bytes", 1e-6},
};

/// The value at "a.b"; null where something on its path is not there.
const Json* at_path(const Json& node, std::string_view path) {
    const Json* here = &node;
    while (true) {
        const std::size_t dot = path.find('.');
        if (!here->is_object()) return nullptr;
        const auto found = here->find(std::string(path.substr(0, dot)));
        if (found == here->end()) return nullptr;
        here = &*found;
        if (dot == std::string_view::npos) return here;
        path.remove_prefix(dot + 1);
    }
}

std::optional<double> number_at(const Json& node, std::string_view path) {
    const Json* value = at_path(node, path);
    return value != nullptr && value->is_number() ? std::optional(value->get<double>()) : std::nullopt;
}

/// The sum over "a.b+c.d"; nothing where one of them is missing.
std::optional<double> sum_at(const Json& node, std::string_view paths) {
    double sum = 0;
    while (true) {
        const std::size_t plus = paths.find('+');
        const auto value       = number_at(node, paths.substr(0, plus));
        if (!value) return std::nullopt;
        sum += *value;
        if (plus == std::string_view::npos) return sum;
        paths.remove_prefix(plus + 1);
    }
}

double points_of(const Json& error) { return number_at(error, "points").value_or(0); }

/// Whether a light has points, and the method or the reference answers none of them.
bool unanswered(const Json& error) {
    return points_of(error) == 0 &&
           number_at(error, "undefined").value_or(0) + number_at(error, "not_judged").value_or(0) > 0;
}

constexpr std::string_view kEdges = "edge_displacement_px.";

/// A metric of shadow edges of one light, which has some; nothing where the record does not say.
std::optional<EdgeFigure> edge_figure(const Metric& metric, const Json& error) {
    const auto member = [&](const char* name) { return number_at(error, std::string(kEdges) + name); };
    const EdgeRecord edges{member("mean"),
                           member("p95"),
                           member("max"),
                           member("pieces").value_or(0),
                           member("unmatched").value_or(0),
                           member("reach").value_or(kFarthest)};
    const std::string_view figure = metric.paths.substr(kEdges.size());
    if (figure == "mean") return edges.whole_mean();
    return figure == "p95" ? edges.whole_p95() : edges.whole_max();
}

bool is_of_edges(const Metric& metric) { return metric.paths.starts_with(kEdges); }

/// Whether a light has no shadow edges that a metric of them could be of.
bool without_edges(const Json& error) {
    const auto edges = error.find("edge_displacement_px");
    return edges == error.end() || edges->is_null();
}

/// Pools `path` over the lights with points; nothing where one of those has no value, and where one is unanswered.
template <class Add>
bool each_judged_light(const Json& cell, std::string_view path, const Add& add) {
    bool any = false;
    for (const Json& error : cell.at("errors")) {
        if (unanswered(error)) return false;
        if (points_of(error) == 0) continue;
        const auto value = sum_at(error, path);
        if (!value) return false;
        add(*value, points_of(error));
        any = true;
    }
    return any;
}

}  // namespace

std::span<const Metric> metrics() { return kMetrics; }

const Metric& find_metric(std::string_view name) {
    std::vector<std::string> known;
    for (const Metric& m : kMetrics) {
        if (m.name == name) return m;
        known.emplace_back(m.name);
    }
    throw UsageError(fmt::format("unknown metric \"{}\"{} (umbra list metrics names them)", name,
                                 did_you_mean(std::string(name), known)));
}

std::optional<Counted> counted(const Metric& metric, const Json& cell) {
    if (metric.kind != Kind::share || !cell.contains("errors")) return std::nullopt;
    Counted c;
    const bool judged = each_judged_light(cell, metric.paths, [&](double count, double points) {
        c.wrong += static_cast<std::uint64_t>(count);
        c.of += static_cast<std::uint64_t>(points);
    });
    return judged ? std::optional(c) : std::nullopt;
}

std::uint64_t points_compared(const Json& cell) {
    double points = 0;
    if (cell.contains("errors"))
        for (const Json& error : cell.at("errors")) points += points_of(error);
    return static_cast<std::uint64_t>(points);
}

std::optional<double> metric_value(const Metric& metric, const Json& cell) {
    if (metric.kind == Kind::entry) {
        const auto value = number_at(cell, metric.paths);
        return value ? std::optional(*value * metric.scale) : std::nullopt;
    }
    if (!cell.contains("errors")) return std::nullopt;
    if (metric.kind == Kind::share) {
        const auto c = counted(metric, cell);
        return c ? std::optional(static_cast<double>(c->wrong) / static_cast<double>(c->of)) : std::nullopt;
    }
    double sum = 0, points = 0, largest = 0;
    bool any       = false;
    const auto add = [&](double value, double n) {
        sum += n * (metric.kind == Kind::rms ? value * value : value);
        points += n;
        largest = std::max(largest, value);
        any     = true;
    };
    if (is_of_edges(metric)) {
        for (const Json& error : cell.at("errors")) {
            if (unanswered(error)) return std::nullopt;
            if (points_of(error) == 0 || without_edges(error)) continue;
            const auto figure = edge_figure(metric, error);
            if (!figure) return std::nullopt;
            add(figure->value, 1);
        }
        return any ? std::optional(largest) : std::nullopt;
    }
    if (!each_judged_light(cell, metric.paths, add)) return std::nullopt;
    if (metric.kind == Kind::largest) return largest;
    return metric.kind == Kind::rms ? std::sqrt(sum / points) : sum / points;
}

bool is_at_least(const Metric& metric, const Json& cell) {
    if (!is_of_edges(metric) || !cell.contains("errors")) return false;
    return std::ranges::any_of(cell.at("errors"), [&](const Json& error) {
        if (points_of(error) == 0 || without_edges(error)) return false;
        const auto figure = edge_figure(metric, error);
        return figure && figure->at_least;
    });
}

std::vector<MetricRecord> metric_records() {
    std::vector<MetricRecord> all;
    for (const Metric& m : kMetrics) all.push_back({std::string(m.name), std::string(m.unit), std::string(m.doc)});
    return all;
}

LimitText parse_limit_text(const std::string& text, std::string_view expected) {
    const std::size_t eq = text.find('=');
    if (eq == std::string::npos) throw UsageError(fmt::format("--max {}: expected {}", text, expected));
    LimitText limit{text.substr(0, eq), 0};
    const char* end        = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data() + eq + 1, end, limit.most);
    if (error != std::errc() || at != end || !std::isfinite(limit.most) || limit.most < 0)
        throw UsageError(fmt::format("--max {}: found the limit \"{}\", expected a finite number of at least 0", text,
                                     text.substr(eq + 1)));
    return limit;
}

}  // namespace umbra
