#include "umbra/bench/compare/compare.h"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/bench/compare/explained_points.h"
#include "umbra/bench/compare/exr_layers.h"
#include "umbra/bench/compare/fine_picture.h"
#include "umbra/bench/compare/image_figures.h"
#include "umbra/bench/compare/method_files.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/compare/values_script.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/steps.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

/// "name", then "name-2", ...: ids name files and must not repeat.
std::string unique_id(std::string_view name, std::set<std::string>& used) {
    std::string id(name);
    for (int k = 2; !used.insert(id).second; ++k) id = fmt::format("{}-{}", name, k);
    return id;
}

/// A method's entry of the record, and the times of the run that its answers are from; none where it has no answers.
struct Answered {
    MethodRecord entry;
    std::optional<RunTimes> first{};
};

/// Runs those that have answers in turns, at most `repeats.max_runs` rounds and `repeats.budget_ms` for each phase of
/// each, no run longer than the budget, and writes the times into their entries. One that throws gets the entry of a
/// method that failed, and its files in `folder` go. Returns `turns` of the record: what concerns all of them.
/// `answered` is one a choice.
TurnsRecord time_methods(const std::filesystem::path& folder, const PreparedScene& prepared,
                         std::span<const MethodChoice> choices, std::vector<Answered>& answered, const Repeats& repeats,
                         const Budget& budget, const std::function<void(const std::string&)>& tell) {
    std::vector<MethodChoice> timed;
    std::vector<std::size_t> which;
    std::vector<OwnTimes> cold;  // by the clocks of programs from outside
    TurnOptions turn_options;
    for (std::size_t k = 0; k < choices.size(); ++k) {
        if (!answered[k].first) continue;
        timed.push_back(choices[k]);
        which.push_back(k);
        cold.push_back(choices[k].make()->own_times(prepared.scene).value_or(OwnTimes{}));
        turn_options.first.push_back(answered[k].first);
    }
    constexpr double phases = 4;
    turn_options.rounds     = repeats.max_runs;
    turn_options.budget_ms  = phases * repeats.budget_ms * static_cast<double>(timed.size());
    turn_options.most       = budget;
    turn_options.progress   = [&](const std::string& what) { tell("times, " + what); };
    const double before     = load_average();
    const Turns turns       = time_in_turns(prepared, timed, turn_options);
    for (std::size_t t = 0; t < timed.size(); ++t) {
        MethodRecord& entry = answered[which[t]].entry;
        if (turns.settings[t].failed.empty()) {
            set_times(entry, prepared.scene, turns.settings[t]);
            if (const auto own = timed[t].make()->own_times(prepared.scene))
                entry.own_times = own_times_record(*own, cold[t]);
            continue;
        }
        // What throws when it runs again has no answers that anybody could rely on.
        const std::string id = entry.id;
        remove_files_of(folder, id);
        entry = failed_record(id, timed[t], prepared.scene,
                              {timed[t].text(), {}, turns.settings[t].failed, turns.settings[t].cut});
    }
    return turns_record(turns, turn_options, {before, load_average()});
}

}  // namespace

