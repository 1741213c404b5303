#include "umbra/bench/report/course/course_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "report_assets.h"
#include "umbra/bench/base/files.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/base/record.h"
#include "umbra/bench/base/scratch_folder.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/contenders/line_process.h"
#include "umbra/bench/pages/embed.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kPdf = "course.pdf";

std::vector<std::string> paragraphs(const std::string& text) {
    std::vector<std::string> all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find("\n\n", at), text.size());
        if (end > at) all.push_back(text.substr(at, end - at));
        at = end + 2;
    }
    return all;
}

/// A row a method, in words of the language.
json methods_view(const Results& results, Language language) {
    const bool comma  = lecture_words(language).value("decimal_comma", false);
    const auto figure = [&](const std::string& text) { return comma ? with_decimal_comma(text) : text; };
    json rows         = json::array();
    for (const MethodRecord& method : results.methods) {
        if (is_reference(results, method)) continue;
        const Totals sums = totals(method);
        const bool known  = serves(method) && sums.points > 0;
        rows.push_back({{"method", method_label(method, results.methods)},
                        {"interior", known ? figure(count(sums.interior)) : kNone},
                        {"edge", known ? figure(count(sums.edge)) : kNone},
                        {"points", known ? figure(count(sums.points)) : kNone},
                        {"mae", known ? figure(score(sums.mae)) : kNone},
                        {"ms", serves(method) ? figure(milliseconds(sums.object_ms)) : kNone},
                        {"why", method.failed    ? method.failed->message
                                : serves(method) ? ""
                                                 : method.serves.why}});
    }
    return rows;
}

json scene_section(const SceneFiles& files, const json& words, Language language, std::size_t number) {
    const ScenePage& scene    = files.scene();
    const fs::path root       = scene.page.parent_path();
    const MethodRecord* worst = worst_method(scene.results);
    json view{{"id", fmt::format("scene-{}", number)},
              {"title", scene.title},
              {"href", url(fs::path(scene.name) / "index.html")},
              {"rows", methods_view(scene.results, language)},
              {"pair", slider_view(files, worst, root)},
              {"classes", false},
              {"words", words}};
    if (view["pair"].is_object()) view["pair"]["right"]["who"] = words.at("reference");
    if (worst == nullptr || totals(*worst).interior + totals(*worst).edge == 0) return view;
    const std::string label = method_label(*worst, scene.results.methods);
    json picture            = class_picture_view(files, *worst, label, root);
    if (picture.is_boolean()) return view;
    picture["caption"] = fmt::format("{}: {}. {}", words.at("wrong_points").get<std::string>(), label,
                                     words.at("right_points").get<std::string>());
    picture["rings"]   = false;  // their words are English
    view["classes"]    = std::move(picture);
    return view;
}

json exercises_view(const ChapterRecord& chapter, bool with_answers) {
    json all = json::array();
    for (const ExerciseRecord& exercise : chapter.exercises)
        all.push_back({{"question", exercise.question}, {"answer", with_answers ? exercise.answer : ""}});
    return all;
}

/// Comparisons by scene and methods; nothing where the scene cannot be read.
using CourseScenes = std::map<std::pair<fs::path, std::vector<std::string>>, std::optional<ScenePage>>;

/// The methods of a chapter.
const std::vector<std::string>& methods_in(const CourseRecord& course, std::size_t chapter) {
    const std::vector<std::string>& own = course.chapters[chapter].methods;
    return own.empty() ? course.methods : own;
}

/// Each scene with the methods of its chapter, once where two chapters have both in common. Messages go to `problems`.
CourseScenes compare_course(const Course& course, CompareOptions options, std::vector<std::string>& problems) {
    CourseScenes scenes;
    std::set<std::string> folders;
    for (std::size_t c = 0; c < course.scenes.size(); ++c)
        for (const fs::path& file : course.scenes[c]) {
            options.methods         = methods_in(course.record, c);
            const auto [at, is_new] = scenes.try_emplace({file, options.methods});
            if (!is_new) continue;
            const std::string name = folder_name(scene_name(file));
            options.folder         = name;
            for (int k = 2; !folders.insert(options.folder).second; ++k) options.folder = fmt::format("{}-{}", name, k);
            try {
                at->second = page_in(options.out / options.folder, compare_scene(file, options));
                for (std::string& message : failures(at->second->results)) problems.push_back(std::move(message));
            } catch (const InputError& e) {
                problems.emplace_back(e.what());
            }
        }
    return scenes;
}

}  // namespace

