#include "umbra/bench/sweep/sweep.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/bench/base/field.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/base/shell.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/steps.h"
#include "umbra/bench/sweep/cell_store.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/bench/sweep/scene_lab.h"
#include "umbra/bench/sweep/sweep_record.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

CellOptions cell_options(const SweepPlan& plan) { return {plan.size, plan.reference, plan.points, plan.budget}; }

/// What is typed is wrong before anything is computed.
std::vector<MethodChoice> typed_settings(const SweepPlan& plan) {
    std::vector<MethodChoice> all;
    for (const std::string& text : plan.settings)
        for (MethodChoice& choice : expand_settings(text)) all.push_back(std::move(choice));
    if (plan.settings.empty())
        for (const MethodChoice& method : chosen_methods({}, {}, plan.scenes))
            for (MethodChoice& choice : default_sweep(*method.info)) all.push_back(std::move(choice));
    return all;
}

struct PlanRecord {
    std::vector<std::string> scenes{}, settings{};
    std::uint64_t views = 1, width = 0, height = 0;
    std::optional<std::string> reference{};
    std::optional<std::uint64_t> points{};
    friend bool operator==(const PlanRecord&, const PlanRecord&) = default;
};
DESCRIBE(PlanRecord) {
    MEMBERS(scenes, settings);
    of(MEMBER(views), "", {.least = 1, .most = 1000});
    of(MEMBER(width), "", {.least = 0, .most = 1e6});
    of(MEMBER(height), "", {.least = 0, .most = 1e6});
    MEMBERS(reference, points);
}

/// plan.json
struct PlanFile {
    int schema = kResultsSchema;
    std::string version{};
    PlanRecord plan{};
};
DESCRIBE(PlanFile) {
    MEMBERS(schema, version);
    of.must(MEMBER(plan));
}

PlanRecord plan_record(const SweepPlan& plan) {
    PlanRecord record{.settings  = plan.settings,
                      .views     = static_cast<std::uint64_t>(plan.views),
                      .width     = static_cast<std::uint64_t>(plan.size.width),
                      .height    = static_cast<std::uint64_t>(plan.size.height),
                      .reference = plan.reference,
                      .points    = plan.points};
    for (const fs::path& scene : plan.scenes) record.scenes.push_back(scene.string());
    return record;
}

SweepPlan plan_in(const fs::path& folder) {
    const fs::path file = folder / "plan.json";
    if (!fs::exists(file))
        throw InputError(
            fmt::format("{}: holds no plan.json, expected a folder that umbra sweep wrote", folder.string()));
    const Field root        = read_results(file);
    const PlanRecord record = from_record<PlanFile>(root).plan;
    if (record.scenes.empty()) root["plan"]["scenes"].refuse("one scene or more");
    return {.scenes    = {record.scenes.begin(), record.scenes.end()},
            .settings  = record.settings,
            .views     = static_cast<int>(record.views),
            .size      = {static_cast<int>(record.width), static_cast<int>(record.height)},
            .reference = record.reference,
            .points    = record.points};
}

void write_plan(const SweepPlan& plan, const fs::path& out) {
    const std::string text =
        json_text(to_record(PlanFile{.version = std::string(version()), .plan = plan_record(plan)}));
    if (bytes_of(out / "plan.json") != text) write_text(out / "plan.json", text);
}

/// A setting that failed, in words.
std::string failure_of(const Scene& scene, const MethodRecord& method) {
    return failure_in_words(scene.name, method.text, *method.failed);
}

SweepResults swept_record(SceneLab& lab, const SweepOptions& options, const std::vector<MeasuredSetting>& swept,
                          const std::optional<SweptTurnsRecord>& turns) {
    return {.head      = head_record(options.command),
            .machine   = machine_record(options.threads),
            .scene     = scene_record(lab.scene()),
            .facts     = facts_record(lab.facts()),
            .size      = size_record(lab.size()),
            .lights    = light_records(lab.facts()),
            .reference = lab.reference(),
            .sweep     = sweep_record(swept, options.plan.views, options.workload, turns),
            .budget    = budget_record(options.plan.budget)};
}

}  // namespace

