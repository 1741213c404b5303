#include "umbra/bench/report/course/grade_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report_assets.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"
#include "umbra/bench/report/report.h"
#include "umbra/bench/studies/study_report.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string points_in_words(double points, double max) { return fmt::format("{:g} of {:g}", points, max); }

/// What an item found where it lost points on a scene and a light has the figure.
bool is_lost(const GradedSceneRecord& found) {
    return std::isfinite(found.credit) && found.credit < 1 && !found.light.empty();
}

/// Pictures of wrong points, one a light by which items lost points on the scene, with their names; of all points that
/// are wrong where none did.
json class_pictures(const GradeRecord& grade, const Compared& scene, const MethodRecord& method,
                    const SceneFiles& files) {
    const fs::path page = files.scene().page.parent_path();
    std::map<std::string, std::string> lost;  // items by light
    for (const GradedItemRecord& item : grade.items)
        for (const GradedSceneRecord& found : item.scenes)
            if (found.scene == scene.folder && is_lost(found))
                lost[found.light] += (lost[found.light].empty() ? "" : ", ") + item.name;
    json all = json::array();
    for (const auto& [light, items] : lost) {
        const LightFilesRecord* of = files_of(method.files, light);
        if (of == nullptr || !of->classes) continue;
        json view       = files.figure(of->classes, "Handed in", "errors of " + light,
                                       fmt::format("Classes of the wrong points on {}, light {}", scene.folder, light), page);
        view["caption"] = fmt::format("Wrong points, light “{}”. Right points are grey.", light);
        view["of_item"] = items;
        view["rings"]   = files.rings(of->classes);
        view["legend"]  = files.legend(of->classes);
        all.push_back(std::move(view));
    }
    if (all.empty())
        if (json view = class_picture_view(files, method, "what was handed in", page); view.is_object())
            all.push_back(std::move(view));
    return all;
}

/// The address of the section with an item's picture; empty where it has none.
std::string picture_address(const GradedItemRecord& item, const std::vector<Compared>& scenes) {
    const GradedSceneRecord* worst = nullptr;
    for (const GradedSceneRecord& found : item.scenes)
        if (is_lost(found) && (worst == nullptr || found.credit < worst->credit)) worst = &found;
    for (std::size_t s = 0; s < scenes.size() && worst != nullptr; ++s)
        if (scenes[s].folder == worst->scene) return fmt::format("#scene-{}", s + 1);
    return {};
}

json items_view(const GradeRecord& grade, const std::vector<Compared>& scenes) {
    json items = json::array();
    for (const GradedItemRecord& item : grade.items)
        items.push_back({{"name", item.name},
                         {"about", item.about},
                         {"points", points_in_words(item.points, item.max)},
                         {"sentence", item.sentence},
                         {"where", picture_address(item, scenes)}});
    return items;
}

json scenes_view(const GradeRecord& grade, const std::vector<Compared>& scenes, const std::vector<SceneFiles>& files) {
    json all = json::array();
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        const fs::path page        = files[s].scene().page.parent_path();
        const MethodRecord* method = scenes[s].record();
        if (method != nullptr && (method->failed || !serves(*method))) method = nullptr;  // there is nothing to show
        all.push_back(
            {{"id", fmt::format("scene-{}", s + 1)},
             {"title", scenes[s].folder},
             {"href", scenes[s].method.empty() ? "" : url(fs::path(scenes[s].folder) / "index.html")},
             {"finding", method != nullptr ? finding_of(*method) : scenes[s].why_not()},
             {"pair", method != nullptr ? slider_view(files[s], method, page) : json(false)},
             {"classes", method != nullptr ? class_pictures(grade, scenes[s], *method, files[s]) : json(false)}});
    }
    return all;
}

std::string apart_in_words(const ApartRecord& apart) {
    return fmt::format(
        "The program ran {}, {} network, with {} of memory for each process, {:g} s an answer and {:g} s a scene.",
        apart.by == "nothing" ? "with the rights of this process" : "apart from other files (bwrap)",
        apart.network ? "with" : "without",
        std::isfinite(apart.memory_mib) ? fmt::format("{:g} MiB", apart.memory_mib) : "any amount", apart.answer_s,
        apart.scene_s);
}

/// Why nothing could be asked of it, or on which scenes it has no answers.
std::string failed_in_words(const GradeRecord& grade) {
    if (!grade.failed.empty()) return grade.failed;
    std::set<std::string> scenes;
    for (const GradedItemRecord& item : grade.items)
        for (const GradedSceneRecord& scene : item.scenes)
            if (scene.unanswered) scenes.insert(scene.scene);
    return scenes.empty() ? "" : fmt::format("no answers on {}", fmt::join(scenes, ", "));
}

/// Keys of columns have no dots or slashes, which mean members of members.
std::string column_key(std::string name) {
    std::ranges::replace_if(
        name, [](char c) { return c == '.' || c == '/' || c == '~'; }, '_');
    return name;
}

