// Facts, methods, machine and times as records: the parts that results.json of all commands, `inspect --json` and
// `list --json` share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/record/record.h"
#include "umbra/bench/run/run.h"
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
template <class Fields>
void describe(Fields& of, Is<MachineRecord>) {
    of.name("machine", "");
    of("cpu", &MachineRecord::cpu, "");
    of("cores", &MachineRecord::cores, "");
    of("threads", &MachineRecord::threads, "that the run used");
    of("memory_bytes", &MachineRecord::memory_bytes, "");
    of("system", &MachineRecord::system, "");
    of("compiler", &MachineRecord::compiler, "");
}

/// How each record begins.
struct HeadRecord {
    int schema = kResultsSchema;
    std::string version{}, command{};
};
template <class Fields>
void describe(Fields& of, Is<HeadRecord>) {
    of("schema", &HeadRecord::schema, "of the record; other numbers are refused",
       {.least = kResultsSchema, .most = kResultsSchema});
    of("version", &HeadRecord::version, "of the program");
    of("command", &HeadRecord::command, "as it was typed");
}

struct SceneRecord {
    std::string name{}, title{}, shows{}, source{};
    std::vector<std::string> warnings{};
    std::vector<double> origin{};
};
template <class Fields>
void describe(Fields& of, Is<SceneRecord>) {
    of.name("scene", "");
    of("name", &SceneRecord::name, "");
    of("title", &SceneRecord::title, "");
    of("shows", &SceneRecord::shows, "what it is for");
    of("source", &SceneRecord::source, "the scene file");
    of("warnings", &SceneRecord::warnings, "what is left out or assumed");
    of.may("origin", &SceneRecord::origin,
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
template <class Fields>
void describe(Fields& of, Is<ObjectRecord>) {
    of("name", &ObjectRecord::name, "");
    of("triangles", &ObjectRecord::triangles, "");
    of("vertices", &ObjectRecord::vertices, "");
    of("boundary_edges", &ObjectRecord::boundary_edges, "");
    of("nonmanifold_edges", &ObjectRecord::nonmanifold_edges, "");
    of("misoriented_edges", &ObjectRecord::misoriented_edges, "");
    of("nonmanifold_vertices", &ObjectRecord::nonmanifold_vertices, "");
    of("degenerate_triangles", &ObjectRecord::degenerate_triangles, "");
    of("duplicate_triangles", &ObjectRecord::duplicate_triangles, "");
    of("components", &ObjectRecord::components, "");
    of("closed", &ObjectRecord::closed, "");
    of("outward", &ObjectRecord::outward, "");
    of("planar", &ObjectRecord::planar, "");
    of("area", &ObjectRecord::area, "");
    of("volume", &ObjectRecord::volume, "");
    of.may("casts_shadows", &ObjectRecord::casts_shadows,
           "false, and only there: the object blocks and filters no light", only(false));
    of.may("receives_shadows", &ObjectRecord::receives_shadows,
           "false, and only there: S_j is 1 at its points that face the light", only(false));
    of.may("seen_by_camera", &ObjectRecord::seen_by_camera, "false, and only there: eye rays pass through the object",
           only(false));
}

struct PlaneRecord {
    std::vector<double> normal{};
    double offset = kUnknown, area = kUnknown;
    std::uint64_t triangles = 0;
};
template <class Fields>
void describe(Fields& of, Is<PlaneRecord>) {
    of("normal", &PlaneRecord::normal, "", kThreeNumbers);
    of("offset", &PlaneRecord::offset, "");
    of("area", &PlaneRecord::area, "");
    of("triangles", &PlaneRecord::triangles, "");
}

struct ExtentRecord {
    std::vector<double> min{}, max{};
};
template <class Fields>
void describe(Fields& of, Is<ExtentRecord>) {
    of("min", &ExtentRecord::min, "", kThreeNumbers);
    of("max", &ExtentRecord::max, "", kThreeNumbers);
}

struct UncomputedRecord {
    std::string term{};
    std::vector<std::string> materials{};
};
template <class Fields>
void describe(Fields& of, Is<UncomputedRecord>) {
    of("term", &UncomputedRecord::term, "", one_of({"opacity", "transmit", "reflect", "index_of_refraction"}));
    of("materials", &UncomputedRecord::materials, "");
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
template <class Fields>
void describe(Fields& of, Is<FactsRecord>) {
    of.name("facts", "what the scene requires of a method");
    of("triangles", &FactsRecord::triangles, "");
    of("extent", &FactsRecord::extent, "");
    of("objects", &FactsRecord::objects, "");
    of("planes", &FactsRecord::planes, "planar receivers");
    of("planar_area_share", &FactsRecord::planar_area_share, "the part of the area that these planes have");
    of("eye_inside_closed_object", &FactsRecord::eye_inside_closed_object, "");
    of("not_computed", &FactsRecord::not_computed, "what materials ask for and pictures of the sum do not have");
    of("requires", &FactsRecord::required, "");
    of("not_required", &FactsRecord::not_required, "");
}

struct LightRecord {
    std::string name{}, kind{}, place{};
};
template <class Fields>
void describe(Fields& of, Is<LightRecord>) {
    of.must("name", &LightRecord::name, "");
    of("kind", &LightRecord::kind, "directional, point, spot, rectangle, disk or sphere");
    of("place", &LightRecord::place, "at_infinity, outside_view, inside_view or at_eye");
}

struct SizeRecord {
    std::optional<std::uint64_t> width{}, height{};
};
template <class Fields>
void describe(Fields& of, Is<SizeRecord>) {
    of("width", &SizeRecord::width, "pixels", {.least = 1, .most = 1e6});
    of("height", &SizeRecord::height, "pixels", {.least = 1, .most = 1e6});
}

struct ServiceRecord {
    std::string how{}, why{};
};
template <class Fields>
void describe(Fields& of, Is<ServiceRecord>) {
    of.name("service", "how well a method can serve a scene, and why");
    of.must("how", &ServiceRecord::how, "", one_of({"exactly", "to_rounding", "approximately", "not"}));
    of("why", &ServiceRecord::why, "");
}

/// Milliseconds.
struct TimingRecord {
    double median = kUnknown, min = kUnknown, max = kUnknown;
    std::uint64_t runs = 0;
    std::vector<double> samples{};
};
template <class Fields>
void describe(Fields& of, Is<TimingRecord>) {
    of.name("timing", "milliseconds");
    of("median", &TimingRecord::median, "");
    of("min", &TimingRecord::min, "");
    of("max", &TimingRecord::max, "");
    of("runs", &TimingRecord::runs, "");
    of.may(
        "samples", &TimingRecord::samples,
        "all runs in the order of the rounds; samples of two methods with one index are of one round, unless `order` is "
        "empty");
}

/// The phases of a method, all lights together.
struct TimesRecord {
    std::optional<TimingRecord> build_ms{}, aim_ms{}, look_ms{}, visibility_ms{};
};
template <class Fields>
void describe(Fields& of, Is<TimesRecord>) {
    of("build_ms", &TimesRecord::build_ms, "");
    of("aim_ms", &TimesRecord::aim_ms, "");
    of("look_ms", &TimesRecord::look_ms, "of the surface points, once for all lights");
    of("visibility_ms", &TimesRecord::visibility_ms, "");
}

struct ColdRecord {
    double build_ms = kUnknown, aim_ms = kUnknown, look_ms = kUnknown, visibility_ms = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<ColdRecord>) {
    of("build_ms", &ColdRecord::build_ms, "");
    of("aim_ms", &ColdRecord::aim_ms, "");
    of("look_ms", &ColdRecord::look_ms, "");
    of("visibility_ms", &ColdRecord::visibility_ms, "");
}

/// Times that were measured in turns with those of other methods.
struct TurnTimesRecord {
    TimesRecord phases{};
    ColdRecord cold{};
    std::vector<std::uint64_t> order{};
};
template <class Fields>
void describe(Fields& of, Is<TurnTimesRecord>) {
    of.name("turn_times", "");
    of.all(&TurnTimesRecord::phases);
    of("cold", &TurnTimesRecord::cold, "the first run, which is part of no median unless it is the only one");
    of("order", &TurnTimesRecord::order,
       "the position within each round, from 0; empty where the cold run is the only sample");
}

template <class Fields>
void describe(Fields& of, Is<VisibilityError::Kind>) {
    of("interior", &VisibilityError::Kind::interior, "");
    of("edge", &VisibilityError::Kind::edge, "");
}

struct LoadRecord {
    double before = kUnknown, after = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<LoadRecord>) {
    of("before", &LoadRecord::before, "");
    of("after", &LoadRecord::after, "");
}

struct BudgetRecord {
    double seconds = kUnknown, memory_bytes = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<BudgetRecord>) {
    of.name(
        "budget",
        "what each method might take on the scene, and a reference that nobody named; null: as much as it wants. Not "
        "there where nothing was limited");
    of("seconds", &BudgetRecord::seconds, "");
    of("memory_bytes", &BudgetRecord::memory_bytes, "");
}

/// What a method, or the reference, threw or why it was cut short.
struct FailureRecord {
    std::optional<std::string> light{};
    std::string message{};
    bool cut = false;
};
template <class Fields>
void describe(Fields& of, Is<FailureRecord>) {
    of("light", &FailureRecord::light, "null: before any, or between them");
    of("message", &FailureRecord::message, "");
    of.may("cut", &FailureRecord::cut, "true: it did not throw, it took more time or memory than `budget`", only(true));
}

/// An entry of `failed` of a record of several scenes, ladders or families; it names one of them.
struct ListedFailureRecord {
    std::string ladder{}, scene{}, family{};
    std::optional<double> rung{};
    std::string method{};
    FailureRecord failure{};
};
template <class Fields>
void describe(Fields& of, Is<ListedFailureRecord>) {
    of.name("failed", "what threw or was cut short, where");
    of.may("ladder", &ListedFailureRecord::ladder, "");
    of.may("scene", &ListedFailureRecord::scene, "");
    of.may("family", &ListedFailureRecord::family, "");
    of.may("rung", &ListedFailureRecord::rung, "");
    of("method", &ListedFailureRecord::method, "as typed, or the reference");
    of.all(&ListedFailureRecord::failure);
}

/// A parameter of a method.
struct ParameterRecord {
    std::string name{}, type{};
    Scalar fallback{};
    std::string unit{}, phase{}, doc{};
    std::optional<double> min{}, max{};
    std::string choices{}, sweep{};
};
template <class Fields>
void describe(Fields& of, Is<ParameterRecord>) {
    of("name", &ParameterRecord::name, "");
    of("type", &ParameterRecord::type, "", one_of({"integer", "real", "choice", "boolean", "text"}));
    of("default", &ParameterRecord::fallback, "");
    of("unit", &ParameterRecord::unit, "");
    of("phase", &ParameterRecord::phase, "the first phase to repeat when it changes");
    of("doc", &ParameterRecord::doc, "");
    of.may("min", &ParameterRecord::min, "");
    of.may("max", &ParameterRecord::max, "");
    of.may("choices", &ParameterRecord::choices, "");
    of.may("sweep", &ParameterRecord::sweep, "values that are worth comparing");
}

struct PresetRecord {
    std::string name{}, settings{}, doc{};
};
template <class Fields>
void describe(Fields& of, Is<PresetRecord>) {
    of("name", &PresetRecord::name, "");
    of("settings", &PresetRecord::settings, "");
    of("doc", &PresetRecord::doc, "");
}

/// A method as the list knows it.
struct MethodInfoRecord {
    std::string name{}, title{}, paper{}, summary{}, measures{};
    bool reference = false, by_default = false, needs_raster = false, noise = false;
    std::vector<ParameterRecord> parameters{};
    std::vector<PresetRecord> presets{};
};
template <class Fields>
void describe(Fields& of, Is<MethodInfoRecord>) {
    of("name", &MethodInfoRecord::name, "");
    of("title", &MethodInfoRecord::title, "");
    of("paper", &MethodInfoRecord::paper, "");
    of("summary", &MethodInfoRecord::summary, "");
    of("measures", &MethodInfoRecord::measures, "which visible fraction of an area light");
    of("reference", &MethodInfoRecord::reference, "others may be compared with it");
    of("by_default", &MethodInfoRecord::by_default, "it runs where no method is named");
    of("needs_raster", &MethodInfoRecord::needs_raster, "it answers for whole pictures only");
    of("noise", &MethodInfoRecord::noise, "it has a seed");
    of("parameters", &MethodInfoRecord::parameters, "");
    of("presets", &MethodInfoRecord::presets, "");
}

[[nodiscard]] MethodInfoRecord method_info_record(const MethodInfo& info);
[[nodiscard]] HeadRecord head_record(std::string command);
[[nodiscard]] MachineRecord machine_record(int threads);
[[nodiscard]] SceneRecord scene_record(const Scene& scene);
[[nodiscard]] FactsRecord facts_record(const SceneFacts& facts);
[[nodiscard]] std::vector<LightRecord> light_records(const SceneFacts& facts);
[[nodiscard]] ServiceRecord service_record(const Service& service);
[[nodiscard]] TimingRecord timing_record(const Timing& timing);
/// Absent where nothing is limited.
[[nodiscard]] std::optional<BudgetRecord> budget_record(const Budget& budget);
[[nodiscard]] Scalar setting_scalar(const Parameter& p, double value);  ///< typed: a number, a boolean or a word
/// Every parameter of the method, in its order.
[[nodiscard]] Members<Scalar> parameter_records(const Settings& settings);

}  // namespace umbra
