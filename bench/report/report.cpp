// The report: results.json files -> numbers and sentences in the shape of the page templates -> pages.
//
// The templates (bench/pages/assets/*.html) hold the words and the markup; the views (report_index, report_scene) fill
// them.
#include "umbra/bench/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>

#include "report_assets.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/ladders/ladder_page.h"
#include "umbra/bench/ladders/textbook_view.h"
#include "umbra/bench/pages/failures.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/lecture_experiments.h"
#include "umbra/bench/report/lecture_page.h"
#include "umbra/bench/report/report_views.h"
#include "umbra/bench/sweep/trade_page.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<std::string> kSceneScripts = {"slider.js", "compare.js", "pictures.js"};

std::vector<fs::path> results_files(const fs::path& dir) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(dir, error))
        if (entry.is_directory() && !is_hidden_name_of_ours(entry.path()) && fs::exists(entry.path() / "results.json"))
            files.push_back(entry.path() / "results.json");
    if (error)
        throw InputError(
            fmt::format("{}: {}, expected a folder that umbra compare wrote", dir.string(), error.message()));
    std::sort(files.begin(), files.end());
    if (files.empty() && is_there(dir / "results.json")) files.push_back(dir / "results.json");
    if (files.empty())
        throw InputError(fmt::format(
            "{}: holds no results.json, nor does any folder in it, expected a folder that umbra compare wrote",
            dir.string()));
    return files;
}

/// The scene of a results.json, without what was found there.
ScenePage recorded_scene(const Field& root, const fs::path& file) {
    ScenePage page{.root  = root,
                   .data  = fs::canonical(file.parent_path()),
                   .page  = {},
                   .name  = root["scene"]["name"].required_text(),
                   .title = root["scene"]["title"].text()};
    if (page.title.empty()) page.title = in_words(page.name);
    return page;
}

/// Members of the results.json of commands whose pages are no part of a report.
constexpr std::array kOtherPages{"bias", "motion", "growth", "frames"};

/// A results.json of a compared scene, and its place; nothing where it is of another command.
std::optional<ScenePage> read_scene(const Field& root, const fs::path& file) {
    const auto is_in = [&](const char* member) { return root[member].present(); };
    if (std::ranges::any_of(kOtherPages, is_in)) return std::nullopt;
    for (const char* other : {"ladders", "sweep", "sweeps", "experiments"})
        if (is_in(other)) return std::nullopt;
    if (!root["methods"].present()) root["methods"].refuse("an array");
    Results results = from_record<Results>(root);
    ScenePage scene = recorded_scene(root, file);
    scene.triangles = static_cast<double>(results.facts.triangles);
    scene.results   = std::move(results);
    return scene;
}

/// What `umbra shading`, `umbra whitted` or `umbra radiosity` wrote, as a part of a report.
struct StudyPage {
    std::string command;  ///< "shading", "whitted" or "radiosity"
    ScenePage scene;      ///< its results, pictures and page
};

/// Nothing where the results.json is of another command.
std::optional<StudyPage> read_study(const Field& root, const fs::path& file) {
    for (const auto& [member, command] : {std::pair{"models", "shading"}, {"ways", "whitted"}, {"unshot", "radiosity"}})
        if (root[member].present()) {
            StudyPage study{command, recorded_scene(root, file)};
            study.scene.results.size = from_record<SizeRecord>(root["size"]);
            return study;
        }
    return std::nullopt;
}

/// A folder of ladders, and where its page lies in the report.
struct LadderFolder {
    fs::path data, page;
};

/// The contents of the folders: compared scenes, studies of shading and of other light, runs of ladders, the
/// results.json of swept scenes, and the experiments of the lectures, of the first folder that has them.
struct Found {
    std::vector<ScenePage> scenes;
    std::vector<StudyPage> studies;
    std::vector<LadderFolder> ladders;
    std::vector<fs::path> sweeps;
    std::optional<ScenePage> experiments;  ///< of the lectures
};

/// The results.json of swept scenes that a results.json stands for: itself, or those of the scenes that it lists.
std::vector<fs::path> swept(const Field& root, const fs::path& file) {
    if (root["sweep"].present()) return {fs::canonical(file)};
    std::vector<fs::path> files;
    for (const Field& scene : root["sweeps"].items()) {
        const fs::path listed = file.parent_path() / scene.required_text() / "results.json";
        if (!is_file(listed)) scene.refuse("a folder beside this file that holds a results.json");
        files.push_back(fs::canonical(listed));
    }
    return files;
}

