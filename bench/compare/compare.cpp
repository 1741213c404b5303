#include "umbra/bench/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <set>
#include <utility>

#include "umbra/bench/compare/exr_layers.h"
#include "umbra/bench/compare/fine_picture.h"
#include "umbra/bench/compare/image_figures.h"
#include "umbra/bench/compare/method_files.h"
#include "umbra/bench/compare/method_times.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/out/files.h"
#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/out/staged_folder.h"
#include "umbra/bench/run/canonical.h"
#include "umbra/bench/run/explain.h"
#include "umbra/bench/run/noise_runs.h"
#include "umbra/bench/run/steps.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr Repeats kOnce{1, 0};

void warn(const Scene& scene, const std::function<void(const std::string&)>& receive) {
    if (!receive) return;
    for (const std::string& warning : scene.warnings) receive(fmt::format("{}: {}", scene.name, warning));
}

/// "name", then "name-2", ...: ids name files and must not repeat.
std::string unique_id(std::string_view name, std::set<std::string>& used) {
    std::string id(name);
    for (int k = 2; !used.insert(id).second; ++k) id = fmt::format("{}-{}", name, k);
    return id;
}

/// What a method answered, differences, times and files. `at` is the light that is being worked on.
Json method_entry(const FilePlace& place, const PreparedScene& prepared, const MethodRun& run,
                  const MethodRun& reference, const Rendered& reference_rendered, const FinePicture& known,
                  double& shade_ms, std::optional<LightId>& at) {
    const Scene& scene = prepared.scene;
    std::vector<Explained> explained;
    at.reset();
    const auto noise = noise_runs(*run.work, scene, prepared.points);
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        at = j;
        explained.push_back(explain(scene, prepared.points, j, run, reference, noise[j] ? &*noise[j] : nullptr));
    }
    at.reset();
    Json entry = served_json(place.id, prepared, run, explained, reference.choice.text());
    Rendered rendered;
    shade_ms              = timed_ms([&] { rendered = render_planes(scene, prepared.points, run.planes); });
    ComparedFiles written = write_compared_files(place, prepared, {run, rendered, known},
                                                 {reference, reference_rendered, known}, explained);
    entry["image"]        = std::move(written.image);
    entry["files"]        = std::move(written.files);
    return entry;
}

/// The methods of the options, in order; where these name none, those that are the default on this scene. Throws
/// UsageError, also where settings contradict one another.
std::vector<MethodChoice> chosen(const CompareOptions& options, const fs::path& scene) {
    std::vector<MethodChoice> choices;
    for (const std::string& text : options.methods) {
        choices.push_back(parse_method(text));
        static_cast<void>(choices.back().make());
    }
    choices.insert(choices.end(), options.choices.begin(), options.choices.end());
    if (choices.empty())
        for (const MethodInfo* info : methods())
            if (runs_by_itself(*info, scene)) choices.emplace_back(*info);
    return choices;
}

/// A folder for each scene. Throws UsageError where one file is given twice.
std::vector<std::string> folders_of(const std::vector<fs::path>& files) {
    const auto lower = [](std::string text) {
        std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
        return text;
    };
    std::set<fs::path> given;
    std::set<std::string> taken;
    std::vector<std::string> folders;
    for (const fs::path& file : files) {
        if (!given.insert(fs::weakly_canonical(file)).second)
            throw UsageError(fmt::format("{}: is given twice, expected each scene once", file.string()));
        const std::string name = folder_name(scene_name(file));
        folders.push_back(name);
        for (int k = 2; !taken.insert(lower(folders.back())).second; ++k)
            folders.back() = fmt::format("{}-{}", name, k);
    }
    return folders;
}

}  // namespace

