#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/bench/sweep/recommend/first_answer.h"
#include "umbra/bench/sweep/sweep.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// After which the first answer is given: with what began before, ten seconds on a scene of common size.
constexpr double kFirstSeconds = 7;

struct RecommendLine {
    std::string scene, workload, cells;
    std::vector<std::string> limits, methods;
    CellOptions cell;
    bool as_json = false, fresh = false;
    RecommendOptions options;
};

/// Where cells are kept unless the command says otherwise.
fs::path cache_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
        return fs::path(cache) / "umbra/cells";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return fs::path(home) / ".cache/umbra/cells";
    return fs::temp_directory_path() / "umbra-cells";
}

int recommend(RecommendLine line, const Common& common) {
    RecommendOptions& options = line.options;
    if (line.scene.empty()) throw UsageError("recommend: SCENE is required");
    if (line.limits.empty()) throw UsageError("recommend: --max METRIC=LIMIT is required");
    for (const std::string& limit : line.limits) options.limits.push_back(parse_limit(limit));
    if (!line.workload.empty()) options.workload = parse_workload(line.workload);
    SweepPlan plan;
    plan.settings     = line.methods;
    CellOptions& cell = line.cell;
    cell.brief =
        std::ranges::none_of(options.limits, [](const Limit& limit) { return needs_whole_cell(*limit.metric); });
    const CellStore store(line.cells.empty() ? cache_folder() : fs::path(line.cells) / "cells");
    options.kept_in = store.folder().string();
    std::optional<Terminal> terminal(std::in_place, common.quiet);
    cell.progress = [&](const std::string& what) { terminal->progress(what); };
    SceneLab lab(scene_file(line.scene, common.up), cell, store);
    if (line.fresh) lab.measure_anew();
    pass_warnings(lab.scene(), [&](const std::string& warning) { terminal->warn(warning); });
    options.choices = planned_settings(plan, lab.facts());
    SceneLab small(lab, first_size(lab.size(), options.limits));
    const std::optional<FirstAnswer> first = first_answer(small, lab, options, kFirstSeconds);
    if (first && !line.as_json) {
        terminal.reset();
        print_out("{}", without_controls(first_answer_text(*first, options)));
        flush_out();  // it is read while the search goes on
        terminal.emplace(common.quiet);
    }
    if (first) options.first = first->choice;
    const Recommendation found = recommend(small, lab, options);
    terminal.reset();
    if (line.as_json) {
        RecommendationRecord record = recommendation_record(found, options);
        if (first) record.first = *first;
        print_out("{}", json_text(to_record(record)));
    } else {
        print_out("{}", without_controls(recommendation_text(found, options)));
    }
    return found.chosen ? kDone : kNo;
}

}  // namespace

Action recommend_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<RecommendLine>();
    add_scene(app, line->scene);
    app.add_option("--max", line->limits, "The largest error: METRIC=LIMIT (metrics: umbra list metrics); repeatable")
        ->type_name("METRIC=E")
        ->take_all();
    app.add_option("--workload", line->workload, "Events a second (default: camera=60,light=1,object=0)")
        ->type_name("LIST");
    add_methods(app, line->methods,
                "Candidates: METHOD, METHOD@PRESET, METHOD:k=a|b (default: the methods' own sweeps)");
    app.add_option("--views", line->options.views, "Views to choose on: the scene's own, and jittered ones")
        ->capture_default_str()
        ->check(CLI::Range(2, 1000))
        ->type_name("N");
    app.add_option(
           "--held-out", line->options.held_out,
           "Further views, in all of which the answer is within the limits: what it says of others is from these")
        ->capture_default_str()
        ->check(CLI::Range(0, 1000))
        ->type_name("N");
    app.add_option("--seconds", line->options.seconds,
                   "After which the search begins with no further setting, those of earlier questions to the folder "
                   "included; views, turns and what has begun come on top")
        ->capture_default_str()
        ->check(number_in(0, 1e9, "a number from 0 to 1000000000"))
        ->type_name("S");
    add_size(app, line->cell.size);
    add_reference(app, line->cell.reference, line->cell.points);
    add_budget(app, line->cell.budget);
    app.add_option("-o,--output", line->cells,
                   "Folder of a sweep whose cells are used and added to (default: $XDG_CACHE_HOME/umbra/cells or "
                   "~/.cache/umbra/cells)")
        ->type_name("DIR");
    app.add_flag("--fresh", line->fresh, "Measure times anew that were kept; errors do not change");
    app.add_flag("--json", line->as_json, "Print the answer as JSON");
    return [line, &common] { return recommend(*line, common); };
}

}  // namespace umbra
