#include "umbra/bench/report/lecture_page.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/lecture_experiments.h"

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

json caption_of(const std::string& name, Language language) {
    return name.empty() ? json(false) : json(lecture_name(name, language));
}

/// A picture without a caption is of the topic.
void add_shown(const std::optional<LectureShow>& show, const SceneFiles& files, const fs::path& out, const json& topic,
               Language language, json& pictures) {
    const auto add = [&](const FileName& file, const json& caption) {
        json picture = files.figure(file, "", "", caption.is_string() ? caption : topic, out);
        if (!picture.is_object()) return;
        picture["caption"] = caption;
        pictures.push_back(std::move(picture));
    };
    if (!show) return add(picture_of(files.scene().results.reference.files), false);
    for (const LectureValue& value : show->pictures)
        add(from_record<FileName>(value_at(files.scene().root, value.path)), caption_of(value.name, language));
}

/// Of each variant; a click leads to its scene file.
void add_variants(const ExperimentRecord& experiment, const SceneFiles& files, const fs::path& out, Language language,
                  json& pictures) {
    const bool several = !pictures.empty() || experiment.pictures.size() > 1;
    for (const ExperimentPicture& variant : experiment.pictures) {
        const json caption = several ? caption_of(variant.name, language) : json(false);
        json picture       = files.figure(variant.file, "", "", lecture_name(variant.name, language), out);
        picture["caption"] = caption;
        picture["href"]    = files.link(variant.scene, out);
        pictures.push_back(std::move(picture));
    }
}

/// Lines of a formula break between terms alone: neither in brackets nor beside · and /.
std::string with_terms_together(const std::string& formula) {
    const std::string_view all = formula;
    std::string text;
    int depth = 0;
    for (std::size_t at = 0; at < all.size(); ++at) {
        if (all[at] == '(') ++depth;
        if (all[at] == ')') --depth;
        const std::string_view before = all.substr(0, at), after = all.substr(at + 1);
        const bool joins = depth > 0 || before.ends_with(" ·") || before.ends_with(" /") || after.starts_with("· ") ||
                           after.starts_with("/ ");
        text += all[at] != ' ' ? std::string(1, all[at]) : joins ? "\u00a0" : " ";
    }
    return text;
}

/// Ticks, lines and titles, as the template formula_chart shows them; false where nothing was measured along a line.
json chart_of(const ExperimentRecord& experiment, Language language) {
    if (experiment.curves.empty()) return false;
    std::vector<FormulaSeries> series;
    std::string about = lecture_name(experiment.y, language) + ": ";
    for (const ExperimentCurve& curve : experiment.curves) {
        const std::string name = lecture_name(curve.name, language);
        about += name + separator(language);
        series.push_back({name, curve.x, curve.measured, curve.formula});
    }
    json chart = formula_chart(series);
    for (const char* axis : {"x_ticks", "y_ticks"})
        for (json& tick : chart[axis]) {
            const std::string label = number_in_words(tick["label"].get<std::string>(), language);
            tick["label"]           = label.starts_with('-') ? "−" + label.substr(1) : label;
        }
    about.resize(about.size() - separator(language).size());
    chart["about"] = about;
    chart["law"]   = with_terms_together(lecture_name(experiment.law, language));
    chart["x"]     = lecture_name(experiment.x, language);
    chart["y"]     = lecture_name(experiment.y, language);
    // One letter stands upright: turned, an I is a dash.
    chart["upright"] = experiment.y.size() == 1;
    return chart;
}

/// "Largest difference from the formula: 2.1·10⁻⁷ (allowed: 10⁻⁵)."; by curve where their limits differ.
std::string deviation_in_words(const ExperimentRecord& experiment, Language language) {
    const json& phrases = lecture_words(language)["phrases"];
    std::vector<const ExperimentCurve*> measured;
    for (const ExperimentCurve& curve : experiment.curves)
        if (curve.deviation) measured.push_back(&curve);
    if (measured.empty()) return "";
    const bool one_limit =
        std::ranges::all_of(measured, [&](const ExperimentCurve* c) { return c->limit == measured[0]->limit; });
    if (one_limit)
        measured = {*std::ranges::max_element(measured, {}, [](const ExperimentCurve* c) { return *c->deviation; })};
    std::string words = phrases["deviation"].get<std::string>(), next = ": ";
    for (const ExperimentCurve* curve : measured) {
        words += next;
        if (!one_limit) words += lecture_name(curve->name, language) + ": ";
        words += fmt::format("{} ({} {})", score_in_words(curve->deviation, language),
                             phrases["allowed"].get<std::string>(), score_in_words(curve->limit, language));
        next = separator(language);
    }
    return words + ".";
}