Json compare_scene(const fs::path& file, const CompareOptions& options) {
    const auto tell = [&](const std::string& what) {
        if (options.progress) options.progress(fmt::format("{}: {}", scene_name(file), what));
    };
    const std::vector<MethodChoice> choices = chosen(options, file);

    tell("loading");
    const PreparedScene prepared = prepare_scene(file, options.size, options.pixel_samples);
    const Scene& scene           = prepared.scene;
    warn(scene, options.warn);

    const fs::path folder = options.out / (options.folder.empty() ? folder_name(scene.name) : options.folder);
    StagedFolder stage(folder);
    const fs::path& staging = stage.folder();

    Reference reference = default_reference(prepared.facts);
    if (options.reference) {
        reference       = {parse_method(*options.reference), false, "Chosen on the command line."};
        reference.exact = verdict(*reference.choice.make(), prepared.facts).how == How::exactly;
    }
    tell("reference " + reference.choice.text());
    const auto find_truth = [&](Reference& with) {
        return run_reference_or_substitute(with, scene, prepared.facts, prepared.points, options.points);
    };
    const TruthRun truth_ran =
        options.reference
            ? TruthRun{run_reference(reference, scene, prepared.facts, prepared.points, options.points), std::nullopt}
            : find_truth(reference);
    const ReferenceRun& reference_ran = truth_ran.ran;
    const MethodRun& reference_run    = reference_ran.run;
    const Rendered reference_rendered = render_planes(scene, prepared.points, reference_run.planes);

    Json record                  = {{"schema", kResultsSchema},
                                    {"version", version()},
                                    {"command", options.command},
                                    {"machine", machine_json(options.threads)},
                                    {"scene", scene_json(scene)},
                                    {"facts", facts_json(prepared.facts)},
                                    {"size", {{"width", prepared.points.raster->width}, {"height", prepared.points.raster->height}}},
                                    {"lights", lights_json(prepared.facts)},
                                    {"times", Json::object()},
                                    {"turns", nullptr},
                                    {"reference", reference_json(reference, reference_ran, scene, truth_ran.failed)},
                                    {"methods", Json::array()}};
    const FinePicture fine       = fine_picture(prepared, reference_run);
    record["reference"]["files"] = write_reference_files({staging, "reference", options.command}, prepared,
                                                         {reference_run, reference_rendered, fine});

    // Methods that measure what the reference does not measure are compared with a truth of their own.
    struct Truth {
        ReferenceRun ran;
        Rendered rendered;
    };
    std::optional<Truth> other;
    const auto differs_in_measure = [&](const MethodChoice& choice) {
        const Measure measure = choice.make()->measures();
        if (prepared.facts.hard_lights_only || measure == reference_run.work->method().measures()) return false;
        if (!other) {
            Reference chosen = default_reference(prepared.facts, measure);
            tell("reference " + chosen.choice.text());
            other.emplace(Truth{find_truth(chosen).ran, {}});
            other->rendered = render_planes(scene, prepared.points, other->ran.run.planes);
        }
        return true;
    };

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
        const bool slow      = total(reference_run.visibility).median > options.repeats.budget_ms;
        std::optional<LightId> at;
        try {
            const bool apart               = differs_in_measure(choice);
            const MethodRun& truth         = apart ? other->ran.run : reference_run;
            const Rendered& truth_rendered = apart ? other->rendered : reference_rendered;
            const MethodRun run            = itself && slow && reference_ran.stand_in.empty()
                                                 ? reference_run
                                                 : run_method(choice, scene, prepared.facts, prepared.points, kOnce, &at);
            if (run.service)
                answered.push_back({method_entry({staging, id, options.command}, prepared, run, truth, truth_rendered,
                                                 fine, shade_ms, at),
                                    times_of(run)});
            else
                answered.push_back({unserved_json(id, choice, run.service)});
        } catch (const InputError&) {  // a file that cannot be written is no fault of the method
            throw;
        } catch (...) {
            answered.push_back({failed_json(id, choice, scene, at, current_message())});
        }
    }
    record["turns"] = time_methods(staging, prepared, listed, answered, options.repeats, tell);
    for (Answered& a : answered) record["methods"].push_back(std::move(a.entry));
    record["times"] = {{"load_ms", prepared.load_ms},
                       {"facts_ms", prepared.facts_ms},
                       {"rays_build_ms", prepared.rays_build_ms},
                       {"gbuffer_ms", prepared.gbuffer_ms},
                       {"shade_ms", shade_ms}};
    write_text(staging / "results.json", json_text(record));
    if (options.add_page) options.add_page(staging);
    stage.commit();
    if (options.scene_done) options.scene_done();
    return record;
}

ScenesDone compare_scenes(const std::vector<fs::path>& files, const CompareOptions& options) {
    const std::vector<std::string> folders = folders_of(files);
    for (const std::string& text : options.methods) static_cast<void>(parse_method(text));
    if (options.reference) static_cast<void>(parse_method(*options.reference));
    ScenesDone done;
    Json last;
    CompareOptions numbered = options;
    Steps steps(files.size(), options.progress);
    numbered.progress = [&](const std::string& what) { steps.show(what); };
    for (std::size_t i = 0; i < files.size(); ++i) {
        const fs::path& file = files[i];
        numbered.folder      = folders[i];
        steps.next();
        try {
            last = compare_scene(file, numbered);
            done.names.push_back(folders[i]);
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
        staged.write(options.out / "results.json", json_text(with_prefix(last, done.names[0] + "/")));
        staged.commit();
    }
    return done;
}

Service render_scene(const fs::path& file, const RenderOptions& options) {
    const MethodChoice choice    = parse_method(options.method);
    const bool png               = options.out.extension() == ".png";
    const PreparedScene prepared = prepare_scene(file, options.size, png ? options.pixel_samples : 1, Work::picture);
    warn(prepared.scene, options.warn);
    std::optional<LightId> at;
    MethodRun run{choice};
    try {
        run = run_method(choice, prepared.scene, prepared.facts, prepared.points, {1, 0}, &at);
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
