#include "umbra/bench/lab/describe.h"

#include <sched.h>
#include <sys/sysinfo.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <thread>

#include "umbra/bench/base/statistics.h"

namespace umbra {
namespace {

/// The value behind `key` in a file of "key<separator>value" lines; empty where it is not there.
std::string value_of(const char* file, std::string_view key, char separator) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        const std::size_t at = line.find(separator);
        if (at == std::string::npos) continue;
        std::string value = line.substr(at + 1);
        while (!value.empty() && (value.front() == ' ' || value.front() == '"')) value.erase(value.begin());
        while (!value.empty() && value.back() == '"') value.pop_back();
        return value;
    }
    return {};
}

/// One word for each LightPlace, for scripts.
std::string_view place_word(LightPlace place) {
    switch (place) {
        case LightPlace::at_infinity: return "at_infinity";
        case LightPlace::outside_view: return "outside_view";
        case LightPlace::inside_view: return "inside_view";
        case LightPlace::at_eye: return "at_eye";
    }
    return "";
}

std::vector<double> vector_record(dvec3 v) { return {v.x, v.y, v.z}; }

/// Typed: a number, a boolean or a word.
Scalar setting_scalar(const Parameter& p, double value) {
    switch (p.type) {
        case Parameter::Type::integer: return static_cast<std::int64_t>(value);
        case Parameter::Type::real: return value;
        case Parameter::Type::boolean: return value != 0;
        case Parameter::Type::choice: return std::string(p.text(value));
        case Parameter::Type::text: return std::string(p.fallback_text);
    }
    return {};
}

}  // namespace

std::string_view version() { return UMBRA_VERSION; }

double load_average() {
    double minute = 0;
    return getloadavg(&minute, 1) == 1 ? minute : std::numeric_limits<double>::quiet_NaN();
}

int usable_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                       : static_cast<int>(std::thread::hardware_concurrency());
}

HeadRecord head_record(std::string command) { return {kResultsSchema, std::string(version()), std::move(command)}; }

std::optional<BudgetRecord> budget_record(const Budget& budget) {
    if (!budget.is_set()) return {};
    return BudgetRecord{budget.seconds, budget.bytes};
}

MachineRecord machine_record(int threads) {
    struct sysinfo info {};
    sysinfo(&info);
    return {value_of("/proc/cpuinfo", "model name", ':'),
            std::thread::hardware_concurrency(),
            static_cast<std::uint64_t>(threads),
            static_cast<std::uint64_t>(info.totalram) * info.mem_unit,
            value_of("/etc/os-release", "PRETTY_NAME", '='),
            UMBRA_COMPILER};
}

SizeRecord size_record(Size size) {
    return {.width = static_cast<std::uint64_t>(size.width), .height = static_cast<std::uint64_t>(size.height)};
}

SceneRecord scene_record(const Scene& scene) {
    return {scene.name,     scene.title,
            scene.shows,    scene.source,
            scene.warnings, scene.origin == dvec3(0) ? std::vector<double>() : vector_record(scene.origin)};
}

FactsRecord facts_record(const SceneFacts& facts) {
    FactsRecord record{.triangles         = facts.triangles,
                       .extent            = {vector_record(dvec3(facts.box.min)), vector_record(dvec3(facts.box.max))},
                       .planar_area_share = facts.planar_area_share,
                       .eye_inside_closed_object = facts.eye_inside_closed_object,
                       .required                 = requires_list(facts),
                       .not_required             = not_required_list(facts)};
    for (const ObjectFacts& o : facts.objects) {
        ObjectRecord object{.name                 = o.name,
                            .triangles            = o.triangles,
                            .vertices             = o.vertices,
                            .boundary_edges       = o.boundary_edges,
                            .nonmanifold_edges    = o.nonmanifold_edges,
                            .misoriented_edges    = o.misoriented_edges,
                            .nonmanifold_vertices = o.nonmanifold_vertices,
                            .degenerate_triangles = o.degenerate_triangles,
                            .duplicate_triangles  = o.duplicate_triangles,
                            .components           = o.components,
                            .closed               = o.closed,
                            .outward              = o.outward,
                            .planar               = o.planar,
                            .area                 = o.area,
                            .volume               = o.volume};
        if (!o.switches.casts_shadows) object.casts_shadows = false;
        if (!o.switches.receives_shadows) object.receives_shadows = false;
        if (!o.switches.seen_by_camera) object.seen_by_camera = false;
        record.objects.push_back(std::move(object));
    }
    for (const PlanarReceiver& p : facts.planes)
        record.planes.push_back({vector_record(p.normal), p.offset, p.area, p.triangles.size()});
    for (const UncomputedTerm& t : facts.uncomputed) record.not_computed.push_back({std::string(t.term), t.materials});
    return record;
}

std::vector<LightRecord> light_records(const SceneFacts& facts) {
    std::vector<LightRecord> lights;
    for (const LightFacts& l : facts.lights)
        lights.push_back({l.name, std::string(to_string(l.kind)), std::string(place_word(l.place))});
    return lights;
}

MethodInfoRecord method_info_record(const MethodInfo& info) {
    MethodInfoRecord record{.name         = std::string(info.name),
                            .title        = std::string(info.title),
                            .paper        = std::string(info.paper),
                            .summary      = std::string(info.summary),
                            .measures     = std::string(to_string(info.make()->measures())),
                            .reference    = info.reference,
                            .by_default   = info.by_default,
                            .needs_raster = info.needs_raster,
                            .noise        = !info.seed.empty()};
    for (const Parameter& p : info.parameters) {
        ParameterRecord entry{.name     = std::string(p.name),
                              .type     = std::string(to_string(p.type)),
                              .fallback = setting_scalar(p, p.fallback),
                              .unit     = std::string(p.unit),
                              .phase    = std::string(to_string(p.phase)),
                              .doc      = std::string(p.doc)};
        if (p.type == Parameter::Type::integer || p.type == Parameter::Type::real) entry.min = p.min, entry.max = p.max;
        if (p.type == Parameter::Type::choice) entry.choices = p.choices;
        entry.sweep = p.sweep;
        record.parameters.push_back(std::move(entry));
    }
    for (const Preset& p : info.presets)
        record.presets.push_back({std::string(p.name), std::string(p.settings), std::string(p.doc)});
    return record;
}

Members<Scalar> parameter_records(const Settings& settings) {
    Members<Scalar> values;
    for (const Parameter& p : settings.parameters())
        values.emplace_back(p.name, p.type == Parameter::Type::text ? Scalar(std::string(settings.text(p)))
                                                                    : setting_scalar(p, settings.value(p.name)));
    return values;
}

ServiceRecord service_record(const Service& service) { return {std::string(to_string(service.how)), service.why}; }

TimingRecord timing_record(std::span<const double> samples) {
    const double middle         = median(samples);
    const auto [least, largest] = std::ranges::minmax(samples);
    return {middle, least, largest, samples.size(), {}};
}

}  // namespace umbra
