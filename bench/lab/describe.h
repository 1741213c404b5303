// Facts, methods, machine and times as records: the parts that results.json of all commands, `inspect --json` and
// `list --json` share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

[[nodiscard]] std::string_view version();
[[nodiscard]] double load_average();    ///< of the last minute: programs that run or want to; NaN where unknown
[[nodiscard]] int usable_processors();  ///< those that this process may run on (its CPU affinity)

struct MachineRecord {
    std::string cpu{};
    std::uint64_t cores = 0, threads = 0, memory_bytes = 0;
    std::string system{}, compiler{};
};
DESCRIBE(MachineRecord) {
    of.name("machine");
    MEMBERS(cpu, cores);
    of(MEMBER(threads), "that the run used");
    MEMBERS(memory_bytes, system, compiler);
}

/// How each record begins.
struct HeadRecord {
    int schema = kResultsSchema;
    std::string version{}, command{};
};
DESCRIBE(HeadRecord) {
    of(MEMBER(schema), "of the record; other numbers are refused", {.least = kResultsSchema, .most = kResultsSchema});
    of(MEMBER(version), "of the program");
    of(MEMBER(command), "as it was typed");
}

struct SceneRecord {
    std::string name{}, title{}, shows{}, source{};
    std::vector<std::string> warnings{};
    std::vector<double> origin{};
};
DESCRIBE(SceneRecord) {
    of.name("scene");
    MEMBERS(name, title);
    of(MEMBER(shows), "what it is for");
    of(MEMBER(source), "the scene file");
    of(MEMBER(warnings), "what is left out or assumed");
    of.may(MEMBER(origin),
           "where (0, 0, 0) of all positions is in the numbers of the scene file; absent: at its origin",
           kThreeNumbers);
}

struct ObjectRecord {
    std::string name{};
    std::uint64_t triangles = 0, vertices = 0, boundary_edges = 0, nonmanifold_edges = 0, misoriented_edges = 0,
                  nonmanifold_vertices = 0, degenerate_triangles = 0, duplicate_triangles = 0, components = 0;
    bool closed = false, outward = false, planar = false;
    double area = kUnknown, volume = kUnknown;
    std::optional<bool> casts_shadows{}, receives_shadows{}, seen_by_camera{};
};
DESCRIBE(ObjectRecord) {
    MEMBERS(name, triangles, vertices, boundary_edges, nonmanifold_edges, misoriented_edges, nonmanifold_vertices,
            degenerate_triangles, duplicate_triangles, components, closed, outward, planar, area, volume);
    of.may(MEMBER(casts_shadows), "false, and only there: the object blocks and filters no light", only(false));
    of.may(MEMBER(receives_shadows), "false, and only there: S_j is 1 at its points that face the light", only(false));
    of.may(MEMBER(seen_by_camera), "false, and only there: eye rays pass through the object", only(false));
}

struct PlaneRecord {
    std::vector<double> normal{};
    double offset = kUnknown, area = kUnknown;
    std::uint64_t triangles = 0;
};
DESCRIBE(PlaneRecord) {
    of(MEMBER(normal), "", kThreeNumbers);
    MEMBERS(offset, area, triangles);
}

struct ExtentRecord {
    std::vector<double> min{}, max{};
};
DESCRIBE(ExtentRecord) {
    of(MEMBER(min), "", kThreeNumbers);
    of(MEMBER(max), "", kThreeNumbers);
}

struct UncomputedRecord {
    std::string term{};
    std::vector<std::string> materials{};
};
DESCRIBE(UncomputedRecord) {
    of(MEMBER(term), "", one_of({"opacity", "transmit", "reflect", "index_of_refraction"}));
    MEMBERS(materials);
}

struct FactsRecord {
    std::uint64_t triangles = 0;
    ExtentRecord extent{};
    std::vector<ObjectRecord> objects{};
    std::vector<PlaneRecord> planes{};
    double planar_area_share      = kUnknown;
    bool eye_inside_closed_object = false;
    std::vector<UncomputedRecord> not_computed{};
    std::vector<std::string> required{}, not_required{};
};
DESCRIBE(FactsRecord) {
    of.name("facts", "what the scene requires of a method");
    MEMBERS(triangles, extent, objects);
    of(MEMBER(planes), "planar receivers");
    of(MEMBER(planar_area_share), "the part of the area that these planes have");
    MEMBERS(eye_inside_closed_object);
    of(MEMBER(not_computed), "what materials ask for and pictures of the sum do not have");
    of("requires", &R::required);
    MEMBERS(not_required);
}

struct LightRecord {
    std::string name{}, kind{}, place{};
};
DESCRIBE(LightRecord) {
    of.must(MEMBER(name));
    of(MEMBER(kind), "directional, point, spot, rectangle, disk or sphere");
    of(MEMBER(place), "at_infinity, outside_view, inside_view or at_eye");
}

struct SizeRecord {
    std::optional<std::uint64_t> width{}, height{};
};
DESCRIBE(SizeRecord) {
    of(MEMBER(width), "pixels", {.least = 1, .most = 1e6});
    of(MEMBER(height), "pixels", {.least = 1, .most = 1e6});
}

struct ServiceRecord {
    std::string how{}, why{};
};
DESCRIBE(ServiceRecord) {
    of.name("service", "how well a method can serve a scene, and why");
    of.must(MEMBER(how), "", one_of({"exactly", "to_rounding", "approximately", "not"}));
    MEMBERS(why);
}

