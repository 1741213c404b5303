#include "umbra/bench/studies/shading/shading_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "umbra/bench/base/pareto.h"
#include "umbra/bench/base/statistics.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// What is not finite is beyond every limit.
double worst(const ShadingModelRecord& model, std::string_view metric) {
    const double error = metric == "rmse"   ? model.worst.rmse
                         : metric == "flip" ? model.worst.flip
                                            : model.worst.perceived;
    return std::isfinite(error) ? error : kInfinite;
}

double cost(const ShadingModelRecord& model) { return median(model.times_ms); }

/// The largest error over its limit; above 1 where a limit is exceeded.
double worst_ratio(const ShadingModelRecord& model, std::span<const ShadingLimit> limits) {
    double largest = 0;
    for (const ShadingLimit& limit : limits) {
        const double error = worst(model, limit.metric);
        if (error > 0) largest = std::max(largest, limit.most > 0 ? error / limit.most : kInfinite);
    }
    return largest;
}

ShadingRatioRecord ratio_record(const ShadingModelRecord& model, const Ratio& ratio) {
    return {model.name,          ratio.median, ratio.has_interval() ? ratio.interval.low : kUnknown,
            ratio.interval.high, ratio.pairs,  ratio.coverage};
}

std::string in_words(const ShadingRatioRecord& ratio) {
    if (!std::isfinite(ratio.low)) return fmt::format("{:.2f} ({} rounds)", ratio.ratio, ratio.rounds);
    return fmt::format("{:.2f} ({:.2f} to {:.2f}, {:.1f} %)", ratio.ratio, ratio.low, ratio.high, 100 * ratio.coverage);
}

}  // namespace

ShadingLimit parse_shading_limit(const std::string& text) {
    const std::string expected =
        fmt::format("METRIC=LIMIT with one of {}, as rmse=0.01", fmt::join(kShadingErrors, ", "));
    const LimitText limit = parse_limit_text(text, expected);
    const auto metric     = std::ranges::find(kShadingErrors, limit.metric);
    if (metric == kShadingErrors.end()) throw UsageError(fmt::format("--max {}: expected {}", text, expected));
    return {std::string(*metric), limit.most};
}

std::vector<std::string> shading_front(const std::vector<ShadingModelRecord>& models) {
    std::vector<CostError> points;
    for (const ShadingModelRecord& model : models) points.push_back({cost(model), worst(model, "rmse")});
    std::vector<std::string> front;
    for (const std::size_t k : pareto_front(points)) front.push_back(models[k].name);
    return front;
}

ShadingChoiceRecord choose_shading(const ShadingRecord& record, std::span<const ShadingLimit> limits) {
    ShadingChoiceRecord choice{.limits = {limits.begin(), limits.end()}};
    std::vector<const ShadingModelRecord*> within;
    for (const ShadingModelRecord& model : record.models)
        if (worst_ratio(model, limits) <= 1) within.push_back(&model);
    if (within.empty()) {
        const ShadingModelRecord& nearest = *std::ranges::min_element(
            record.models, {}, [&](const ShadingModelRecord& m) { return worst_ratio(m, limits); });
        choice.nearest = {nearest.name, worst_ratio(nearest, limits)};
        return choice;
    }
    if (is_too_noisy(record.noise_bar)) {
        for (const ShadingModelRecord* model : within) choice.tied.push_back(model->name);
        return choice;
    }
    std::ranges::stable_sort(within, {}, [](const ShadingModelRecord* m) { return cost(*m); });
    const ShadingModelRecord& chosen = *within.front();
    choice.model                     = chosen.name;
    choice.ms                        = cost(chosen);
    for (const ShadingModelRecord& model : record.models)
        if (model.name == "phong") choice.of_phong = ratio_record(model, paired_ratio(chosen.times_ms, model.times_ms));
    for (std::size_t k = 1; k < within.size(); ++k) {
        const Ratio ratio = paired_ratio(within[k]->times_ms, chosen.times_ms);
        if (!differs(ratio, record.noise_bar))
            choice.tied.push_back(within[k]->name);
        else if (!choice.runner_up)
            choice.runner_up = ratio_record(*within[k], ratio);
    }
    return choice;
}

std::vector<std::string> shading_findings(const ShadingRecord& record) {
    const std::string noise =
        std::isfinite(record.noise_bar) ? fmt::format("by {:.0f} %", std::ceil(100 * record.noise_bar)) : "too much";
    std::vector<std::string> findings{
        is_too_noisy(record.noise_bar)
            ? fmt::format("Not ranked by time, as times vary {}: run it again when the machine is less busy.", noise)
            : fmt::format("No other model is both faster and closer to phong (RMSE) than: {}.",
                          fmt::join(record.front, ", "))};
    if (!record.choice) return findings;
    const ShadingChoiceRecord& choice = *record.choice;
    std::vector<std::string> limits;
    for (const ShadingLimit& limit : choice.limits)
        limits.push_back(fmt::format("{} at most {:g}", limit.metric, limit.most));
    const std::string within =
        fmt::format("With {} in {}", fmt::join(limits, " and "),
                    record.views == 1 ? "this view" : fmt::format("each of {} views", record.views));
    if (choice.nearest) {
        const double factor = choice.nearest->factor;
        findings.push_back(fmt::format("{}: none. Nearest: {}{}.", within, choice.nearest->model,
                                       std::isfinite(factor) ? fmt::format(", {:.3g} times a limit", factor) : ""));
        return findings;
    }
    if (!choice.model) {
        findings.push_back(fmt::format("{}: {}. None is called the cheapest, as times vary {}.", within,
                                       fmt::join(choice.tied, ", "), noise));
        return findings;
    }
    std::string found = fmt::format("{}, the cheapest is {}: {:.2f} ms, {} of phong's time.", within,
                                    choice.model.value(), choice.ms.value(), in_words(choice.of_phong.value()));
    if (!choice.tied.empty())
        found += fmt::format(" As cheap, as far as the noise of times lets one see: {}.", fmt::join(choice.tied, ", "));
    if (choice.runner_up)
        found += fmt::format(" Next: {}, {} times as long.", choice.runner_up->model, in_words(*choice.runner_up));
    findings.push_back(std::move(found));
    return findings;
}

}  // namespace umbra