StudyReport class_report(const ClassRecord& record) {
    StudyTable table{.name    = "grades",
                     .caption = fmt::format("{}, of {:g} points", record.rubric, record.max),
                     .columns = {{.key = "handed_in", .head = "Handed in", .notation = kWords, .link = "page"},
                                 {.key = "points", .head = "Points", .notation = kGeneral}},
                     .rows    = Json::array()};
    for (const std::string& item : record.items)
        table.columns.push_back({.key = "item " + column_key(item), .head = item, .notation = kGeneral});
    table.columns.push_back({.key = "failed", .head = "Failed", .notation = kWords});
    for (const ClassRowRecord& row : record.rows) {
        Json values{{"handed_in", row.handed_in},
                    {"page", url(fs::path(row.folder) / "index.html")},
                    {"points", row.points},
                    {"failed", row.failed}};
        for (std::size_t i = 0; i < row.items.size(); ++i) values["item " + column_key(record.items[i])] = row.items[i];
        table.rows.push_back(std::move(values));
    }
    double sum = 0;
    for (const ClassRowRecord& row : record.rows) sum += row.points;
    StudyReport report{.title  = record.rubric,
                       .page   = assets::class_html,
                       .tables = {std::move(table)},
                       .words  = {{"title", record.rubric}}};
    if (!record.rows.empty())
        report.sentences.push_back({fmt::format("{} handed in, {:.1f} of {:g} points on average.", record.rows.size(),
                                                sum / static_cast<double>(record.rows.size()), record.max)});
    return report;
}

}  // namespace

void write_grade_page(const GradeRecord& grade, const RubricRecord& rubric, const std::vector<Compared>& scenes,
                      const fs::path& folder, StagedFiles& staged) {
    const fs::path root = fs::weakly_canonical(fs::absolute(folder));
    std::vector<ScenePage> pages;
    for (const Compared& scene : scenes) pages.push_back(page_in(root / scene.folder, scene.results));
    std::vector<SceneFiles> files;
    files.reserve(pages.size());
    for (const ScenePage& page : pages) files.emplace_back(page, staged);
    const PageHead head{fmt::format("{}: {}", grade.handed_in, grade.rubric), {"slider.js", "pictures.js"}};
    staged.write(root / "index.html",
                 render_page(assets::grade_html, head,
                             {{"title", grade.rubric},
                              {"text", rubric.text},
                              {"handed_in", grade.handed_in},
                              {"points", grade.max > 0 ? points_in_words(grade.points, grade.max) : ""},
                              {"failures",
                               [&] {
                                   json all = grade.not_compared;
                                   if (!grade.failed.empty()) all.insert(all.begin(), grade.failed);
                                   return all;
                               }()},
                              {"items", items_view(grade, scenes)},
                              {"scenes", scenes_view(grade, scenes, files)},
                              {"apart", grade.apart ? apart_in_words(*grade.apart) : ""},
                              {"has_commands", !grade.head.command.empty()},
                              {"commands", json::array({without_folders(grade.head.command)})},
                              {"version", grade.head.version}}));
    write_scene_assets(root, staged);
}

std::string grade_text(const GradeRecord& grade) {
    std::string text = fmt::format("{}: {}\n", grade.handed_in,
                                   grade.max > 0 ? points_in_words(grade.points, grade.max) + " points" : grade.rubric);
    if (!grade.failed.empty()) text += fmt::format("  {}\n", grade.failed);
    if (grade.failed.empty())
        for (const GradedItemRecord& item : grade.items) text += fmt::format("  {}: {}\n", item.name, item.sentence);
    for (const std::string& scene : grade.not_compared) text += fmt::format("  {}\n", scene);
    return text;
}

ClassRecord write_class(const RubricRecord& rubric, const std::vector<GradeRecord>& grades,
                        const std::vector<std::string>& folders, const std::string& command, const fs::path& out) {
    ClassRecord record{.head = head_record(command), .rubric = rubric.title, .max = 0};
    for (const RubricItemRecord& item : rubric.items) record.items.push_back(item.name), record.max += item.points;
    for (std::size_t i = 0; i < grades.size(); ++i) {
        const GradeRecord& grade = grades[i];
        ClassRowRecord row{.handed_in = grade.handed_in,
                           .folder    = folders[i],
                           .failed    = failed_in_words(grade),
                           .points    = grade.points};
        for (const GradedItemRecord& item : grade.items) row.items.push_back(item.points);
        record.rows.push_back(std::move(row));
    }
    check_writable_beside(out, {"grades.csv"});
    const StudyReport report = class_report(record);
    StagedFiles staged;
    write_study_files(report, record, out, staged);
    staged.commit();
    return record;
}

std::string class_text(const ClassRecord& record) { return study_text(class_report(record)); }

}  // namespace umbra