Pack parse_pack(const std::string& text) {
    const auto pack = two_numbers_from<std::size_t>(text, "/");
    if (!pack || pack->first < 1 || pack->first > pack->second)
        throw UsageError(fmt::format("--pack {}: expected K/N with K from 1 to N", text));
    return {pack->first, pack->second};
}

std::vector<MethodChoice> planned_settings(const SweepPlan& plan, const SceneFacts& facts) {
    return by_build(distinct(typed_settings(plan), facts));
}

std::vector<PlannedCell> planned_cells(const SweepPlan& plan) {
    static_cast<void>(typed_settings(plan));
    static_cast<void>(chosen_scenes(plan.scenes));
    std::vector<PlannedCell> cells;
    for (std::size_t s = 0; s < plan.scenes.size(); ++s) {
        const std::vector<MethodChoice> settings = planned_settings(plan, find_facts(load_scene(plan.scenes[s])));
        for (int view = 0; view < plan.views; ++view)
            for (const MethodChoice& choice : settings) cells.push_back({s, view, choice.text()});
    }
    return cells;
}

std::string plan_arguments(const SweepPlan& plan) {
    std::string line;
    for (const fs::path& scene : plan.scenes) line += " " + shell_quoted(fs::absolute(scene).string());
    if (!plan.settings.empty()) line += " --methods";
    for (const std::string& setting : plan.settings) line += " " + shell_quoted(setting);
    line += fmt::format(" --views {}", plan.views);
    if (plan.size.width > 0) line += fmt::format(" --size {}x{}", plan.size.width, plan.size.height);
    if (plan.reference) line += " --reference " + shell_quoted(*plan.reference);
    if (plan.points) line += fmt::format(" --reference-points {}", *plan.points);
    if (std::isfinite(plan.budget.seconds)) line += fmt::format(" --budget {}", plan.budget.seconds);
    if (std::isfinite(plan.budget.bytes)) line += fmt::format(" --memory-budget {}", plan.budget.bytes / (1 << 20));
    return line.substr(1);
}

std::size_t sweep_pack(const SweepOptions& options, Pack pack, std::vector<std::string>& failed) {
    const CellStore store(options.out / "cells");
    write_plan(options.plan, options.out);
    const std::vector<PlannedCell> cells = planned_cells(options.plan);
    std::size_t mine = 0, computed = 0;
    for (std::size_t k = pack.index - 1; k < cells.size(); k += pack.count) ++mine;
    Steps steps(mine, options.progress);
    CellOptions cell = cell_options(options.plan);
    cell.progress    = [&](const std::string& what) { steps.show(what); };
    std::optional<SceneLab> lab;
    std::size_t scene = options.plan.scenes.size();
    int view          = 0;
    for (std::size_t k = pack.index - 1; k < cells.size(); k += pack.count) {
        steps.next();
        if (cells[k].scene != scene) lab.emplace(options.plan.scenes[scene = cells[k].scene], cell, store);
        if (cells[k].view != view) lab->release(view);
        view            = cells[k].view;
        const auto done = lab->computed();
        const Cell made = lab->cell(parse_method(cells[k].setting), view);
        computed += lab->computed() - done;
        if (made.method.failed) failed.push_back(failure_of(lab->scene(), made.method));
    }
    return computed;
}

