#include "umbra/bench/sweep/bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <vector>

namespace umbra {
namespace {

using Kind = Metric::Kind;

/// The reference's doubt about S_j, the largest of all lights.
double half_width(const Cell& cell) {
    double widest = 0;
    for (const ErrorRecord& error : cell.method.errors)
        if (error.bracket) widest = std::max(widest, known(error.bracket->max_half_width).value_or(0));
    return widest;
}

bool is_error_of_s(const Metric& metric) {
    return metric.kind == Kind::rms || metric.kind == Kind::mean ||
           (metric.kind == Kind::largest && metric.unit.empty());
}

/// By proof: the setting serves so, and the metric is one that the proof is about.
bool is_exact(const Metric& metric, const Cell& cell, double value) {
    return cell.method.serves.how == "exactly" && (value == 0 || is_error_of_s(metric));
}

/// What the points of a view leave possible. A share is an estimate from as many points. Of errors of S_j only one that
/// was measured as 0 is: the points that none was found among may be wrong by all of S_j.
double possible(const Metric& metric, const Cell& cell, double measured) {
    if (const auto c = counted(metric, cell)) return upper_share(c->wrong, c->of);
    if (measured > 0 || !metric.unit.empty()) return measured;
    const double missed = upper_share(0, points_compared(cell));
    switch (metric.kind) {
        case Kind::rms: return std::sqrt(missed);
        case Kind::largest: return 1;
        case Kind::share:
        case Kind::mean:
        case Kind::entry: return missed;
    }
    return measured;
}

/// Normal prediction bound for one more value.
double prediction(const std::vector<double>& values) {
    const auto n = static_cast<double>(values.size());
    double mean = 0, squares = 0;
    for (const double v : values) mean += v / n;
    for (const double v : values) squares += (v - mean) * (v - mean);
    const boost::math::students_t t(n - 1);
    return mean + boost::math::quantile(t, kConfidence) * std::sqrt(squares / (n - 1)) * std::sqrt(1 + 1 / n);
}

}  // namespace

double upper_share(std::uint64_t wrong, std::uint64_t of) {
    if (of == 0 || wrong >= of) return 1;
    return boost::math::binomial_distribution<double>::find_upper_bound_on_p(
        static_cast<double>(of), static_cast<double>(wrong), 1 - kConfidence);
}

std::optional<double> possible_error(const Metric& metric, const Cell& cell) {
    const auto value = metric_value(metric, cell);
    if (const bool known = value && !is_at_least(metric, cell); !known) return std::nullopt;
    const double width = is_error_of_s(metric) ? half_width(cell) : 0;
    return (is_exact(metric, cell, *value) ? *value : possible(metric, cell, *value)) + width;
}

double share_beyond(int views, std::size_t tried) {
    if (views <= 0) return 1;
    return 1 - std::pow((1 - kConfidence) / static_cast<double>(tried), 1.0 / views);
}

double most_undefined(std::span<const Cell> views) {
    double undefined = 0;
    for (const Cell& cell : views) undefined = std::max(undefined, cell.undefined.value_or(0));
    return undefined;
}

std::string why_unfit(std::span<const Cell> views) {
    for (const Cell& cell : views) {
        if (cell.method.failed) return "it failed";
        if (cell.method.serves.how == "not") return cell.method.serves.why;
    }
    const double undefined = most_undefined(views);
    return undefined > kMostLeftOut ? fmt::format("it leaves {:.3g} % of a view's points undefined", 100 * undefined)
                                    : "";
}

std::optional<double> upper_bound(const Metric& metric, std::span<const Cell> views) {
    std::vector<double> values;
    bool exactly = true;
    for (const Cell& cell : views) {
        const auto value = metric_value(metric, cell);
        if (!value || is_at_least(metric, cell)) return std::nullopt;
        values.push_back(*value);
        exactly = exactly && is_exact(metric, cell, *value);
    }
    if (values.empty() || (!exactly && values.size() < 2)) return std::nullopt;
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (!exactly) values[v] = possible(metric, views[v], values[v]);
        if (is_error_of_s(metric)) values[v] += half_width(views[v]);
    }
    const double largest = *std::ranges::max_element(values);
    if (exactly) return largest;
    double bound = 0;
    if (*std::ranges::min_element(values) > 0) {
        for (double& v : values) v = std::log(v);
        bound = std::exp(prediction(values));
    } else {
        bound = prediction(values);
    }
    bound                = std::max(bound, largest);
    const bool at_most_1 = metric.kind == Kind::share || is_error_of_s(metric);
    return at_most_1 ? std::min(bound, std::max(1.0, largest)) : bound;
}

}  // namespace umbra
