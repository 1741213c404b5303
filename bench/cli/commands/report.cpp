#include "umbra/bench/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/lab/antialias.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/report/course/course_report.h"
#include "umbra/bench/report/lecture_experiments.h"
#include "umbra/bench/report/lecture_page.h"
#include "umbra/bench/report/lecture_shows.h"
#include "umbra/bench/studies/radiosity/light_exchange.h"
#include "umbra/bench/studies/shading/shading_study.h"
#include "umbra/bench/studies/whitted/whitted_study.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

struct ReportLine {
    std::vector<std::string> folders;
    std::string out, course;
    std::string language = "en";
    bool without_exr     = false;
    std::vector<std::string> with;
    Budget budget{.seconds = 300};  // one slow method holds up no report
};

/// A part of `umbra sweep` on three of the canonical scenes that takes seconds: presets, and a coarse line a method.
SweepOptions canonical_sweep(const fs::path& out) {
    SweepOptions sweep;
    sweep.out        = out;
    sweep.plan.views = 3;
    sweep.plan.size  = {320, 180};
    constexpr std::array kSwept{"sun_on_plane", "low_sun_fence", "umbra_penumbra"};
    for (const fs::path& scene : canonical_scenes(scenes_folder()))
        if (std::ranges::find(kSwept, scene.stem().string()) != kSwept.end())
            sweep.plan.scenes.push_back(fs::absolute(scene));
    for (const MethodInfo* info : methods())
        if (info->by_default)
            for (const MethodChoice& choice : line_sweep(*info)) sweep.plan.settings.push_back(choice.text());
    sweep.turns = {.rounds = 6, .budget_ms = 4000};
    return sweep;
}

fs::path scene_named(std::string_view name) { return scenes_folder() / fmt::format("{}.json", name); }

/// The canonical scenes, and those that the page of the lectures compares besides.
std::vector<fs::path> compared_scenes() {
    std::vector<fs::path> scenes = canonical_scenes(scenes_folder());
    for (const LectureRow& row : lecture_rows()) {
        const fs::path scene = scene_named(row.scene);
        if (row.scene.empty() || (row.show && !row.show->study.empty()) || !fs::exists(scene)) continue;
        std::set<std::string> frames{""};
        if (row.show)
            for (const LectureFigure& figure : row.show->figures)
                for (const LectureValue& value : figure.values) frames.insert(value.frame);
        for (const std::string& frame : frames)
            if (const fs::path with = scene.string() + frame; std::ranges::find(scenes, with) == scenes.end())
                scenes.push_back(with);
    }
    return scenes;
}

/// What a study does, in a form that takes seconds: `umbra COMMAND SCENE OPTIONS` does the same.
void study_topic(const LectureShow& show, const fs::path& file, const fs::path& folder) {
    const std::string start = fmt::format("umbra {} {}", show.study, file.stem().string());
    const MethodChoice rays = parse_method("ray_traced");
    if (show.study == "shading") {
        const auto method = show.shadows ? std::optional(rays) : std::nullopt;
        const ShadingOptions options{
            .method = method, .runs = 1, .command = start + " --runs 1 --views 1" + (method ? "" : " --no-shadows")};
        write_study(
            folder, [&](const fs::path& to) { return compare_shading(prepare_scene(file, {}), options, to); },
            shading_report);
    } else if (show.study == "whitted") {
        PreparedScene prepared = prepare_scene(file, {400, 225}, 1, Work::picture);
        correct_warnings(prepared.scene);
        WhittedOptions options{.method        = rays,
                               .pixel_samples = kPictureSamples,
                               .bodies        = find_bodies(prepared.scene),
                               .command       = start + " --size 400x225"};
        if (options.bodies->list.empty())
            options.bodies.reset();
        else
            options.command += " --formula";
        write_study(folder, trace_whitted, whitted_report, prepared, options);
    } else {
        const ExchangeOptions options{.size = 0.09, .steps = 2500, .command = start + " --patch 0.09 --steps 2500"};
        write_study(
            folder, [&](const fs::path& to) { return exchange_light(prepare_scene(file, {}), options, to); },
            exchange_report);
    }
}

/// The studies that show topics of the lectures. Returns their folders; a study that fails is printed to standard error
/// and makes `whole` false. Where the folder of scenes has not a study's scene, it is left out.
std::vector<fs::path> study_on_terminal(const fs::path& out, const Common& common, bool& whole) {
    std::vector<fs::path> folders;
    for (const LectureRow& row : lecture_rows()) {
        const std::optional<LectureShow>& show = row.show;
        if (!show || show->study.empty() || !fs::exists(scene_named(row.scene))) continue;
        const std::string name = fmt::format("{} {}", show->study, row.scene);
        const fs::path folder  = out / fmt::format("{}-{}", show->study, row.scene);
        if (std::ranges::find(folders, folder) != folders.end()) continue;
        try {
            const Terminal terminal(common.quiet);
            terminal.progress(name);
            study_topic(*show, scene_named(row.scene), folder);
            folders.push_back(folder);
        } catch (const std::exception& error) {
            print_error("{}: {}\n", name, error.what());
            whole = false;
        }
    }
    return folders;
}

