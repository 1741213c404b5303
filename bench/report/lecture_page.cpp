#include "umbra/bench/report/lecture_page.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"
#include "umbra/bench/report/lecture_shows.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The state of a row: in English with what is missing, in other languages the state alone.
std::string state_in_words(const std::string& state, Language language) {
    if (language == Language::english) return state;
    const json& words = lecture_words(language)["phrases"];
    return words[state.starts_with("in part") ? "in_part" : state.starts_with("not yet") ? "not_yet" : "works"];
}

/// Null where the report has no such page.
const SceneFiles* page_of(const LectureSources& sources, std::string_view study, const std::string& scene) {
    const auto found = std::ranges::find_if(
        sources.pages, [&](const auto& page) { return page.first == study && page.second->scene().name == scene; });
    return found == sources.pages.end() ? nullptr : found->second;
}

json pictures_of(const LectureShow* show, const SceneFiles& files, const fs::path& out, Language language) {
    json pictures  = json::array();
    const auto add = [&](const FileName& file, const std::string& caption) {
        json picture = files.figure(file, "", "", caption.empty() ? files.scene().title : caption, out);
        if (!picture.is_object()) return;
        picture["caption"] = caption.empty() ? json(false) : json(caption);
        pictures.push_back(std::move(picture));
    };
    if (show != nullptr)
        for (const LectureValue& value : show->pictures)
            add(from_record<FileName>(value_at(files.scene().root, value.path)), lecture_name(value.name, language));
    else
        add(picture_of(files.scene().results.reference.files), "");
    return pictures;
}

json row_view(const LectureRow& row, const LectureSources& sources, const fs::path& out, Language language) {
    const json& words       = lecture_words(language)["topics"][row.id];
    const LectureShow* show = lecture_show(row.id);
    json view               = {{"id", row.id},
                               {"topic", words["topic"]},
                               {"source", row.source},
                               {"state", state_in_words(row.state, language)},
                               {"unfinished", !row.state.starts_with("works")},
                               {"shown", false}};
    const SceneFiles* files = page_of(sources, show == nullptr ? "" : show->study, row.scene);
    if (row.scene.empty() || files == nullptr) return view;
    json pictures = pictures_of(show, *files, out, language);
    json measured = json::array();
    if (show != nullptr)
        for (const LectureFigure& figure : show->figures)
            if (const std::string figures = figure_in_words(figure, files->scene().root, language); !figures.empty())
                measured.push_back({{"text", figures}, {"lang", std::string(language.code)}});
    if (show == nullptr || show->study.empty())
        if (const std::string found = finding(files->scene().results); !found.empty())
            measured.push_back({{"text", found}, {"lang", "en"}});
    view["shown"] = {{"href", url((files->scene().page / "index.html").lexically_relative(out))},
                     {"scene", files->scene().title},
                     {"proves", words.value("proves", "")},
                     {"several", pictures.size() > 1},
                     {"pictures", std::move(pictures)},
                     {"is_measured", !measured.empty()},
                     {"measured", std::move(measured)}};
    return view;
}

}  // namespace

json lectures_view(const LectureSources& sources, const fs::path& out, Language language) {
    const json& words   = lecture_words(language);
    const json& phrases = words["phrases"];
    json chapters       = json::array();
    bool any            = false;
    for (const auto& [letter, chapter] : words["chapters"].items()) {
        json rows = json::array(), exercises = json::array();
        for (const LectureRow& row : lecture_rows()) {
            if (row.id[0] != letter[0]) continue;
            rows.push_back(row_view(row, sources, out, language));
            any |= rows.back()["shown"].is_object();
        }
        for (const json& exercise : chapter["exercises"])
            exercises.push_back({{"exercise", exercise["question"]}, {"answer", exercise["answer"]}});
        chapters.push_back({{"letter", letter},
                            {"title", chapter["title"]},
                            {"exercises", std::move(exercises)},
                            {"rows", std::move(rows)}});
    }
    if (!any) return false;
    return {{"title", phrases["title"]},
            {"lead", phrases["lead"]},
            {"measured_word", phrases["measured"]},
            {"exercise_word", phrases["exercise"]},
            {"answer_word", phrases["answer"]},
            {"source_word", phrases["source"]},
            {"back", phrases["back"]},
            {"chapters", std::move(chapters)}};
}

}  // namespace umbra