Results compare_scene(const fs::path& file, const CompareOptions& options) {
    const auto tell = [&](const std::string& what) {
        if (options.progress) options.progress(fmt::format("{}: {}", scene_name(file), what));
    };
    std::vector<MethodChoice> choices = chosen_methods(options.methods, options.choices, {&file, 1});
    choices.insert(choices.end(), options.with.begin(), options.with.end());

    tell("loading");
    const PreparedScene prepared = prepare_scene(file, options.size, options.pixel_samples);
    const Scene& scene           = prepared.scene;
    pass_warnings(scene, options.warn);

    const fs::path folder = options.out / (options.folder.empty() ? folder_name(scene.name) : options.folder);
    StagedFolder stage(folder);
    const fs::path& staging = stage.folder();

    Truths truths(
        scene, prepared.facts, prepared.points,
        {.reference = options.reference, .points = options.points, .budget = options.budget, .progress = tell});
    const Truth& main_truth           = truths.main();
    const Reference& reference        = main_truth.reference;
    const ReferenceRun& reference_ran = main_truth.ran;
    const MethodRun& reference_run    = reference_ran.run;
    std::map<const Truth*, Rendered> rendered_truths;
    const auto rendered_of = [&](const Truth& truth) -> const Rendered& {
        const auto known = rendered_truths.find(&truth);
        if (known != rendered_truths.end()) return known->second;
        return rendered_truths.emplace(&truth, render_planes(scene, prepared.points, truth.ran.run.planes))
            .first->second;
    };

    Results results{.head      = head_record(options.command),
                    .machine   = machine_record(options.threads),
                    .scene     = scene_record(scene),
                    .facts     = facts_record(prepared.facts),
                    .size      = size_record({prepared.points.raster->width, prepared.points.raster->height}),
                    .lights    = light_records(prepared.facts),
                    .reference = reference_record(main_truth, scene),
                    .budget    = budget_record(options.budget)};
    const FinePicture fine  = fine_picture(prepared, reference_run);
    results.reference.files = write_reference_files({staging, "reference", options.command}, prepared,
                                                    {reference_run, rendered_of(main_truth), fine});

    ValuesScript values(scene, prepared.points, reference_run);
    std::set<std::string> used = {"reference"};
    double shade_ms            = 0;
    std::vector<MethodChoice> listed;
    std::vector<Answered> answered;
    for (const MethodChoice& choice : choices) {
        // Where the reference is too slow for the whole picture, so is the same method in the list.
        const bool itself = choice.text() == reference.choice.text();
        if (itself && options.methods.empty() && !reference_ran.stand_in.empty()) continue;
        tell(choice.text());
        listed.push_back(choice);
        const std::string id = unique_id(choice.info->name, used);
        const Truth* truth   = nullptr;
        MethodRecord entry;
        Trial trial{.truth = [&](const MethodRun& run) -> const MethodRun& {
                        truth = &truths.of(run.work->method());
                        return truth->ran.run;
                    },
                    .budget = options.budget,
                    .then =
                        [&](const Outcome& found) {
                            entry = served_record(id, prepared, found, truth->reference.choice.text());
                            for (LightId j = 0; j < scene.lights.size(); ++j)
                                entry.errors[j].explained = explained_points(
                                    scene, prepared.points, j, found.run, truth->ran.run, found.explained[j].classes);
                            Rendered rendered;
                            shade_ms =
                                timed_ms([&] { rendered = render_planes(scene, prepared.points, found.run.planes); });
                            ComparedFiles written = write_compared_files(
                                {staging, id, options.command}, prepared, {found.run, rendered, fine},
                                {truth->ran.run, rendered_of(*truth), fine}, found.explained);
                            entry.image = written.image;
                            entry.files = std::move(written.files);
                            values.add(label_of(entry), found.run, found.explained,
                                       truth == &main_truth ? nullptr : &truth->ran.run);
                        }};
        if (itself && reference_ran.stand_in.empty())
            trial.run = [&](std::optional<LightId>&) { return reference_run; };
        const Outcome found = outcome(choice, scene, prepared.facts, prepared.points, trial);
        if (found.failed) {
            remove_files_of(staging, id);
            answered.push_back({failed_record(id, choice, scene, *found.failed)});
        } else if (found.run.service) {
            answered.push_back({std::move(entry)});
            if (choice.info->is_timed) answered.back().first = found.run.times;
        } else {
            answered.push_back({unserved_record(id, choice, found.run.service)});
        }
    }
    results.turns = time_methods(staging, prepared, listed, answered, options.repeats, options.budget, tell);
    for (Answered& a : answered) results.methods.push_back(std::move(a.entry));
    results.times = {{"load_ms", prepared.load_ms},
                     {"facts_ms", prepared.facts_ms},
                     {"rays_build_ms", prepared.rays_build_ms},
                     {"gbuffer_ms", prepared.gbuffer_ms},
                     {"shade_ms", shade_ms}};
    for (const MethodRecord& method : results.methods)
        if (method.failed) values.remove(label_of(method));
    results.values = {"values.js"};
    write_text(staging / results.values.name, values.text());
    write_text(staging / "results.json", record_text(results));
    if (options.add_page) options.add_page(staging);
    stage.commit();
    if (options.scene_done) options.scene_done();
    return results;
}

ScenesDone compare_scenes(const std::vector<fs::path>& files, const CompareOptions& options) {
    const std::vector<ChosenScene> scenes = chosen_scenes(files);
    for (const std::string& text : options.methods) static_cast<void>(parse_method(text));
    if (options.reference) static_cast<void>(parse_method(*options.reference));
    ScenesDone done;
    Results last;
    CompareOptions numbered = options;
    Steps steps(scenes.size(), options.progress);
    numbered.progress = [&](const std::string& what) { steps.show(what); };
    for (const auto& [file, name, folder] : scenes) {
        numbered.folder = folder;
        steps.next();
        try {
            last = compare_scene(file, numbered);
            done.names.push_back(folder);
            for (std::string& message : failures(last)) done.stopped.push_back(std::move(message));
        } catch (const MissingMesh& e) {
            done.missing.emplace_back(e.what());
        } catch (const UsageError&) {  // of an option, whatever the scene
            throw;
        } catch (const InputError& e) {
            done.failed.emplace_back(e.what());
        } catch (...) {
            done.failed.push_back(fmt::format("{}: {}", scene_name(file), current_message()));
            done.internal = true;
        }
    }
    if (files.size() == 1 && done.names.size() == 1) {
        StagedFiles staged;
        staged.write(options.out / "results.json", record_text(with_prefix(last, done.names[0] + "/")));
        staged.commit();
    }
    return done;
}

Service render_scene(const fs::path& file, const RenderOptions& options) {
    const MethodChoice choice    = parse_method(options.method);
    const bool png               = options.out.extension() == ".png";
    const PreparedScene prepared = prepare_scene(file, options.size, png ? options.pixel_samples : 1, Work::picture);
    pass_warnings(prepared.scene, options.warn);
    std::optional<LightId> at;
    MethodRun run{choice};
    try {
        run = run_method(choice, prepared.scene, prepared.facts, prepared.points, &at);
    } catch (const UsageError&) {  // settings that this scene does not allow
        throw;
    } catch (...) {
        throw MethodError(fmt::format("{} failed{}: {}", choice.text(),
                                      at ? fmt::format(" at light {}", prepared.scene.lights[*at].name) : "",
                                      current_message()));
    }
    if (!run.service) return run.service;
    const Rendered rendered = render_planes(prepared.scene, prepared.points, run.planes);
    Image image =
        png ? picture_of(prepared, run, rendered, {})
            : exr_image(rendered.linear, prepared.scene, prepared.points, run, {.geometry = options.with_geometry});
    image.metadata.merge(run_metadata(prepared.scene, choice, options.command));
    write_image(options.out, image);
    return run.service;
}

}  // namespace umbra
