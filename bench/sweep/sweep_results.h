// results.json of a sweep over one scene, as a value: many settings of shadow methods, in several views.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/lab/workload.h"

namespace umbra {

/// A metric as records and `umbra list` name it.
struct MetricRecord {
    std::string name{}, unit{}, doc{};
};
DESCRIBE(MetricRecord) {
    of.must(MEMBER(name));
    of(MEMBER(unit), "empty for pure numbers");
    MEMBERS(doc);
}

DESCRIBE(Workload) {
    of(MEMBER(camera), "", at_least(0));
    of(MEMBER(light), "", at_least(0));
    of(MEMBER(object), "", at_least(0));
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
DESCRIBE(SweptViewRecord) {
    MEMBERS(view);
    of(MEMBER(metrics), "", at_least(0));
    of.may(MEMBER(at_least), "metrics whose figure is the least that it may be: part of a shadow's edge is missing");
    of.may(MEMBER(errors), "one a light");
    of.may(MEMBER(image), "differences of its picture from the reference's");
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
DESCRIBE(SweptSettingRecord) {
    of.must(MEMBER(text), "as typed: METHOD:k=v,...");
    of.must(MEMBER(name));
    MEMBERS(title);
    of(MEMBER(preset), "the preset that has these settings");
    of(MEMBER(parameters), "all of them, by name");
    MEMBERS(serves);
    of.may(MEMBER(failed), "what it threw, or why it was cut short");
    of.may(MEMBER(measures), "which visible fraction of an area light the method measures");
    of.may(MEMBER(compared_with), "as in records of compare");
    of.may(MEMBER(memory_bytes), "of geometry and of the last light");
    of.may(MEMBER(points_bytes), "of the surface points, for all lights");
    of.may(MEMBER(coverage), "the fraction of a view's points that it answers, the least");
    of(MEMBER(excluded), "why it is on no front");
    MEMBERS(views);
    of(MEMBER(values), "the largest of the views", at_least(0));
    of(MEMBER(bounds), "what a further view exceeds in one case of twenty", at_least(0));
    of.may(MEMBER(times));
    of(MEMBER(cost_ms), "of a frame of the workload", at_least(0));
}

/// The run in which all settings were timed.
struct SweptTurnsRecord {
    bool pinned = false;
    std::optional<double> noise_bar{};
    std::vector<double> calibration_ms{};
    friend bool operator==(const SweptTurnsRecord&, const SweptTurnsRecord&) = default;
};
DESCRIBE(SweptTurnsRecord) {
    of(MEMBER(pinned), "each thread stayed on one processor");
    of(MEMBER(noise_bar), "how far from 1 the ratio of a setting with itself may lie", at_least(0));
    of(MEMBER(calibration_ms), "as in records of compare");
}

struct SweepRecord {
    std::uint64_t views = 1;
    std::vector<MetricRecord> metrics{};
    std::optional<SweptTurnsRecord> turns{};
    Workload workload{};
    std::vector<SweptSettingRecord> settings{};
    Members<std::vector<std::string>> fronts{};
};
DESCRIBE(SweepRecord) {
    of(MEMBER(views), "", at_least(1));
    MEMBERS(metrics);
    of(MEMBER(turns), "of the one run in which all settings were timed; null where none was");
    of(MEMBER(workload), "events a second");
    MEMBERS(settings);
    of(MEMBER(fronts),
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
DESCRIBE(SweepResults) {
    of.all(&R::head);
    MEMBERS(machine, scene, facts, size, lights, reference);
    of.must(MEMBER(sweep));
    of.may(MEMBER(budget));
}

}  // namespace umbra
