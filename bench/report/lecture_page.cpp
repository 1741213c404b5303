#include "umbra/bench/report/lecture_page.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>

#include "report_assets.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"
#include "umbra/bench/report/lecture_shows.h"
#include "umbra/core/base/trimmed.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A cell as text: without blanks around it, backquotes and the addresses of links; empty for a dash.
std::string plain(std::string cell) {
    static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
    cell = std::regex_replace(cell, link, "$1");
    std::erase(cell, '`');
    const std::string_view words = trimmed(cell);
    return std::string(words == kNone ? "" : words);
}

std::vector<LectureRow> rows_of(std::string_view page) {
    std::vector<LectureRow> rows;
    std::istringstream lines{std::string(page)};
    for (std::string line; std::getline(lines, line);) {
        if (line.size() < 4 || !line.starts_with("| ") || line[2] < 'A' || line[2] > 'F' || line[3] < '0' ||
            line[3] > '9')
            continue;
        std::vector<std::string> cells;
        std::istringstream in(line.substr(1));
        for (std::string cell; std::getline(in, cell, '|');) cells.push_back(plain(cell));
        if (cells.size() == 7) rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[6]});
    }
    return rows;
}

std::string text(const Translated& words, Language language) { return std::string(words.in(language)); }

/// The state of a row: in English with what is missing, in other languages the state alone.
std::string state_in_words(const std::string& state, Language language) {
    if (language == Language::english) return state;
    const LecturePhrases& words = lecture_phrases();
    if (state.starts_with("in part")) return text(words.in_part, language);
    return text(state.starts_with("not yet") ? words.not_yet : words.works, language);
}

const LectureText* text_of(const std::string& id) {
    const auto texts = lecture_texts();
    const auto found = std::ranges::find(texts, id, &LectureText::id);
    return found == texts.end() ? nullptr : &*found;
}

std::string topic(const LectureRow& row, const LectureText* words, Language language) {
    if (words == nullptr || language == Language::english) return row.topic;
    return std::string(language == Language::german ? words->german : words->greek);
}

/// Null where the report has no such page.
const SceneFiles* page_of(const LectureSources& sources, std::string_view study, const std::string& scene) {
    const auto found = std::ranges::find_if(
        sources.pages, [&](const auto& page) { return page.first == study && page.second->scene().name == scene; });
    return found == sources.pages.end() ? nullptr : found->second;
}

json pictures_of(const LectureShow* show, const SceneFiles& files, const fs::path& out, Language language) {
    json pictures  = json::array();
    const auto add = [&](const Field& file, const std::string& caption) {
        json picture = files.figure(file, "", "", caption.empty() ? files.scene().title : caption, out);
        if (!picture.is_object()) return;
        picture["caption"] = caption.empty() ? json(false) : json(caption);
        pictures.push_back(std::move(picture));
    };
    if (show != nullptr)
        for (const LectureValue& value : show->pictures)
            add(value_at(files.scene().root, value.path), text(value.name, language));
    else
        add(files.scene().root["reference"]["files"]["png"], "");
    return pictures;
}

json row_view(const LectureRow& row, const LectureSources& sources, const fs::path& out, Language language) {
    const LectureText* words = text_of(row.id);
    const LectureShow* show  = lecture_show(row.id);
    json view                = {{"id", row.id},
                                {"topic", topic(row, words, language)},
                                {"source", row.source},
                                {"state", state_in_words(row.state, language)},
                                {"unfinished", !row.state.starts_with("works")},
                                {"shown", false}};
    const SceneFiles* files  = page_of(sources, show == nullptr ? "" : show->study, row.scene);
    if (row.scene.empty() || files == nullptr) return view;
    json pictures = pictures_of(show, *files, out, language);
    json measured = json::array();
    if (show != nullptr)
        for (const LectureFigure& figure : show->figures)
            if (const std::string figures = figure_in_words(figure, files->scene().root, language); !figures.empty())
                measured.push_back({{"text", figures}, {"lang", std::string(code_of(language))}});
    if (show == nullptr || show->study.empty())
        if (const std::string found = finding(files->scene().root); !found.empty())
            measured.push_back({{"text", found}, {"lang", "en"}});
    view["shown"] = {{"href", url((files->scene().page / "index.html").lexically_relative(out))},
                     {"scene", files->scene().title},
                     {"proves", words == nullptr ? "" : text(words->proves, language)},
                     {"several", pictures.size() > 1},
                     {"pictures", std::move(pictures)},
                     {"is_measured", !measured.empty()},
                     {"measured", std::move(measured)}};
    return view;
}

json exercises_view(const LectureChapter& chapter, Language language) {
    json view = json::array();
    for (const Exercise& exercise : chapter.exercises)
        view.push_back({{"exercise", text(exercise.question, language)}, {"answer", text(exercise.answer, language)}});
    return view;
}

}  // namespace

const std::vector<LectureRow>& lecture_rows() {
    static const std::vector<LectureRow> rows = rows_of(assets::lectures_md);
    return rows;
}

json lectures_view(const LectureSources& sources, const fs::path& out, Language language) {
    const LecturePhrases& words = lecture_phrases();
    json chapters               = json::array();
    bool any                    = false;
    for (const LectureChapter& chapter : lecture_chapters()) {
        json rows = json::array();
        for (const LectureRow& row : lecture_rows()) {
            if (row.id[0] != chapter.letter) continue;
            rows.push_back(row_view(row, sources, out, language));
            any |= rows.back()["shown"].is_object();
        }
        chapters.push_back({{"letter", std::string(1, chapter.letter)},
                            {"title", text(chapter.title, language)},
                            {"exercises", exercises_view(chapter, language)},
                            {"rows", std::move(rows)}});
    }
    if (!any) return false;
    return {{"title", text(words.title, language)},
            {"lead", text(words.lead, language)},
            {"measured_word", text(words.measured, language)},
            {"exercise_word", text(words.exercise, language)},
            {"answer_word", text(words.answer, language)},
            {"source_word", text(words.source, language)},
            {"back", text(words.back, language)},
            {"chapters", std::move(chapters)}};
}

}  // namespace umbra