/// Milliseconds.
struct TimingRecord {
    double median = kUnknown, min = kUnknown, max = kUnknown;
    std::uint64_t runs = 0;
    std::vector<double> samples{};
};
DESCRIBE(TimingRecord) {
    of.name("timing", "milliseconds");
    MEMBERS(median, min, max, runs);
    of.may(
        MEMBER(samples),
        "all runs in the order of the rounds; samples of two methods with one index are of one round, unless `order` is "
        "empty");
}

/// The phases of a method, all lights together.
struct TimesRecord {
    std::optional<TimingRecord> build_ms{}, aim_ms{}, look_ms{}, visibility_ms{};
};
DESCRIBE(TimesRecord) {
    MEMBERS(build_ms, aim_ms);
    of(MEMBER(look_ms), "of the surface points, once for all lights");
    MEMBERS(visibility_ms);
}

struct ColdRecord {
    double build_ms = kUnknown, aim_ms = kUnknown, look_ms = kUnknown, visibility_ms = kUnknown;
};
DESCRIBE(ColdRecord) { MEMBERS(build_ms, aim_ms, look_ms, visibility_ms); }

/// Times that were measured in turns with those of other methods.
struct TurnTimesRecord {
    TimesRecord phases{};
    ColdRecord cold{};
    std::vector<std::uint64_t> order{};
};
DESCRIBE(TurnTimesRecord) {
    of.name("turn_times");
    of.all(&R::phases);
    of(MEMBER(cold), "the first run, which is part of no median unless it is the only one");
    of(MEMBER(order), "the position within each round, from 0; empty where the cold run is the only sample");
}

DESCRIBE(VisibilityError::Kind) { MEMBERS(interior, edge); }

struct LoadRecord {
    double before = kUnknown, after = kUnknown;
};
DESCRIBE(LoadRecord) { MEMBERS(before, after); }

struct BudgetRecord {
    double seconds = kUnknown, memory_bytes = kUnknown;
};
DESCRIBE(BudgetRecord) {
    of.name(
        "budget",
        "what each method might take on the scene, and a reference that nobody named; null: as much as it wants. Not "
        "there where nothing was limited");
    MEMBERS(seconds, memory_bytes);
}

/// What a method, or the reference, threw or why it was cut short.
struct FailureRecord {
    std::optional<std::string> light{};
    std::string message{};
    bool cut = false;
};
DESCRIBE(FailureRecord) {
    of(MEMBER(light), "null: before any, or between them");
    MEMBERS(message);
    of.may(MEMBER(cut), "true: it did not throw, it took more time or memory than `budget`", only(true));
}

/// An entry of `failed` of a record of several scenes, ladders or families; it names one of them.
struct ListedFailureRecord {
    std::string ladder{}, scene{}, family{};
    std::optional<double> rung{};
    std::string method{};
    FailureRecord failure{};
};
DESCRIBE(ListedFailureRecord) {
    of.name("failed", "what threw or was cut short, where");
    of.may(MEMBER(ladder));
    of.may(MEMBER(scene));
    of.may(MEMBER(family));
    of.may(MEMBER(rung));
    of(MEMBER(method), "as typed, or the reference");
    of.all(&R::failure);
}

/// A parameter of a method.
struct ParameterRecord {
    std::string name{}, type{};
    Scalar fallback{};
    std::string unit{}, phase{}, doc{};
    std::optional<double> min{}, max{};
    std::string choices{}, sweep{};
};
DESCRIBE(ParameterRecord) {
    MEMBERS(name);
    of(MEMBER(type), "", one_of({"integer", "real", "choice", "boolean", "text"}));
    of("default", &R::fallback);
    MEMBERS(unit);
    of(MEMBER(phase), "the first phase to repeat when it changes");
    MEMBERS(doc);
    of.may(MEMBER(min));
    of.may(MEMBER(max));
    of.may(MEMBER(choices));
    of.may(MEMBER(sweep), "values that are worth comparing");
}

struct PresetRecord {
    std::string name{}, settings{}, doc{};
};
DESCRIBE(PresetRecord) { MEMBERS(name, settings, doc); }

/// A method as the list knows it.
struct MethodInfoRecord {
    std::string name{}, title{}, paper{}, summary{}, measures{};
    bool reference = false, by_default = false, needs_raster = false, noise = false;
    std::vector<ParameterRecord> parameters{};
    std::vector<PresetRecord> presets{};
};
DESCRIBE(MethodInfoRecord) {
    MEMBERS(name, title, paper, summary);
    of(MEMBER(measures), "which visible fraction of an area light");
    of(MEMBER(reference), "others may be compared with it");
    of(MEMBER(by_default), "it runs where no method is named");
    of(MEMBER(needs_raster), "it answers for whole pictures only");
    of(MEMBER(noise), "it has a seed");
    MEMBERS(parameters, presets);
}

[[nodiscard]] MethodInfoRecord method_info_record(const MethodInfo& info);
[[nodiscard]] HeadRecord head_record(std::string command);
[[nodiscard]] MachineRecord machine_record(int threads);
[[nodiscard]] SizeRecord size_record(Size size);
[[nodiscard]] SceneRecord scene_record(const Scene& scene);
[[nodiscard]] FactsRecord facts_record(const SceneFacts& facts);
[[nodiscard]] std::vector<LightRecord> light_records(const SceneFacts& facts);
[[nodiscard]] ServiceRecord service_record(const Service& service);
/// Of samples in any order, milliseconds, which it does not list. Throws std::logic_error where there is none.
[[nodiscard]] TimingRecord timing_record(std::span<const double> samples);
/// Absent where nothing is limited.
[[nodiscard]] std::optional<BudgetRecord> budget_record(const Budget& budget);
/// Every parameter of the method, in its order.
[[nodiscard]] Members<Scalar> parameter_records(const Settings& settings);

}  // namespace umbra