bool is_below(const fs::path& folder, const fs::path& out) {
    const fs::path relative = folder.lexically_relative(out);
    return relative != "." && *relative.begin() != "..";
}

/// Where each page lies: beside its data, where those are below `out`, else in a folder of its own there.
void place_pages(Found& found, const fs::path& out) {
    std::set<fs::path> taken;
    if (!found.sweeps.empty()) taken.insert(out / "trade");
    for (StudyPage& study : found.studies)
        study.scene.page = is_below(study.scene.data, out) ? study.scene.data
                                                           : out / folder_name(study.command + "-" + study.scene.name);
    const auto stay = [&](auto& of) {
        if (is_below(of.data, out)) taken.insert(of.page = of.data);
    };
    const auto place = [&](fs::path& page, const std::string& name) {
        for (int i = 1; page.empty(); ++i) {
            const fs::path folder = out / (name + (i > 1 ? fmt::format("-{}", i) : ""));
            if (taken.insert(folder).second) page = folder;
        }
    };
    std::ranges::for_each(found.scenes, stay);
    std::ranges::for_each(found.ladders, stay);
    if (found.experiments) {
        stay(*found.experiments);
        place(found.experiments->page, "lectures");
    }
    for (LadderFolder& folder : found.ladders) place(folder.page, "ladders");
    for (ScenePage& scene : found.scenes) place(scene.page, folder_name(scene.name));
}

Found find_results(const std::vector<fs::path>& dirs, const fs::path& out) {
    Found found;
    for (const fs::path& dir : dirs) {
        const auto first = std::ptrdiff_t(found.scenes.size());
        bool is_shown    = false;
        for (const fs::path& file : results_files(dir)) {
            const Field root = read_results(file);
            is_shown         = is_shown ||
                       std::ranges::none_of(kOtherPages, [&](const char* member) { return root[member].present(); });
            // A report that was made before holds copies.
            if (root["ladders"].present() && std::ranges::none_of(found.ladders, [&](const LadderFolder& other) {
                    return bytes_of(other.data / "results.json") == bytes_of(file);
                }))
                found.ladders.push_back({fs::canonical(file.parent_path()), {}});
            if (root["experiments"].present() && !found.experiments)
                found.experiments = ScenePage{
                    .root = root, .data = fs::canonical(file.parent_path()), .page = {}, .name = {}, .title = {}};
            for (fs::path& sweep : swept(root, file))
                if (std::ranges::find(found.sweeps, sweep) == found.sweeps.end())
                    found.sweeps.push_back(std::move(sweep));
            if (std::optional<StudyPage> study = read_study(root, file)) {
                if (std::ranges::none_of(found.studies,
                                         [&](const StudyPage& s) { return s.scene.data == study->scene.data; }))
                    found.studies.push_back(std::move(*study));
            } else if (std::optional<ScenePage> scene = read_scene(root, file)) {
                if (std::ranges::find(found.scenes, scene->data, &ScenePage::data) == found.scenes.end())
                    found.scenes.push_back(std::move(*scene));
            }
        }
        if (!is_shown)
            throw InputError(
                fmt::format("{}: holds what another command wrote, with a page of its own, expected a "
                            "folder of compare, ladder, sweep, shading, whitted or radiosity",
                            dir.string()));
        // From simple to large, the order of a lecture.
        std::stable_sort(found.scenes.begin() + first, found.scenes.end(),
                         [](const ScenePage& a, const ScenePage& b) { return a.triangles < b.triangles; });
    }
    place_pages(found, out);
    return found;
}

/// The files that an iterator of folders finds in `from`, to the same places in `to`.
template <class Iterator>
void copy_files(const fs::path& from, const fs::path& to, StagedFiles& staged) {
    if (from == to) return;
    for (const auto& entry : Iterator(from))
        if (entry.is_regular_file() && !is_hidden_name_of_ours(entry.path()))
            staged.copy(entry.path(), to / entry.path().lexically_relative(from));
}

