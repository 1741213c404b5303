// results.json of a sweep over one scene, as a value: many settings of shadow methods, in several views.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/results.h"
#include "umbra/bench/time/workload.h"

namespace umbra {

/// A metric as records and `umbra list` name it.
struct MetricRecord {
    std::string name{}, unit{}, doc{};
};
template <class Fields>
void describe(Fields& of, Is<MetricRecord>) {
    of.must("name", &MetricRecord::name, "");
    of("unit", &MetricRecord::unit, "empty for pure numbers");
    of("doc", &MetricRecord::doc, "");
}

template <class Fields>
void describe(Fields& of, Is<Workload>) {
    of("camera", &Workload::camera, "", at_least(0));
    of("light", &Workload::light, "", at_least(0));
    of("object", &Workload::object, "", at_least(0));
}

using Figures = Members<std::optional<double>>;  ///< by the names of metrics; nothing where a view was not judged
[[nodiscard]] inline std::optional<double> figure_of(const Figures& figures, std::string_view metric) {
    const auto* figure = figures.find(metric);
    return figure != nullptr ? *figure : std::nullopt;
}

struct SweptViewRecord {
    std::uint64_t view = 0;
    Figures metrics{};
    std::vector<std::string> at_least{};
    std::vector<ErrorRecord> errors{};
    std::optional<ImageRecord> image{};
};
template <class Fields>
void describe(Fields& of, Is<SweptViewRecord>) {
    of("view", &SweptViewRecord::view, "");
    of("metrics", &SweptViewRecord::metrics, "", at_least(0));
    of.may("at_least", &SweptViewRecord::at_least,
           "metrics whose figure is the least that it may be: part of a shadow's edge is missing");
    of.may("errors", &SweptViewRecord::errors, "one a light");
    of.may("image", &SweptViewRecord::image, "differences of its picture from the reference's");
}

struct SweptSettingRecord {
    std::string text{}, name{}, title{};
    std::optional<std::string> preset{};
    Members<Scalar> parameters{};
    ServiceRecord serves{};
    std::optional<FailureRecord> failed{};
    std::string measures{}, compared_with{};
    std::optional<std::uint64_t> memory_bytes{}, points_bytes{};
    std::optional<double> coverage{};
    std::optional<std::string> excluded{};
    std::vector<SweptViewRecord> views{};
    Figures values{}, bounds{};
    std::optional<TurnTimesRecord> times{};
    std::optional<double> cost_ms{};
};
template <class Fields>
void describe(Fields& of, Is<SweptSettingRecord>) {
    of.must("text", &SweptSettingRecord::text, "as typed: METHOD:k=v,...");
    of.must("name", &SweptSettingRecord::name, "");
    of("title", &SweptSettingRecord::title, "");
    of("preset", &SweptSettingRecord::preset, "the preset that has these settings");
    of("parameters", &SweptSettingRecord::parameters, "all of them, by name");
    of("serves", &SweptSettingRecord::serves, "");
    of.may("failed", &SweptSettingRecord::failed, "what it threw, or why it was cut short");
    of.may("measures", &SweptSettingRecord::measures, "which visible fraction of an area light the method measures");
    of.may("compared_with", &SweptSettingRecord::compared_with, "as in records of compare");
    of.may("memory_bytes", &SweptSettingRecord::memory_bytes, "of geometry and of the last light");
    of.may("points_bytes", &SweptSettingRecord::points_bytes, "of the surface points, for all lights");
    of.may("coverage", &SweptSettingRecord::coverage, "the fraction of a view's points that it answers, the least");
    of("excluded", &SweptSettingRecord::excluded, "why it is on no front");
    of("views", &SweptSettingRecord::views, "");
    of("values", &SweptSettingRecord::values, "the largest of the views", at_least(0));
    of("bounds", &SweptSettingRecord::bounds, "what a further view exceeds in one case of twenty", at_least(0));
    of.may("times", &SweptSettingRecord::times, "");
    of("cost_ms", &SweptSettingRecord::cost_ms, "of a frame of the workload", at_least(0));
}

/// The run in which all settings were timed.
struct SweptTurnsRecord {
    bool pinned = false;
    std::optional<double> noise_bar{};
    std::vector<double> calibration_ms{};
    friend bool operator==(const SweptTurnsRecord&, const SweptTurnsRecord&) = default;
};
template <class Fields>
void describe(Fields& of, Is<SweptTurnsRecord>) {
    of("pinned", &SweptTurnsRecord::pinned, "each thread stayed on one processor");
    of("noise_bar", &SweptTurnsRecord::noise_bar, "how far from 1 the ratio of a setting with itself may lie",
       at_least(0));
    of("calibration_ms", &SweptTurnsRecord::calibration_ms, "as in records of compare");
}

struct SweepRecord {
    std::uint64_t views = 1;
    std::vector<MetricRecord> metrics{};
    std::optional<SweptTurnsRecord> turns{};
    Workload workload{};
    std::vector<SweptSettingRecord> settings{};
    Members<std::vector<std::string>> fronts{};
};
template <class Fields>
void describe(Fields& of, Is<SweepRecord>) {
    of("views", &SweepRecord::views, "", at_least(1));
    of("metrics", &SweepRecord::metrics, "");
    of("turns", &SweepRecord::turns, "of the one run in which all settings were timed; null where none was");
    of("workload", &SweepRecord::workload, "events a second");
    of("settings", &SweepRecord::settings, "");
    of("fronts", &SweepRecord::fronts,
       "for each metric the settings, as typed, that no other one beats in both the cost of a frame and the largest error "
       "of the views");
}

struct SweepResults {
    HeadRecord head{};
    MachineRecord machine{};
    SceneRecord scene{};
    FactsRecord facts{};
    SizeRecord size{};
    std::vector<LightRecord> lights{};
    ReferenceRecord reference{};
    SweepRecord sweep{};
    std::optional<BudgetRecord> budget{};
};
template <class Fields>
void describe(Fields& of, Is<SweepResults>) {
    of.all(&SweepResults::head);
    of("machine", &SweepResults::machine, "");
    of("scene", &SweepResults::scene, "");
    of("facts", &SweepResults::facts, "");
    of("size", &SweepResults::size, "");
    of("lights", &SweepResults::lights, "");
    of("reference", &SweepResults::reference, "");
    of.must("sweep", &SweepResults::sweep, "");
    of.may("budget", &SweepResults::budget, "");
}

}  // namespace umbra