/// All canonical scenes, and then all ladders, the trade on some scenes, and studies of the lectures' other topics.
int run_everything(const fs::path& out, Language language, const Budget& budget, const std::vector<MethodChoice>& with,
                   const Common& common) {
    bool whole      = true;
    const auto then = [&] {
        LadderOptions ladders;
        ladders.out             = out / "ladders";
        ladders.only_by_default = true;
        ladders.budget          = budget;
        whole                   = climb_on_terminal(ladders, common).failed.empty();
        std::vector<fs::path> folders{ladders.out};
        SweepOptions sweep = canonical_sweep(out / "trade");
        sweep.plan.budget  = budget;
        if (!sweep.plan.scenes.empty()) {
            whole = sweep_on_terminal(sweep, common).failed.empty() && whole;
            folders.push_back(sweep.out);
        }
        Terminal(common.quiet).progress("experiments of the lectures");
        folders.push_back(out / "lectures");
        for (const ListedFailureRecord& failed : draw_experiments(folders.back(), scenes_folder(), "umbra report")) {
            print_error("{}: {}: {}\n", failed.scene, failed.method, failed.failure.message);
            whole = false;
        }
        for (fs::path& folder : study_on_terminal(out, common, whole)) folders.push_back(std::move(folder));
        return folders;
    };
    CompareOptions options;
    options.out           = out;
    options.pixel_samples = kPictureSamples;
    options.budget        = budget;
    options.with          = with;
    // A canonical scene without its mesh, which set-up could not fetch, is skipped with a message: that is no failure.
    const ScenesDone done =
        compare_on_terminal(compared_scenes(), options, common, {.then = then, .language = language});
    const int code = exit_code(done);
    if (!whole) return kInternal;
    return code == kDone && done.names.empty() ? kUnreadable : code;
}

/// A lecturer's own report.
int report_course(const ReportLine& line, const Common& common) {
    if (!line.folders.empty()) throw UsageError("report: --course: compares anew, expected no DIR");
    if (line.out.empty()) throw UsageError("report: --course: -o DIR is required");
    if (line.language != "en" || !line.with.empty() || line.without_exr)
        throw UsageError("report: --course: the file says languages and methods, expected no --lang, --with, --no-exr");
    const Course course = read_course(line.course, [](const std::string& name) { return scene_file(name); });
    CompareOptions options;
    options.out = line.out, options.command = common.command, options.threads = thread_count();
    options.pixel_samples             = kPictureSamples;
    options.budget                    = line.budget;
    std::vector<std::string> problems = on_terminal(common, [&](const auto& progress) {
        options.progress = progress;
        return write_course(course, options);
    });
    for (const std::string& problem : problems) print_error("{}\n", problem);
    const std::string no_pdf = print_course(line.out);
    if (!no_pdf.empty()) print_error("no course.pdf: {}\n", no_pdf);
    if (!common.quiet) print_out("{}\n", (fs::path(line.out) / "index.html").string());
    return problems.empty() ? kDone : kUnreadable;
}

/// Of the languages of the page of the lectures.
std::string codes() {
    std::string all;
    for (const Language language : languages()) all += (all.empty() ? "" : ", ") + std::string(language.code);
    return all;
}

int report(const ReportLine& line, const Common& common) {
    if (!line.course.empty()) return report_course(line, common);
    std::optional<Language> language = language_named(line.language);
    if (!language && fs::is_regular_file(fs::path(line.language) / "texts.json"))
        language = add_language(line.language);
    if (!language)
        throw UsageError(fmt::format("report: --lang {}: expected one of {}, or a folder that holds texts.json",
                                     line.language, codes()));
    if (line.without_exr && line.folders.empty())
        throw UsageError("report: --no-exr: no DIR given, expected a folder whose results to copy without EXRs");
    fs::path out = line.out;
    if (out.empty()) out = line.folders.size() == 1 ? line.folders[0] : "results";
    check_writable_beside(out);
    const std::vector<MethodChoice> with =
        line.with.empty() ? std::vector<MethodChoice>() : chosen_methods(line.with, {}, {});
    if (!with.empty() && !line.folders.empty())
        throw UsageError("report: --with: compares anew, expected no DIR, whose pages would only be rebuilt");
    const PlaceLock lock = PlaceLock::inside(out);
    if (line.folders.empty()) return run_everything(out, *language, line.budget, with, common);
    write_report({line.folders.begin(), line.folders.end()}, out,
                 {.language = *language, .with_exr = !line.without_exr});
    if (!common.quiet) print_out("{}\n", (out / "index.html").string());
    return kDone;
}

}  // namespace

Action report_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<ReportLine>();
    app.add_option("DIR", line->folders,
                   "Folders that compare, ladder, sweep, shading, whitted or radiosity wrote: only rebuild their pages")
        ->type_name("");
    app.add_option("-o,--output", line->out, "Folder to write to (default: results; given one DIR, that folder)")
        ->type_name("DIR");
    app.add_option("--course", line->course,
                   "A report of your own: chapters, scenes, exercises (docs/course.md); as a page and a PDF")
        ->type_name("FILE");
    app.add_option("--lang", line->language,
                   "Language of the page of the lectures: " + codes() + ", or a folder with texts.json (default: en)")
        ->type_name("LANG");
    app.add_option("--with", line->with,
                   "Methods that run on each scene beside ours, such as renderers from outside (docs/contenders.md)")
        ->type_name("METHOD");
    add_budget(app, line->budget);
    app.add_flag("--no-exr", line->without_exr, "Leave out the EXRs of results that are copied to the output folder");
    return [line, &common] { return report(*line, common); };
}

}  // namespace umbra
