#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/streams.h"
#include "umbra/bench/contenders/truth_set.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/report/course/grade.h"
#include "umbra/bench/studies/bias/bias_study.h"
#include "umbra/bench/studies/brdf/brdf_table.h"
#include "umbra/bench/studies/motion/growth_record.h"
#include "umbra/bench/studies/motion/motion_record.h"
#include "umbra/bench/studies/radiosity/light_exchange.h"
#include "umbra/bench/studies/shading/shading_choice.h"
#include "umbra/bench/studies/whitted/whitted_record.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/bench/sweep/recommend/recommendation_record.h"
#include "umbra/bench/sweep/sweep_results.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

struct ListLine {
    std::string name, schema;
    bool as_json = false;
};

struct ListRecord {
    int schema = kResultsSchema;
    std::string version{};
    std::vector<MethodInfoRecord> methods{};
    std::vector<std::string> scenes{};
    std::vector<MetricRecord> metrics{};
    std::vector<LadderInfoRecord> ladders{};
};
DESCRIBE(ListRecord) { MEMBERS(schema, version, methods, scenes, metrics, ladders); }

void print(const MethodInfoRecord& m) {
    print_out("{} - {} ({})\n  {}\n", m.name, m.title, m.paper, m.summary);
    for (const ParameterRecord& p : m.parameters) {
        const std::string range = !p.choices.empty() ? p.choices
                                  : p.min            ? fmt::format("{} to {}", *p.min, *p.max)
                                                     : "true or false";
        print_out("    {}={}  ({}{}{})  {}\n", p.name, text_of(p.fallback), range, p.unit.empty() ? "" : " ", p.unit,
                  p.doc);
    }
    for (const PresetRecord& p : m.presets) print_out("    @{}  ({})  {}\n", p.name, p.settings, p.doc);
}

void print(const LadderInfoRecord& l) {
    print_out("{} - {}\n  {}\n  {} rungs: {}{}\n", l.name, l.title, l.about, l.rungs.size(), fmt::join(l.rungs, ", "),
              l.unit.empty() ? "" : " " + l.unit);
}

void print(const SceneRecord& s) { print_out("{} - {}\n  {}\n  {}\n", s.name, s.title, s.shows, s.source); }

void print(const std::vector<MetricRecord>& all) {
    for (const MetricRecord& m : all)
        print_out("{:<28}{}{}\n", m.name, m.doc, m.unit.empty() ? "" : fmt::format(" ({})", m.unit));
}

int list_all(bool as_json) {
    ListRecord record{.version = std::string(version()), .scenes = canonical_names(), .metrics = metric_records()};
    for (const MethodInfo* info : methods()) record.methods.push_back(method_info_record(*info));
    for (const Ladder* ladder : ladders()) record.ladders.push_back(ladder_info(*ladder));
    if (as_json) {
        print_out("{}", json_text(to_record(record)));
        return kDone;
    }
    for (const MethodInfoRecord& m : record.methods) print(m);
    print_out("\nScenes: {}\nMetrics: {}\nLadders: {}\n", fmt::join(record.scenes, " "),
              fmt::join(names_of_entries(record.metrics), " "), fmt::join(names_of_entries(ladders()), " "));
    return kDone;
}

/// One entry in full. Throws UsageError where nothing has that name.
int list_one(const std::string& name, bool as_json) {
    const auto show = [&](const char* kind, const auto& entry) {
        if (as_json)
            print_out("{}", json_text({{kind, to_record(entry)}}));
        else
            print(entry);
        return kDone;
    };
    if (name == "metrics") return show("metrics", metric_records());
    if (const auto m = std::ranges::find(methods(), name, &MethodInfo::name); m != methods().end())
        return show("method", method_info_record(**m));
    if (const auto l = std::ranges::find(ladders(), name, &Ladder::name); l != ladders().end())
        return show("ladder", ladder_info(**l));
    std::vector<std::string> known = canonical_names();
    if (std::find(known.begin(), known.end(), name) != known.end())
        return show("scene", scene_record(load_scene(scene_file(name))));

    for (const auto& names : {names_of_entries(methods()), names_of_entries(ladders())})
        known.insert(known.end(), names.begin(), names.end());
    throw UsageError(
        fmt::format("\"{}\" is not a method, ladder or canonical scene{}", name, did_you_mean(name, known)));
}

const std::map<std::string, Json (*)()> kSchemas = {
    {"results", results_schema},
    {"ladders", [] { return schema_of<LaddersRecord>("results.json of umbra ladder: where methods break"); }},
    {"motion", [] { return schema_of<MotionRecord>("results.json of umbra motion"); }},
    {"growth", [] { return schema_of<GrowthRecord>("results.json of umbra growth"); }},
    {"sweep",
     [] {
         return schema_of<SweepResults>("results.json of umbra sweep: many settings of shadow methods on one scene");
     }},
    {"recommend",
     [] {
         return schema_of<RecommendationRecord>(
             "umbra recommend --json: the cheapest setting within limits, and its evidence");
     }},
    {"bias", [] { return schema_of<BiasRecord>("results.json of umbra bias"); }},
    {"brdf", [] { return schema_of<BrdfRecord>("brdf --json: reflectances of a scene's materials"); }},
    {"grade", [] { return schema_of<GradeRecord>("results.json of umbra grade and handin, one a submission"); }},
    {"radiosity", [] { return schema_of<ExchangeRecord>("results.json of umbra radiosity"); }},
    {"shading", [] { return schema_of<ShadingRecord>("results.json of umbra shading"); }},
    {"truth", [] { return schema_of<TruthSetRecord>("results.json of umbra truth"); }},
    {"whitted", [] { return schema_of<WhittedRecord>("results.json of umbra whitted"); }}};

int list(const ListLine& line) {
    if (!line.schema.empty()) {
        print_out("{}", json_text(kSchemas.at(line.schema)()));
        return kDone;
    }
    return line.name.empty() ? list_all(line.as_json) : list_one(line.name, line.as_json);
}

}  // namespace

Action list_command(CLI::App& app, const Common& /*common*/) {
    const auto line = std::make_shared<ListLine>();
    app.add_option("NAME", line->name, "A method, ladder or canonical scene to show in full, or metrics")
        ->type_name("");
    app.add_flag("--json", line->as_json, "Print JSON");
    app.add_option(
           "--schema", line->schema,
           "Print the JSON Schema of results.json as compare (results), ladder (ladders) or the command of that "
           "name writes it, or of its --json")
        ->check(CLI::IsMember(kSchemas))
        ->type_name("RECORD");
    return [line] { return list(*line); };
}

}  // namespace umbra