/// The tables of ladders for the first page, one a run, and the pages of ladders with their files where they can be
/// handed out with the report. Returns what the template shows; an empty list where there are no ladders.
json ladder_sections(const std::vector<LadderFolder>& folders, const fs::path& out, StagedFiles& staged) {
    json sections = json::array();
    for (const LadderFolder& folder : folders) {
        copy_files<fs::recursive_directory_iterator>(folder.data, folder.page, staged);
        const LaddersRecord record = read_ladders(folder.data / "results.json");
        const std::string page     = url((folder.page / "index.html").lexically_relative(out));
        const std::string number   = sections.empty() ? "" : fmt::format("-{}", sections.size() + 1);
        write_ladder_page(record, folder.page, url((out / "index.html").lexically_relative(folder.page)), staged);
        sections.push_back({{"page", page},
                            {"number", number},
                            {"which", folders.size() > 1 ? fmt::format(" {}", sections.size() + 1) : ""},
                            {"run", folders.size() > 1 ? run_view(record.head, record.machine) : json(false)},
                            {"table", ladder_table_view(record, page)},
                            {"textbook", textbook_view(record, page)},
                            {"showcase", ladder_showcase_view(record, page)},
                            {"count", counted(double(record.ladders.size()), "ladder")}});
    }
    return sections;
}

/// The page of sweeps, and what the first page shows of it; false where there are no sweeps.
json trade_section(const std::vector<fs::path>& sweeps, const fs::path& out, StagedFiles& staged) {
    if (sweeps.empty()) return false;
    const fs::path place   = out / "trade";
    const std::string page = url((place / "index.html").lexically_relative(out));
    json lines             = json::array();
    for (const TradeLine& line :
         write_trade_page(sweeps, place, url((out / "index.html").lexically_relative(place)), staged))
        lines.push_back({{"scene", line.scene}, {"href", page + "#" + line.anchor}, {"finding", line.finding}});
    return {{"page", page}, {"lines", std::move(lines)}};
}

/// Links to the pages of studies; false where there are none.
json studies_section(const std::vector<StudyPage>& studies, const fs::path& out) {
    if (studies.empty()) return false;
    json lines = json::array();
    for (const StudyPage& study : studies)
        lines.push_back({{"command", study.command},
                         {"scene", study.scene.title},
                         {"href", url((study.scene.page / "index.html").lexically_relative(out))}});
    return {{"lines", std::move(lines)}};
}

/// The page of the lectures; false where no scene of theirs is there.
json lectures_section(const std::vector<SceneFiles>& files, const Found& found, const fs::path& out,
                      const ReportOptions& options, StagedFiles& staged) {
    LectureSources sources;
    std::vector<SceneFiles> of_studies;
    of_studies.reserve(found.studies.size());
    for (const SceneFiles& scene : files) sources.pages.emplace_back("", &scene);
    for (const StudyPage& study : found.studies)
        sources.pages.emplace_back(study.command, &of_studies.emplace_back(study.scene, staged));
    std::optional<SceneFiles> of_experiments;
    if (found.experiments) {
        sources.experiments = &of_experiments.emplace(*found.experiments, staged);
        if (found.experiments->page != found.experiments->data)
            staged.copy(found.experiments->data / "results.json", found.experiments->page / "results.json");
    }
    json view = lectures_view(sources, out, options.language);
    if (!view.is_object()) return false;
    const std::string title = view["title"];
    staged.write(out / "lectures.html",
                 render_page(assets::lectures_html, {.title = title, .language = std::string(options.language.code)},
                             std::move(view)));
    return {{"page", "lectures.html"}};
}

/// The page of methods from outside; false where there are none.
json renderers_section(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files, const fs::path& out,
                       StagedFiles& staged) {
    json view = renderers_view(scenes, files, out);
    if (!view.is_object()) return false;
    json section = {{"page", "renderers.html"}, {"lines", view["contenders"]}};
    staged.write(
        out / "renderers.html",
        render_page(assets::renderers_html, {"Renderers against the truth", {"pictures.js"}}, std::move(view)));
    return section;
}

