#include "umbra/bench/studies/shading/shading_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "umbra/bench/statistics/pareto.h"
#include "umbra/bench/statistics/statistics.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// Null, as infinity is written, is beyond every limit.
double worst(const Json& model, std::string_view metric) {
    const Json& error = model["worst"][std::string(metric)];
    return error.is_null() ? std::numeric_limits<double>::infinity() : error.get<double>();
}

std::vector<double> times(const Json& model) { return model["times_ms"].get<std::vector<double>>(); }
double cost(const Json& model) { return median(times(model)); }
std::string name(const Json& model) { return model["name"].get<std::string>(); }

/// The largest error over its limit; above 1 where a limit is exceeded.
double worst_ratio(const Json& model, std::span<const ShadingLimit> limits) {
    double largest = 0;
    for (const ShadingLimit& limit : limits) {
        const double error = worst(model, limit.metric);
        if (error > 0)
            largest = std::max(largest, limit.most > 0 ? error / limit.most : std::numeric_limits<double>::infinity());
    }
    return largest;
}

Json ratio_json(const Json& model, const Ratio& ratio) {
    return {{"model", name(model)},
            {"ratio", number(ratio.median)},
            {"low", ratio.has_interval() ? number(ratio.interval.low) : Json()},
            {"high", number(ratio.interval.high)},
            {"rounds", ratio.pairs},
            {"coverage", ratio.coverage}};
}

std::string in_words(const Json& ratio) {
    if (ratio["low"].is_null())
        return fmt::format("{:.2f} ({} rounds)", ratio["ratio"].get<double>(), ratio["rounds"].get<int>());
    return fmt::format("{:.2f} ({:.2f} to {:.2f}, {:.1f} %)", ratio["ratio"].get<double>(), ratio["low"].get<double>(),
                       ratio["high"].get<double>(), 100 * ratio["coverage"].get<double>());
}

}  // namespace

ShadingLimit parse_shading_limit(const std::string& text) {
    const std::string expected =
        fmt::format("METRIC=LIMIT with one of {}, as rmse=0.01", fmt::join(kShadingErrors, ", "));
    const LimitText limit = parse_limit_text(text, expected);
    const auto metric     = std::ranges::find(kShadingErrors, limit.metric);
    if (metric == kShadingErrors.end()) throw UsageError(fmt::format("--max {}: expected {}", text, expected));
    return {*metric, limit.most};
}

Json shading_front(const Json& record) {
    std::vector<CostError> points;
    for (const Json& model : record["models"]) points.push_back({cost(model), worst(model, "rmse")});
    Json front = Json::array();
    for (const std::size_t k : pareto_front(points)) front.push_back(name(record["models"][k]));
    return front;
}

Json choose_shading(const Json& record, std::span<const ShadingLimit> limits) {
    Json choice = {{"limits", Json::array()}, {"model", nullptr},     {"ms", nullptr},     {"of_phong", nullptr},
                   {"tied", Json::array()},   {"runner_up", nullptr}, {"nearest", nullptr}};
    for (const ShadingLimit& limit : limits)
        choice["limits"].push_back({{"metric", limit.metric}, {"most", number(limit.most)}});
    std::vector<const Json*> within, all;
    for (const Json& model : record["models"]) {
        all.push_back(&model);
        if (worst_ratio(model, limits) <= 1) within.push_back(&model);
    }
    if (within.empty()) {
        const Json& nearest =
            **std::ranges::min_element(all, {}, [&](const Json* m) { return worst_ratio(*m, limits); });
        choice["nearest"] = {{"model", name(nearest)}, {"factor", number(worst_ratio(nearest, limits))}};
        return choice;
    }
    std::ranges::stable_sort(within, {}, [](const Json* m) { return cost(*m); });
    const Json& chosen = *within.front();
    const double noise_bar =
        record["noise_bar"].is_null() ? std::numeric_limits<double>::infinity() : record["noise_bar"].get<double>();
    choice["model"] = name(chosen);
    choice["ms"]    = number(cost(chosen));
    for (const Json* model : all)
        if (name(*model) == "phong")
            choice["of_phong"] = ratio_json(*model, paired_ratio(times(chosen), times(*model)));
    for (std::size_t k = 1; k < within.size(); ++k) {
        const Ratio ratio = paired_ratio(times(*within[k]), times(chosen));
        if (!differs(ratio, noise_bar))
            choice["tied"].push_back(name(*within[k]));
        else if (choice["runner_up"].is_null())
            choice["runner_up"] = ratio_json(*within[k], ratio);
    }
    return choice;
}

std::vector<std::string> shading_findings(const Json& record) {
    std::vector<std::string> findings;
    std::vector<std::string> front = record["front"].get<std::vector<std::string>>();
    findings.push_back(
        fmt::format("No other model is both faster and closer to phong (RMSE) than: {}.", fmt::join(front, ", ")));
    if (!record.contains("choice")) return findings;
    const Json& choice = record["choice"];
    std::vector<std::string> limits;
    for (const Json& limit : choice["limits"])
        limits.push_back(
            fmt::format("{} at most {:g}", limit["metric"].get<std::string>(), limit["most"].get<double>()));
    const int views          = record["views"].get<int>();
    const std::string within = fmt::format("With {} in {}", fmt::join(limits, " and "),
                                           views == 1 ? "this view" : fmt::format("each of {} views", views));
    if (choice["model"].is_null()) {
        const Json& factor = choice["nearest"]["factor"];
        findings.push_back(
            fmt::format("{}: none. Nearest: {}{}.", within, choice["nearest"]["model"].get<std::string>(),
                        factor.is_null() ? "" : fmt::format(", {:.3g} times a limit", factor.get<double>())));
        return findings;
    }
    std::string found =
        fmt::format("{}, the cheapest is {}: {:.2f} ms, {} of phong's time.", within,
                    choice["model"].get<std::string>(), choice["ms"].get<double>(), in_words(choice["of_phong"]));
    if (!choice["tied"].empty())
        found += fmt::format(" As cheap, as far as the noise of times lets one see: {}.",
                             fmt::join(choice["tied"].get<std::vector<std::string>>(), ", "));
    if (!choice["runner_up"].is_null())
        found += fmt::format(" Next: {}, {} times as long.", choice["runner_up"]["model"].get<std::string>(),
                             in_words(choice["runner_up"]));
    findings.push_back(std::move(found));
    return findings;
}

}  // namespace umbra
