#include "umbra/bench/sweep/swept_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

struct KnownMetric {
    const char *name, *title;
};
constexpr std::array kShown = {KnownMetric{"rmse", "RMSE of S"},
                               KnownMetric{"interior", "Wrong interior points, fraction"},
                               KnownMetric{"edge_displacement_px.p95", "Edge displacement (95 %), pixels"},
                               KnownMetric{"flip", "FLIP of the picture, mean"}};

std::vector<SweptMetric> shown_metrics(const SweepRecord& sweep) {
    std::vector<SweptMetric> all, shown;
    for (const MetricRecord& m : sweep.metrics)
        all.push_back({m.name, in_words(m.name) + (m.unit.empty() ? "" : ", " + m.unit), m.doc});
    for (const KnownMetric& known : kShown)
        for (const SweptMetric& metric : all)
            if (metric.name == known.name) shown.push_back({metric.name, known.title, metric.doc});
    return shown.empty() ? all : shown;
}

std::optional<SweptError> error_of(const SweptSettingRecord& setting, const std::string& metric) {
    std::optional<SweptError> error;
    for (const SweptViewRecord& view : setting.views) {
        const auto e = figure_of(view.metrics, metric);
        if (!e) continue;
        if (!error) error = SweptError{.least = *e, .worst = *e};
        error->least    = std::min(error->least, *e);
        error->worst    = std::max(error->worst, *e);
        error->at_least = error->at_least || std::ranges::find(view.at_least, metric) != view.at_least.end();
    }
    if (!error) return error;
    error->bound = figure_of(setting.bounds, metric);
    if (error->bound) error->bound = std::max(*error->bound, error->worst);
    return error;
}

/// By linear interpolation between the sorted values.
double quantile(std::vector<double> values, double fraction) {
    std::sort(values.begin(), values.end());
    const double at         = fraction * double(values.size() - 1);
    const std::size_t below = std::size_t(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - double(below)) * (values[above] - values[below]);
}

std::optional<FrameCost> cost_of(const Workload& workload, const SweptSettingRecord& setting) {
    if (!setting.cost_ms) return std::nullopt;
    FrameCost cost{*setting.cost_ms, *setting.cost_ms, *setting.cost_ms};
    const TimesRecord times  = setting.times.value_or(TurnTimesRecord{}).phases;
    const auto phase         = [](const std::optional<TimingRecord>& of) { return of.value_or(TimingRecord{}); };
    const TimingRecord build = phase(times.build_ms), aim = phase(times.aim_ms),
                       look = phase(times.look_ms),  // none in records of older versions
        visibility          = phase(times.visibility_ms);
    const auto cost_by      = [&](const auto& ms) {
        return frame_cost_ms(workload, {ms(build), ms(aim), ms(look), ms(visibility)});
    };
    std::vector<double> rounds;
    if (build.samples.size() == visibility.samples.size() && aim.samples.size() == visibility.samples.size())
        for (std::size_t r = 0; r < visibility.samples.size(); ++r)
            rounds.push_back(cost_by([&](const TimingRecord& t) { return r < t.samples.size() ? t.samples[r] : 0; }));
    if (!rounds.empty()) {
        cost.low  = std::min(*setting.cost_ms, quantile(rounds, 0.25));
        cost.high = std::max(*setting.cost_ms, quantile(rounds, 0.75));
        return cost;
    }
    if (known(visibility.min))
        cost.low = std::min(*setting.cost_ms, cost_by([](const TimingRecord& t) { return known(t.min).value_or(0); }));
    if (known(visibility.max))
        cost.high = std::max(*setting.cost_ms, cost_by([](const TimingRecord& t) { return known(t.max).value_or(0); }));
    return cost;
}

SweptSetting setting_of(const SweptScene& scene, SweptSettingRecord record) {
    SweptSetting s{std::move(record)};
    if (s.title.empty()) s.title = in_words(s.name);
    if (s.excluded == "") s.excluded.reset();
    const auto colon = s.text.find(':');
    s.label          = colon == std::string::npos ? "defaults" : s.text.substr(colon + 1);
    if (s.failed)
        s.note = "failed: " + s.failed->message;
    else if (s.serves.how == "not")
        s.note = "not served: " + s.serves.why;
    if (s.note.empty()) s.cost = cost_of(scene.workload, s);
    for (const SweptMetric& metric : scene.metrics)
        s.errors.push_back(s.note.empty() ? error_of(s, metric.name) : std::nullopt);
    return s;
}

}  // namespace

SweptScene read_swept_scene(const std::filesystem::path& file) {
    const Field root     = read_results(file);
    SweepResults results = from_record<SweepResults>(root);
    SweepRecord& sweep   = results.sweep;
    SweptScene scene{.head      = results.head,
                     .machine   = results.machine,
                     .file      = file,
                     .name      = root["scene"]["name"].required_text(),
                     .title     = results.scene.title,
                     .triangles = double(results.facts.triangles),
                     .views     = int(std::clamp<std::uint64_t>(sweep.views, 1, 1000000)),
                     .workload  = sweep.workload};
    if (scene.title.empty()) scene.title = in_words(scene.name);
    if (sweep.turns) scene.noise_bar = sweep.turns->noise_bar.value_or(noise_bar({}));  // of too few rounds
    if (!(scene.workload.camera + scene.workload.light + scene.workload.object > 0))
        root["sweep"]["workload"].refuse("something that moves");
    scene.metrics = shown_metrics(sweep);
    for (SweptSettingRecord& setting : sweep.settings) scene.settings.push_back(setting_of(scene, std::move(setting)));
    return scene;
}

bool is_timed_on(const SweptScene& scene, const SweptMethod& method) {
    return std::ranges::any_of(scene.settings, [&](const SweptSetting& s) { return s.name == method.name && s.cost; });
}

std::vector<SweptMethod> swept_methods(const std::vector<SweptScene>& scenes) {
    std::vector<SweptMethod> methods;
    for (const SweptScene& scene : scenes)
        for (const SweptSetting& s : scene.settings)
            if (index_of(methods, s.name) == methods.size()) methods.push_back({s.name, s.title});
    const auto scenes_of = [&](const SweptMethod& m) {
        return std::ranges::count_if(scenes, [&](const SweptScene& scene) { return is_timed_on(scene, m); });
    };
    std::ranges::stable_sort(methods,
                             [&](const SweptMethod& a, const SweptMethod& b) { return scenes_of(a) > scenes_of(b); });
    return methods;
}

std::size_t index_of(const std::vector<SweptMethod>& methods, const std::string& name) {
    return std::size_t(std::ranges::find(methods, name, &SweptMethod::name) - methods.begin());
}

}  // namespace umbra