/// Everything that failed, in words, for the first page.
void add_failures(json& index, const std::vector<std::string>& scenes_failed, const Found& found) {
    json failures = scenes_failed;
    for (const ScenePage& scene : found.scenes)
        for (std::string& message : scene_failures(scene.results)) failures.push_back(scene.title + ": " + message);
    const auto add = [&](const std::vector<ListedFailureRecord>& failed) {
        for (std::string& message : listed_failures(failed)) failures.push_back(std::move(message));
    };
    for (const LadderFolder& folder : found.ladders) add(read_ladders(folder.data / "results.json").failed);
    if (found.experiments) add(from_record<ExperimentsRecord>(found.experiments->root).failed);
    index["failures"] = std::move(failures);
}

std::string scene_page(const SceneFiles& files, const std::vector<MethodRecord>& settings, const json& previous,
                       const json& next, const std::string& root, const std::string& title) {
    json view        = scene_view(files, settings);
    view["previous"] = previous;
    view["next"]     = next;
    return render_page(assets::scene_html, {fmt::format("{} – {}", files.scene().title, title), kSceneScripts, root},
                       std::move(view));
}

}  // namespace

void write_scene_page(const fs::path& folder) {
    std::optional<ScenePage> scene = read_scene(read_results(folder / "results.json"), folder / "results.json");
    if (!scene) return;
    scene->page = scene->data;
    StagedFiles staged;
    const SceneFiles files(*scene, staged);
    staged.write(scene->page / "index.html",
                 scene_page(files, settings_of({*scene}), false, false, "../", ReportOptions{}.title));
    staged.commit();
}

void write_scene_assets(const fs::path& folder, StagedFiles& staged) {
    write_page_assets(folder, kSceneScripts, staged);
}

bool links_hold(const fs::path& page) {
    const std::string html = bytes_of(page);
    if (html.empty()) return false;
    static const std::regex link(R"re( (?:src|href)="([^"#]+))re");
    for (std::sregex_iterator at(html.begin(), html.end(), link), end; at != end; ++at)
        if (const std::string target = (*at)[1]; !target.starts_with("data:") && !target.starts_with("http") &&
                                                 !fs::exists(page.parent_path() / path_of_url(target)))
            return false;
    return true;
}

void write_report(const std::vector<fs::path>& dirs, const fs::path& out, const ReportOptions& options) {
    if (dirs.empty()) throw UsageError("report: no folder given, expected one that umbra compare wrote");
    const fs::path root                  = fs::weakly_canonical(fs::absolute(out));
    Found found                          = find_results(dirs, root);
    const std::vector<ScenePage>& scenes = found.scenes;
    for (ScenePage& scene : found.scenes) scene.with_exr = options.with_exr;
    StagedFiles staged;
    for (const StudyPage& study : found.studies)
        copy_files<fs::directory_iterator>(study.scene.data, study.scene.page, staged);
    const std::vector<MethodRecord> settings = settings_of(scenes);

    std::vector<SceneFiles> files;
    files.reserve(scenes.size());
    for (const ScenePage& scene : scenes) files.emplace_back(scene, staged);

    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const fs::path& page = scenes[i].page;
        const auto neighbour = [&](std::size_t k) {
            return json{{"title", scenes[k].title},
                        {"href", url((scenes[k].page / "index.html").lexically_relative(page))}};
        };
        const json previous = i > 0 ? neighbour(i - 1) : json(false);
        const json next     = i + 1 < scenes.size() ? neighbour(i + 1) : json(false);
        if (page != scenes[i].data) staged.copy(scenes[i].data / "results.json", page / "results.json");
        staged.write(page / "index.html", scene_page(files[i], settings, previous, next,
                                                     url(root.lexically_relative(page) / ""), options.title));
    }
    json index         = index_view(scenes, files, root, options.title);
    index["stability"] = ladder_sections(found.ladders, root, staged);
    index["trade"]     = trade_section(found.sweeps, root, staged);
    index["studies"]   = studies_section(found.studies, root);
    index["renderers"] = renderers_section(scenes, files, root, staged);
    index["lectures"]  = lectures_section(files, found, root, options, staged);
    add_failures(index, options.failed, found);
    index["so_far"] = options.so_far;
    write_page(root, assets::index_html, {options.title, {"slider.js", "finder.js", "pictures.js"}}, std::move(index),
               staged);
    write_scene_assets(root, staged);
    staged.commit();
}

}  // namespace umbra
