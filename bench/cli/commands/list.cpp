#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

struct ListLine {
    std::string name;
    bool as_json = false;
};

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

void print_method(const Json& m) {
    print_out("{} - {} ({})\n  {}\n", text(m["name"]), text(m["title"]), text(m["paper"]), text(m["summary"]));
    for (const Json& p : m["parameters"]) {
        const std::string range = p.contains("choices") ? text(p["choices"])
                                  : p.contains("min")
                                      ? fmt::format("{} to {}", p["min"].get<double>(), p["max"].get<double>())
                                      : "true or false";
        const std::string unit  = text(p["unit"]);
        print_out("    {}={}  ({}{}{})  {}\n", text(p["name"]), text(p["default"]), range, unit.empty() ? "" : " ",
                  unit, text(p["doc"]));
    }
    for (const Json& p : m["presets"])
        print_out("    @{}  ({})  {}\n", text(p["name"]), text(p["settings"]), text(p["doc"]));
}

void print_ladder(const Json& l) {
    const std::string unit = text(l["unit"]);
    print_out("{} - {}\n  {}\n  {} rungs: {}{}\n", text(l["name"]), text(l["title"]), text(l["about"]),
              l["rungs"].size(), fmt::join(l["rungs"].get<std::vector<double>>(), ", "),
              unit.empty() ? "" : " " + unit);
}

void print_scene(const Json& s) {
    print_out("{} - {}\n  {}\n  {}\n", text(s["name"]), text(s["title"]), text(s["shows"]), text(s["source"]));
}

std::vector<std::string> metric_names() {
    std::vector<std::string> names;
    for (const Metric& m : metrics()) names.emplace_back(m.name);
    return names;
}

void print_metrics(const Json& all) {
    for (const Json& m : all)
        print_out("{:<28}{}{}\n", text(m["name"]), text(m["doc"]),
                  text(m["unit"]).empty() ? "" : fmt::format(" ({})", text(m["unit"])));
}

int list_all(bool as_json) {
    Json record = {{"schema", kResultsSchema}, {"version", version()},      {"methods", Json::array()},
                   {"scenes", Json::array()},  {"metrics", metrics_json()}, {"ladders", Json::array()}};
    for (const MethodInfo* info : methods()) record["methods"].push_back(method_json(*info));
    for (const std::string& scene : canonical_names()) record["scenes"].push_back(scene);
    for (const Ladder* ladder : ladders()) record["ladders"].push_back(ladder_info_json(*ladder));
    if (as_json) {
        print_out("{}", json_text(record));
        return kDone;
    }
    for (const Json& m : record["methods"]) print_method(m);
    print_out("\nScenes: {}\nMetrics: {}\nLadders: {}\n", fmt::join(canonical_names(), " "),
              fmt::join(metric_names(), " "), fmt::join(ladder_names(), " "));
    return kDone;
}

/// One entry in full. Throws UsageError where nothing has that name.
int list_one(const std::string& name, bool as_json) {
    const auto is_it = [&](const auto* entry) { return entry->name == name; };
    const auto show  = [&](const char* kind, const Json& entry, void (*print)(const Json&)) {
        if (as_json)
            print_out("{}", json_text({{kind, entry}}));
        else
            print(entry);
        return kDone;
    };
    if (name == "metrics") return show("metrics", metrics_json(), print_metrics);
    if (const auto m = std::find_if(methods().begin(), methods().end(), is_it); m != methods().end())
        return show("method", method_json(**m), print_method);
    if (const auto l = std::find_if(ladders().begin(), ladders().end(), is_it); l != ladders().end())
        return show("ladder", ladder_info_json(**l), print_ladder);
    std::vector<std::string> known = canonical_names();
    if (std::find(known.begin(), known.end(), name) != known.end())
        return show("scene", scene_json(load_scene(scene_file(name))), print_scene);

    for (const auto& names : {method_names(), ladder_names()}) known.insert(known.end(), names.begin(), names.end());
    throw UsageError(
        fmt::format("\"{}\" is not a method, ladder or canonical scene{}", name, did_you_mean(name, known)));
}

int list(const ListLine& line) {
    return line.name.empty() ? list_all(line.as_json) : list_one(line.name, line.as_json);
}

}  // namespace

Action list_command(CLI::App& app, const Common& /*common*/) {
    const auto line = std::make_shared<ListLine>();
    app.add_option("NAME", line->name, "A method, ladder or canonical scene to show in full, or metrics")
        ->type_name("");
    app.add_flag("--json", line->as_json, "Print JSON");
    return [line] { return list(*line); };
}

}  // namespace umbra
