#include "umbra/bench/run/describe.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/sysinfo.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <thread>

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

Json vector_json(dvec3 v) { return {number(v.x), number(v.y), number(v.z)}; }

}  // namespace

std::string_view version() { return UMBRA_VERSION; }

std::string json_text(const Json& record) { return record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

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

Json budget_json(const Budget& budget) {
    return {{"seconds", number(budget.seconds)}, {"memory_bytes", number(budget.bytes)}};
}

Json machine_json(int threads) {
    struct sysinfo info {};
    sysinfo(&info);
    return {{"cpu", value_of("/proc/cpuinfo", "model name", ':')},
            {"cores", std::thread::hardware_concurrency()},
            {"threads", threads},
            {"memory_bytes", static_cast<std::uint64_t>(info.totalram) * info.mem_unit},
            {"system", value_of("/etc/os-release", "PRETTY_NAME", '=')},
            {"compiler", UMBRA_COMPILER}};
}

Json scene_json(const Scene& scene) {
    Json record = {{"name", scene.name},
                   {"title", scene.title},
                   {"shows", scene.shows},
                   {"source", scene.source},
                   {"warnings", scene.warnings}};
    if (scene.origin != dvec3(0)) record["origin"] = vector_json(scene.origin);
    return record;
}

Json facts_json(const SceneFacts& facts) {
    Json objects = Json::array();
    for (const ObjectFacts& o : facts.objects) {
        objects.push_back({{"name", o.name},
                           {"triangles", o.triangles},
                           {"vertices", o.vertices},
                           {"boundary_edges", o.boundary_edges},
                           {"nonmanifold_edges", o.nonmanifold_edges},
                           {"misoriented_edges", o.misoriented_edges},
                           {"nonmanifold_vertices", o.nonmanifold_vertices},
                           {"degenerate_triangles", o.degenerate_triangles},
                           {"duplicate_triangles", o.duplicate_triangles},
                           {"components", o.components},
                           {"closed", o.closed},
                           {"outward", o.outward},
                           {"planar", o.planar},
                           {"area", number(o.area)},
                           {"volume", number(o.volume)}});
        for (const ObjectSwitch& each : kObjectSwitches)
            if (!(o.switches.*each.is_on)) objects.back()[std::string(each.key)] = false;
    }
    Json planes = Json::array();
    for (const PlanarReceiver& p : facts.planes)
        planes.push_back({{"normal", vector_json(p.normal)},
                          {"offset", number(p.offset)},
                          {"area", number(p.area)},
                          {"triangles", p.triangles.size()}});
    Json uncomputed = Json::array();
    for (const UncomputedTerm& t : facts.uncomputed)
        uncomputed.push_back({{"term", t.term}, {"materials", t.materials}});
    return {{"triangles", facts.triangles},
            {"extent", {{"min", vector_json(dvec3(facts.box.min))}, {"max", vector_json(dvec3(facts.box.max))}}},
            {"objects", objects},
            {"planes", planes},
            {"planar_area_share", number(facts.planar_area_share)},
            {"eye_inside_closed_object", facts.eye_inside_closed_object},
            {"not_computed", uncomputed},
            {"requires", requires_list(facts)},
            {"not_required", not_required_list(facts)}};
}

Json lights_json(const SceneFacts& facts) {
    Json lights = Json::array();
    for (const LightFacts& l : facts.lights)
        lights.push_back({{"name", l.name}, {"kind", to_string(l.kind)}, {"place", place_word(l.place)}});
    return lights;
}

Json setting_json(const Parameter& p, double value) {
    switch (p.type) {
        case Parameter::Type::integer: return static_cast<std::int64_t>(value);
        case Parameter::Type::real: return value;
        case Parameter::Type::boolean: return value != 0;
        case Parameter::Type::choice: return p.text(value);
        case Parameter::Type::text: return p.fallback_text;
    }
    return {};
}

Json method_json(const MethodInfo& info) {
    Json parameters = Json::array(), presets = Json::array();
    for (const Parameter& p : info.parameters) {
        Json entry = {{"name", p.name}, {"type", to_string(p.type)},   {"default", setting_json(p, p.fallback)},
                      {"unit", p.unit}, {"phase", to_string(p.phase)}, {"doc", p.doc}};
        if (p.type == Parameter::Type::integer || p.type == Parameter::Type::real) {
            entry["min"] = p.min;
            entry["max"] = p.max;
        }
        if (p.type == Parameter::Type::choice) entry["choices"] = p.choices;
        if (!p.sweep.empty()) entry["sweep"] = p.sweep;
        parameters.push_back(std::move(entry));
    }
    for (const Preset& p : info.presets)
        presets.push_back({{"name", p.name}, {"settings", p.settings}, {"doc", p.doc}});
    return {{"name", info.name},
            {"title", info.title},
            {"paper", info.paper},
            {"summary", info.summary},
            {"measures", to_string(info.make()->measures())},
            {"reference", info.reference},
            {"by_default", info.by_default},
            {"needs_raster", info.needs_raster},
            {"noise", !info.seed.empty()},
            {"parameters", parameters},
            {"presets", presets}};
}

Json service_json(const Service& service) { return {{"how", to_string(service.how)}, {"why", service.why}}; }

Json timing_json(const Timing& t) {
    return {{"median", number(t.median)}, {"min", number(t.min)}, {"max", number(t.max)}, {"runs", t.runs}};
}

}  // namespace umbra
