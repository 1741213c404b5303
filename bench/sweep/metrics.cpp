#include "umbra/bench/sweep/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/base/suggest.h"

namespace umbra {
namespace {

using Kind  = Metric::Kind;
using Count = std::optional<std::uint64_t>;
using Edge  = const WholeEdge&;
using Error = const ErrorRecord&;

std::optional<double> one(Count count) { return count ? std::optional(double(*count)) : std::nullopt; }
std::optional<double> both(Count a, Count b) { return a && b ? std::optional(double(*a + *b)) : std::nullopt; }
FalseShadowRecord false_shadow(Error e) { return e.false_shadow.value_or(FalseShadowRecord{}); }
FalseLightRecord false_light(Error e) { return e.false_light.value_or(FalseLightRecord{}); }
ImageRecord picture(const Cell& cell) { return cell.method.image.value_or(ImageRecord{}); }

constexpr std::string_view kShare = "share of points";

constexpr std::array kMetrics{
    Metric{"rmse", "", "Root mean square error of S_j.", Kind::rms, [](Error e) { return e.rmse; }},
    Metric{"mae", "", "Mean absolute error of S_j.", Kind::mean, [](Error e) { return e.mae; }},
    Metric{"max", "", "Largest error of S_j.", Kind::largest, [](Error e) { return e.max; }},
    Metric{"interior", kShare, "Wrong points outside the edge band.", Kind::share,
           [](Error e) { return both(false_shadow(e).interior, false_light(e).interior); }},
    Metric{"edge", kShare, "Wrong points in the edge band.", Kind::share,
           [](Error e) { return both(false_shadow(e).edge, false_light(e).edge); }},
    Metric{"false_shadow.interior", kShare, "False shadow outside the edge band.", Kind::share,
           [](Error e) { return one(false_shadow(e).interior); }},
    Metric{"false_shadow.edge", kShare, "False shadow in the edge band.", Kind::share,
           [](Error e) { return one(false_shadow(e).edge); }},
    Metric{"false_shadow.acne", kShare, "False shadow by the point's own surface.", Kind::share,
           [](Error e) { return one(false_shadow(e).acne); }},
    Metric{"false_light.interior", kShare, "False light outside the edge band.", Kind::share,
           [](Error e) { return one(false_light(e).interior); }},
    Metric{"false_light.edge", kShare, "False light in the edge band.", Kind::share,
           [](Error e) { return one(false_light(e).edge); }},
    Metric{"false_light.detachment", kShare, "False light at a contact.", Kind::share,
           [](Error e) { return one(false_light(e).detachment); }},
    Metric{"false_light.leak", kShare, "False light elsewhere.", Kind::share,
           [](Error e) { return one(false_light(e).leak); }},
    Metric{"penumbra_error", kShare, "Wrong points in penumbrae of a method that has no penumbra there.", Kind::share,
           [](Error e) { return both(e.penumbra_error.false_shadow, e.penumbra_error.false_light); }},
    Metric{"noise_error", kShare, "Points that random numbers make wrong.", Kind::share,
           [](Error e) { return both(e.noise_error.false_shadow, e.noise_error.false_light); }},
    Metric{"terminator.wrong", kShare, "Wrong points where shading normal and facet disagree.", Kind::share,
           [](Error e) { return one(e.terminator.wrong); }},
    Metric{"edge_displacement_px.mean", "pixels",
           "Mean distance of shadow edges from the true ones; pieces not found within 8 pixels count as 8.",
           Kind::largest, nullptr, [](Edge e) { return e.mean(); }},
    Metric{"edge_displacement_px.p95", "pixels",
           "95 % of the pieces of shadow edges lie at most this far off; one not found within 8 pixels counts as 8.",
           Kind::largest, nullptr, [](Edge e) { return e.p95(); }},
    Metric{"edge_displacement_px.max", "pixels",
           "Largest distance of a shadow edge from the true one; 8 where a piece is not found within 8 pixels.",
           Kind::largest, nullptr, [](Edge e) { return e.max(); }},
    Metric{"image_rmse", "", "Root mean square error of the linear picture.", Kind::entry, nullptr, nullptr,
           [](const Cell& c) { return picture(c).rmse; }},
    Metric{"flip", "", "Mean FLIP of the displayed picture.", Kind::entry, nullptr, nullptr,
           [](const Cell& c) { return picture(c).flip; }},
    Metric{"flip_hdr", "", "Mean FLIP of the linear picture.", Kind::entry, nullptr, nullptr,
           [](const Cell& c) { return picture(c).flip_hdr; }},
    Metric{"undefined", kShare, "Points that the method has no answer for.", Kind::entry, nullptr, nullptr,
           [](const Cell& c) { return c.undefined; }},
    Metric{"memory_mb", "MB", "Memory held after build and aim.", Kind::entry, nullptr, nullptr,
           [](const Cell& c) {
               const Count bytes = c.method.memory_bytes;
               return bytes ? std::optional(double(*bytes) / 1e6) : std::nullopt;
           }},
};

double points_of(Error error) { return double(error.points.value_or(0)); }

/// Whether a light has points, and the method or the reference answers none of them.
bool unanswered(Error error) { return points_of(error) == 0 && error.undefined + error.not_judged > 0; }

/// Calls add(value, points) for each light that has points compared, and for a metric of edges an edge, too. False
/// where there is none, where one of them has no value, and where a light is unanswered.
template <class Add>
bool each_judged_light(const Metric& metric, const Cell& cell, const Add& add) {
    if (cell.brief && needs_whole_cell(metric)) return false;
    bool any = false;
    for (Error error : cell.method.errors) {
        if (unanswered(error)) return false;
        if (points_of(error) == 0 || (metric.of_edge != nullptr && !error.edge_displacement_px)) continue;
        std::optional<double> value;
        if (metric.of_edge == nullptr)
            value = metric.of_light(error);
        else if (const auto figure = metric.of_edge(WholeEdge(*error.edge_displacement_px)))
            value = figure->value;
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

std::optional<Counted> counted(const Metric& metric, const Cell& cell) {
    if (metric.kind != Kind::share) return std::nullopt;
    Counted c;
    const bool judged = each_judged_light(metric, cell, [&](double count, double points) {
        c.wrong += static_cast<std::uint64_t>(count);
        c.of += static_cast<std::uint64_t>(points);
    });
    return judged ? std::optional(c) : std::nullopt;
}

std::uint64_t points_compared(const Cell& cell) {
    std::uint64_t points = 0;
    for (Error error : cell.method.errors) points += error.points.value_or(0);
    return points;
}

std::optional<double> metric_value(const Metric& metric, const Cell& cell) {
    if (metric.kind == Kind::entry) return metric.of_cell(cell);
    if (metric.kind == Kind::share) {
        const auto c = counted(metric, cell);
        return c ? std::optional(static_cast<double>(c->wrong) / static_cast<double>(c->of)) : std::nullopt;
    }
    double sum = 0, points = 0, largest = 0;
    const bool judged = each_judged_light(metric, cell, [&](double value, double n) {
        sum += n * (metric.kind == Kind::rms ? value * value : value);
        points += n;
        largest = std::max(largest, value);
    });
    if (!judged) return std::nullopt;
    if (metric.kind == Kind::largest) return largest;
    return metric.kind == Kind::rms ? std::sqrt(sum / points) : sum / points;
}

std::optional<double> largest_value(const Metric& metric, std::span<const Cell> views) {
    std::optional<double> largest;
    for (const Cell& cell : views) {
        const auto value = metric_value(metric, cell);
        if (!value) return std::nullopt;
        largest = std::max(largest.value_or(*value), *value);
    }
    return largest;
}

bool is_at_least(const Metric& metric, const Cell& cell) {
    if (metric.of_edge == nullptr) return false;
    return std::ranges::any_of(cell.method.errors, [&](Error error) {
        if (points_of(error) == 0 || !error.edge_displacement_px) return false;
        const auto figure = metric.of_edge(WholeEdge(*error.edge_displacement_px));
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
    const auto most = number_from<double>(text.substr(eq + 1));
    if (!most || !std::isfinite(*most) || *most < 0)
        throw UsageError(fmt::format("--max {}: found the limit \"{}\", expected a finite number of at least 0", text,
                                     text.substr(eq + 1)));
    return {text.substr(0, eq), *most};
}

}  // namespace umbra