std::string pairs_in_words(const ExperimentRecord& experiment, Language language) {
    if (experiment.pairs.empty()) return "";
    std::string words = lecture_name("Difference of the pictures (RMSE)", language), next = ": ";
    const auto quoted =
        [&, marks = lecture_words(language)["phrases"]["quoted"].get<std::string>()](const std::string& name) {
            return fmt::format(fmt::runtime(marks), lecture_name(name, language));
        };
    for (const ExperimentPair& pair : experiment.pairs) {
        words += next;
        words += fmt::format("{} / {}: {}", quoted(pair.one), quoted(pair.other), score_in_words(pair.rmse, language));
        next = separator(language);
    }
    return words + ".";
}

/// The record of an experiment, of this id; null where there is none.
const ExperimentRecord* experiment_of(const ExperimentsRecord& record, const std::string& id) {
    const auto found = std::ranges::find(record.experiments, id, &ExperimentRecord::name);
    return found == record.experiments.end() ? nullptr : &*found;
}

json row_view(const LectureRow& row, const LectureSources& sources, const ExperimentsRecord& experiments,
              const fs::path& out, Language language) {
    const json& words                  = lecture_words(language)["topics"][row.id];
    const auto& show                   = row.show;
    const ExperimentRecord* experiment = experiment_of(experiments, row.id);
    json view                          = {{"id", row.id},
                                          {"topic", words["topic"]},
                                          {"source", lecture_name(row.source, language)},
                                          {"state", state_in_words(row.state, language)},
                                          {"unfinished", !row.state.starts_with("works")},
                                          {"shown", false}};
    const std::string study            = show ? show->study : "";
    const SceneFiles* files            = row.scene.empty() ? nullptr : page_of(sources, study, row.scene);
    if (files == nullptr && experiment == nullptr && !words.contains("proves")) return view;
    json pictures = json::array(), measured = json::array();
    json shown              = {{"proves", words.value("proves", "")}, {"scene", false}, {"chart", false}};
    const auto add_measured = [&](const std::string& text) {
        if (!text.empty()) measured.push_back({{"text", text}, {"lang", std::string(language.code)}});
    };
    if (files != nullptr) {
        shown["href"] = url((files->scene().page / "index.html").lexically_relative(out));
        if (show || experiment == nullptr) add_shown(show, *files, out, words["topic"], language, pictures);
    }
    if (files != nullptr && show && !show->figures.empty()) {
        const auto root_of = [&](const std::string& frame) {
            const SceneFiles* of_frame = page_of(sources, study, row.scene + frame);
            return of_frame == nullptr ? Field{} : of_frame->scene().root;
        };
        for (const LectureFigure& figure : show->figures) add_measured(figure_in_words(figure, root_of, language));
        shown["scene"] =
            language == Language::english ? files->scene().title : lecture_name("scene of the report", language);
    }
    if (experiment != nullptr) {
        add_variants(*experiment, *sources.experiments, out, language, pictures);
        shown["chart"] = chart_of(*experiment, language);
        add_measured(deviation_in_words(*experiment, language));
        add_measured(pairs_in_words(*experiment, language));
    }
    shown["several"]     = pictures.size() != 1;
    shown["is_proved"]   = files != nullptr || experiment != nullptr;
    shown["illustrated"] = !pictures.empty();
    shown["pictures"]    = std::move(pictures);
    shown["is_measured"] = !measured.empty();
    shown["measured"]    = std::move(measured);
    view["shown"]        = std::move(shown);
    return view;
}

}  // namespace

json lectures_view(const LectureSources& sources, const fs::path& out, Language language) {
    const json& words      = lecture_words(language);
    const json& phrases    = words["phrases"];
    json chapters          = json::array();
    bool any               = false;
    const auto experiments = sources.experiments == nullptr
                                 ? ExperimentsRecord{}
                                 : from_record<ExperimentsRecord>(sources.experiments->scene().root);
    for (const auto& [letter, chapter] : words["chapters"].items()) {
        json rows = json::array(), exercises = json::array();
        for (const LectureRow& row : lecture_rows()) {
            if (row.id[0] != letter[0]) continue;
            rows.push_back(row_view(row, sources, experiments, out, language));
            any |= rows.back().value(json::json_pointer("/shown/is_proved"), false);
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
            {"skip", phrases["skip"]},
            {"lead", phrases["lead"]},
            {"measured_word", phrases["measured"]},
            {"exercise_word", phrases["exercise"]},
            {"answer_word", phrases["answer"]},
            {"source_word", phrases["source"]},
            {"back", phrases["back"]},
            {"chapters", std::move(chapters)}};
}

}  // namespace umbra
