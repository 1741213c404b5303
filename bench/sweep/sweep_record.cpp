#include "umbra/bench/sweep/sweep_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/base/pareto.h"
#include "umbra/bench/base/statistics.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/metrics.h"

namespace umbra {
namespace {

SweptViewRecord view_record(const Cell& cell) {
    SweptViewRecord view{.view = cell.view, .errors = cell.method.errors, .image = cell.method.image};
    for (const Metric& m : metrics()) {
        view.metrics(m.name) = metric_value(m, cell);
        if (is_at_least(m, cell)) view.at_least.emplace_back(m.name);
    }
    return view;
}

SweptSettingRecord setting_record(const MeasuredSetting& s, const Workload& workload) {
    const MethodRecord& first = s.views.front().method;
    const auto preset         = preset_of(s.choice);
    std::string why           = why_unfit(s.views);
    if (why.empty() && !s.times) why = "it was not timed";
    SweptSettingRecord entry{.text          = first.text,
                             .name          = first.name,
                             .title         = first.title,
                             .parameters    = first.parameters,
                             .serves        = first.serves,
                             .failed        = first.failed,
                             .measures      = first.measures,
                             .compared_with = first.compared_with,
                             .memory_bytes  = first.memory_bytes,
                             .points_bytes  = first.points_bytes,
                             .times         = s.times,
                             .cost_ms       = cost_of(s.times, workload)};
    if (!preset.empty()) entry.preset = preset;
    // As the errors, of the worst view.
    if (first.coverage) entry.coverage = 1 - most_undefined(s.views);
    if (!why.empty()) entry.excluded = std::move(why);
    for (const Cell& cell : s.views) entry.views.push_back(view_record(cell));
    for (const Metric& m : metrics()) {
        entry.values(m.name) = largest_value(m, s.views);
        entry.bounds(m.name) = upper_bound(m, s.views);
    }
    return entry;
}

bool may_be_on_front(const SweptSettingRecord& s, std::string_view metric) {
    return !s.excluded && s.cost_ms && figure_of(s.values, metric);
}

}  // namespace

std::optional<double> cost_of(const std::optional<TurnTimesRecord>& times, const Workload& workload) {
    if (!times) return std::nullopt;
    const TimesRecord& of = times->phases;
    const auto ms         = [](const std::optional<TimingRecord>& t) { return t ? t->median : kUnknown; };
    return frame_cost_ms(workload, {ms(of.build_ms), ms(of.aim_ms), ms(of.look_ms), ms(of.visibility_ms)});
}

SweepRecord sweep_record(std::span<const MeasuredSetting> settings, int views, const Workload& workload,
                         const std::optional<SweptTurnsRecord>& turns) {
    SweepRecord record{
        .views = static_cast<std::uint64_t>(views), .metrics = metric_records(), .turns = turns, .workload = workload};
    for (const MeasuredSetting& s : settings) record.settings.push_back(setting_record(s, workload));
    for (const Metric& m : metrics()) {
        std::vector<CostError> points;
        std::vector<std::string> texts;
        for (const SweptSettingRecord& s : record.settings) {
            if (!may_be_on_front(s, m.name)) continue;
            points.push_back({*s.cost_ms, *figure_of(s.values, m.name)});
            texts.push_back(s.text);
        }
        std::vector<std::string>& front = record.fronts(m.name);
        for (const std::size_t i : pareto_front(points)) front.push_back(texts[i]);
    }
    return record;
}

std::string front_in_words(const std::string& scene, const SweepRecord& sweep) {
    // Without times nothing is ranked by them; of too few rounds nobody knows how far they vary.
    const double bar       = !sweep.turns ? 0 : sweep.turns->noise_bar.value_or(noise_bar({}));
    const std::string what = scene + ": cost of a frame, S_j error (rmse), its upper bound; ",
                      vary = fmt::format("{:.0f} %", std::ceil(100 * bar));
    std::vector<std::string> texts;
    if (!is_too_noisy(bar))
        texts = *sweep.fronts.find("rmse");
    else
        for (const SweptSettingRecord& s : sweep.settings)
            if (may_be_on_front(s, "rmse")) texts.push_back(s.text);
    std::string words =
        what + (is_too_noisy(bar) ? (std::isfinite(bar) ? "not ranked, as times vary by " + vary + ":\n"
                                                        : "not ranked, as times are of fewer than six rounds:\n")
                : bar > 0         ? "settings that no other beats in both, costs that differ by less than " + vary +
                                " are not told apart:\n"
                          : "settings that no other beats in both:\n");
    for (const std::string& text : texts) {
        const SweptSettingRecord& s = *std::ranges::find(sweep.settings, text, &SweptSettingRecord::text);
        const auto bound            = figure_of(s.bounds, "rmse");
        words += fmt::format("  {:>9.3f} ms  {:<9.3g}  {:<9}  {}\n", *s.cost_ms, *figure_of(s.values, "rmse"),
                             bound ? fmt::format("{:.3g}", *bound) : "-", text);
    }
    return words;
}

}  // namespace umbra