SweepDone sweep(const SweepOptions& options) {
    const std::vector<ChosenScene> scenes = chosen_scenes(options.plan.scenes);
    static_cast<void>(typed_settings(options.plan));
    const CellStore store(options.out / "cells");
    write_plan(options.plan, options.out);
    SweepDone done;
    for (const ChosenScene& scene : scenes) {
        done.folders.push_back(scene.folder);
        std::optional<Steps> steps;
        CellOptions cell = cell_options(options.plan);
        cell.progress    = [&](const std::string& what) {
            if (steps)
                steps->show(fmt::format("{}: {}", scene.name, what));
            else if (options.progress)
                options.progress(fmt::format("{}: {}", scene.name, what));
        };
        cell.progress("loading");
        SceneLab lab(scene.file, cell, store);
        pass_warnings(lab.scene(), options.warn);
        const std::vector<MethodChoice> choices = planned_settings(options.plan, lab.facts());
        std::vector<MeasuredSetting> swept;
        for (const MethodChoice& choice : choices) swept.push_back({choice, {}, {}});

        // Steps are the cells that have to be computed, so that what is there does not mislead the estimate.
        std::vector<std::pair<int, std::size_t>> missing;
        for (int view = 0; view < options.plan.views; ++view)
            for (std::size_t k = 0; k < choices.size(); ++k)
                if (!lab.has_cell(choices[k], view)) missing.emplace_back(view, k);
        steps.emplace(missing.size(), options.progress);
        std::size_t next = 0;
        for (int view = 0; view < options.plan.views; ++view) {
            for (std::size_t k = 0; k < choices.size(); ++k) {
                if (next < missing.size() && missing[next] == std::pair(view, k)) ++next, steps->next();
                swept[k].views.push_back(lab.cell(choices[k], view));
                if (view == 0 && swept[k].views[0].method.failed)
                    done.failed.push_back(failure_of(lab.scene(), swept[k].views[0].method));
            }
            if (view > 0) lab.release(view);
        }
        steps.reset();
        done.computed += lab.computed();
        done.cells += choices.size() * static_cast<std::size_t>(options.plan.views);

        std::optional<SweptTurnsRecord> turns;
        if (options.times) {
            std::vector<std::size_t> timed;
            std::vector<MethodChoice> to_time;
            for (std::size_t k = 0; k < swept.size(); ++k) {
                const MethodRecord& first = swept[k].views.front().method;
                if (first.failed || first.serves.how == "not") continue;
                timed.push_back(k);
                to_time.push_back(choices[k]);
            }
            TimedTogether times = lab.times(to_time, options.turns, options.most_noise);
            if (const double bar = times.noise_bar(); options.warn && std::isfinite(bar) && bar > options.most_noise)
                options.warn(fmt::format("{}: times vary by {:.0f} %: costs that differ by less are not told apart",
                                         lab.scene().name, std::ceil(100 * bar)));
            for (std::size_t t = 0; t < timed.size(); ++t) swept[timed[t]].times = std::move(times.settings[t]);
            turns = std::move(times.turns);
        }
        done.records.push_back(swept_record(lab, options, swept, turns));
    }
    return done;
}

SweepPlan merged_plan(const std::vector<fs::path>& folders, const fs::path& out) {
    if (folders.empty()) throw UsageError("--merge: no folder given, expected folders that umbra sweep wrote");
    SweepPlan plan = plan_in(folders.front());
    for (const fs::path& folder : folders)
        if (plan_record(plan_in(folder)) != plan_record(plan))
            throw InputError(fmt::format("{}: its plan is not that of {}, expected parts of one sweep",
                                         (folder / "plan.json").string(), folders.front().string()));
    const CellStore store(out / "cells");
    for (const fs::path& folder : folders)
        if (!fs::exists(out) || !fs::equivalent(folder, out)) store.add_all(CellStore(folder / "cells"));

    std::size_t missing = 0;
    for (const fs::path& scene : plan.scenes) {
        SceneLab lab(scene, cell_options(plan), store);
        const std::vector<MethodChoice> settings = planned_settings(plan, lab.facts());
        for (int view = 0; view < plan.views; ++view)
            for (const MethodChoice& choice : settings) missing += !lab.has_cell(choice, view);
    }
    if (missing > 0)
        throw InputError(fmt::format("{}: {} cells are missing; compute them with: umbra sweep {} -o {}", out.string(),
                                     missing, plan_arguments(plan), out.string()));
    return plan;
}

}  // namespace umbra