Course read_course(const fs::path& file, const FindScene& find) {
    if (!fs::is_regular_file(file)) throw InputError(fmt::format("{}: is not there, or is no file", file.string()));
    Course course;
    const Field root           = parse_json(bytes_of(file), file.string());
    const CourseRecord& record = course.record = from_strict_record<CourseRecord>(root);
    if (record.chapters.empty()) root["chapters"].refuse("a list with at least one chapter");
    if (!record.language.empty()) {
        const fs::path folder = file.parent_path() / record.language;
        const auto known      = language_named(record.language);
        if (!known && !fs::is_regular_file(folder / "texts.json"))
            root["language"].refuse("a language of this program, or a folder that holds texts.json");
        course.language = known ? *known : add_language(folder);
    }
    course.size = size_of(root["size"]);
    check_methods(root["methods"]);
    for (const Field& chapter : root["chapters"].items()) {
        check_methods(chapter["methods"]);
        course.scenes.push_back(scenes_beside(chapter["scenes"], file, find));
    }
    return course;
}

std::vector<std::string> write_course(const Course& course, CompareOptions options) {
    const fs::path root = options.out = fs::weakly_canonical(fs::absolute(options.out));
    check_writable_beside(root, {kPdf});
    const PlaceLock lock = PlaceLock::inside(root);
    options.size         = course.size;
    options.add_page     = write_scene_page;
    std::vector<std::string> problems;
    const CourseScenes compared = compare_course(course, options, problems);

    StagedFiles staged;
    const json words = lecture_words(course.language).at("course");
    json chapters = json::array(), folders = json::array();
    std::size_t number = 0;
    for (std::size_t c = 0; c < course.scenes.size(); ++c) {
        const ChapterRecord& chapter = course.record.chapters[c];
        json scenes                  = json::array();
        for (const fs::path& file : course.scenes[c])
            if (const auto& scene = compared.at({file, methods_in(course.record, c)})) {
                scenes.push_back(scene_section(SceneFiles(*scene, staged), words, course.language, ++number));
                folders.push_back(scene->name);
            }
        chapters.push_back({{"id", fmt::format("chapter-{}", c + 1)},
                            {"title", chapter.title},
                            {"paragraphs", paragraphs(chapter.text)},
                            {"scenes", std::move(scenes)},
                            {"exercises", exercises_view(chapter, course.record.answers)},
                            {"words", words}});
    }
    const PageHead head{course.record.title, {"slider.js", "pictures.js"}, "", std::string(course.language.code)};
    staged.write(root / "index.html", render_page(assets::course_html, head,
                                                  {{"title", course.record.title},
                                                   {"paragraphs", paragraphs(course.record.text)},
                                                   {"chapters", std::move(chapters)},
                                                   {"failures", problems},
                                                   {"words", words},
                                                   {"version", version()}}));
    write_scene_assets(root, staged);
    staged.remove(root / kPdf);  // of an earlier page
    Json record        = to_record(head_record(options.command));
    CourseRecord shown = course.record;  // what is handed out holds no answers that its page does not show
    if (!shown.answers)
        for (ChapterRecord& chapter : shown.chapters)
            for (ExerciseRecord& exercise : chapter.exercises) exercise.answer.clear();
    record["course"] = to_record(shown);
    record["scenes"] = folders, record["files"] = {kPdf};
    staged.write(root / "results.json", json_text(record));
    staged.commit();
    return problems;
}

std::string print_course(const fs::path& out) {
    const fs::path root = fs::weakly_canonical(fs::absolute(out)), made = root / ".course.pdf.umbra-new";
    const ScratchFolder folder;
    const fs::path page = folder.path() / "course.html";  // whose links do not lead into folders of this machine
    write_text(page, embedded_page(root / "index.html"));
    for (const char* browser : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"}) {
        // Chromium says nothing that could be waited for: the shell says how it ended.
        std::vector<std::string> command{"sh", "-c", "\"$@\" >&2; echo $?", "sh", browser};
        for (const char* option :
             {"--headless", "--disable-gpu", "--no-pdf-header-footer", "--virtual-time-budget=20000"})
            command.emplace_back(option);
        if (geteuid() == 0) command.emplace_back("--no-sandbox");  // it has none for root
        command.push_back("--print-to-pdf=" + made.string());
        command.push_back("file://" + url(page));
        try {
            const std::string code = LineProcess(command, root).ask("", 300);
            if (code == "127") continue;  // there is none of that name
            if (code != "0" || !fs::is_regular_file(made))
                return fmt::format("{} ended with exit code {} and wrote no PDF", browser, code);
        } catch (const MethodError& e) {
            return fmt::format("{}: {}", browser, e.what());
        }
        fs::rename(made, root / kPdf);
        return "";
    }
    return "no Chromium was found in PATH, which prints the page";
}

}  // namespace umbra
