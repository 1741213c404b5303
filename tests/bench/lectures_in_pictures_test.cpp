// The page of the lectures: every topic in order, each picture with its own words, in three languages.
#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "report_fixture.h"
#include "umbra/bench/report/lecture_experiments.h"
#include "umbra/bench/report/lecture_page.h"
#include "umbra/bench/report/lecture_shows.h"
#include "umbra/bench/report/lecture_texts.h"
#include "umbra/bench/studies/radiosity/light_exchange.h"
#include "umbra/bench/studies/shading/shading_study.h"
#include "umbra/bench/studies/whitted/whitted_study.h"

namespace umbra {
namespace {

using namespace report_fixture;

constexpr Language kGerman{"de"}, kGreek{"el"};

/// The part of the page that belongs to one topic.
std::string topic_of(const std::string& html, const std::string& id) {
    const auto begin = html.find("id=\"" + id + "\"");
    return begin == std::string::npos ? "" : html.substr(begin, html.find("</article>", begin) - begin);
}

/// Other than of the angle in a formula.
bool has_greek(std::string_view text) {
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (text.substr(at).starts_with("θ"))
            ++at;
        else if (text[at] == '\xce' || text[at] == '\xcf')
            return true;
    }
    return false;
}

std::set<std::string> keys_of(const json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

/// Whether a name consists of symbols, numbers and names of people alone, which no language changes.
bool is_symbolic(const std::string& name) {
    static const std::regex word("[A-Za-z]{3,}"), symbol("cos|sin|tan|max|min|RGB|Phong|Blinn|Gouraud");
    if (name == "on") return false;
    return std::all_of(std::sregex_iterator(name.begin(), name.end(), word), std::sregex_iterator(),
                       [](const std::smatch& found) { return std::regex_match(found.str(), symbol); });
}

/// Words of a show or of an experiment that a language must have.
std::set<std::string> names_shown() {
    std::set<std::string> names;
    const auto add = [&](const std::vector<LectureValue>& values) {
        for (const LectureValue& value : values)
            if (!value.name.empty()) names.insert(value.name);
    };
    for (const LectureRow& row : lecture_rows()) {
        if (row.source.find("errs") != std::string::npos) names.insert(row.source);
        if (!row.show) continue;
        add(row.show->pictures);
        for (const LectureFigure& figure : row.show->figures) names.insert(figure.what), add(figure.values);
    }
    static const std::regex in_words(R"(\b(where|beside|or)\b)");
    for (const json& experiment : lecture_experiments()["experiments"]) {
        if (const std::string law = experiment.value("law", ""); std::regex_search(law, in_words)) names.insert(law);
        for (const char* list : {"variants", "also"})
            for (const json& each : experiment.value(list, json::array())) {
                if (!is_symbolic(each["name"])) names.insert(each["name"]);
                if (each.contains("caption")) names.insert(each["caption"]);
            }
    }
    return names;
}

/// What is missing, too much, or of the wrong kind in a language's words.
std::vector<std::string> faults_of(const json& words, bool is_english) {
    std::vector<std::string> faults;
    const json& english = lecture_words(Language::english);
    const auto has_text = [](const json& object, const std::string& key) { return !object.value(key, "").empty(); };
    if (!words["decimal_comma"].is_boolean()) faults.emplace_back("decimal_comma");
    if (keys_of(words["phrases"]) != keys_of(english["phrases"])) faults.emplace_back("phrases");
    for (const std::string& key : keys_of(words["phrases"]))
        if (!has_text(words["phrases"], key)) faults.push_back(key + " is no text");
    if (keys_of(words["chapters"]) != keys_of(english["chapters"])) faults.emplace_back("chapters");
    for (const json& chapter : words["chapters"]) {
        if (!has_text(chapter, "title") || chapter["exercises"].size() < 2) faults.emplace_back("a chapter");
        for (const json& exercise : chapter["exercises"])
            if (!has_text(exercise, "question") || !has_text(exercise, "answer")) faults.emplace_back("an exercise");
    }
    std::set<std::string> ids;
    for (const LectureRow& row : lecture_rows()) {
        ids.insert(row.id);
        if (!words["topics"].contains(row.id)) continue;
        const json& topic = words["topics"][row.id];
        if (!has_text(topic, "topic")) faults.push_back(row.id + ": no topic");
        if (!has_text(topic, "proves")) faults.push_back(row.id + ": no sentence");
    }
    if (keys_of(words["topics"]) != ids) faults.emplace_back("topics");
    if (!is_english && keys_of(words["names"]) != names_shown()) faults.emplace_back("names");
    return faults;
}

TEST(LectureTexts, EveryLanguageHasAllWords) {
    ASSERT_EQ(languages().size(), 3u);
    for (const Language language : languages())
        EXPECT_EQ(faults_of(lecture_words(language), language == Language::english), std::vector<std::string>())
            << language.code;
    for (const LectureRow& row : lecture_rows()) {
        const auto proves = [&](Language language) {
            return lecture_words(language)["topics"][row.id].value("proves", "");
        };
        EXPECT_TRUE(has_greek(proves(kGreek))) << row.id;
        EXPECT_FALSE(has_greek(proves(Language::english)) || has_greek(proves(kGerman))) << row.id;
    }
}

TEST(LectureTexts, PlantedFaultsAreFound) {
    for (const char* pointer : {"/topics/C1/topic", "/topics/C1/proves", "/topics/C1", "/phrases/lead", "/chapters/D",
                                "/chapters/D/exercises/1", "/names/flat"}) {
        json words = lecture_words(kGerman);
        const json::json_pointer at(pointer);
        json& parent = words[at.parent_pointer()];
        if (parent.is_array())
            parent.erase(1);
        else
            parent.erase(at.back());
        EXPECT_EQ(faults_of(words, false).size(), 1u) << pointer;
    }
}

/// A cell of the page in the documentation as text: without blanks, backquotes and addresses of links; empty for a dash.
std::string plain(std::string cell) {
    static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
    cell = std::regex_replace(cell, link, "$1");
    std::erase(cell, '`');
    cell.erase(0, cell.find_first_not_of(' '));
    cell.erase(cell.find_last_not_of(' ') + 1);
    return cell == "–" ? "" : cell;
}

TEST(LectureTexts, RowsAreThoseOfThePageInTheDocumentation) {
    std::ifstream in(fs::path(UMBRA_TOP) / "docs/lectures.md");
    std::vector<std::vector<std::string>> found, expected;
    for (std::string line; std::getline(in, line);) {
        if (!std::regex_search(line, std::regex(R"(^\| [A-F]\d)"))) continue;
        std::istringstream cells(line.substr(1));
        found.emplace_back();
        for (std::string cell; std::getline(cells, cell, '|');) found.back().push_back(plain(cell));
    }
    for (const LectureRow& row : lecture_rows()) {
        const json& words = lecture_words(Language::english)["topics"][row.id];
        expected.push_back({row.id, words["topic"], row.source, row.scene, row.test, row.code, row.state});
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.size(), 78u);
}

TEST(LectureTexts, LanguagesHaveTheirCodes) {
    for (const Language language : languages()) EXPECT_EQ(language_named(language.code), language);
    EXPECT_FALSE(language_named("fr"));
    EXPECT_FALSE(language_named(""));
}

TEST_F(Report, LecturesAreShownWithTheirPicturesInOrder) {
    put(out / "light_inside_view", sample("light_inside_view"));
    put(out / "court", sample("court"));
    write_report({out}, out);
    const std::string html = read(out / "lectures.html");
    std::size_t at         = 0;
    for (const LectureRow& row : lecture_rows()) {
        const auto next = html.find("id=\"" + row.id + "\"", at);
        ASSERT_NE(next, std::string::npos) << row.id;
        at = next;
    }
    const std::string shown = topic_of(html, "D10");
    EXPECT_TRUE(contains(shown, "S_j of a point light jumps from 0 to 1")) << shown;
    EXPECT_TRUE(contains(shown, "light_inside_view/reference.png")) << shown;
    EXPECT_FALSE(contains(shown, "wrong interior points")) << "that proves nothing about a point light";
    EXPECT_FALSE(contains(topic_of(html, "D9"), "<img")) << "its scene is not in the report";
    EXPECT_FALSE(contains(html, "court"));
    EXPECT_TRUE(contains(read(out / "index.html"), "href=\"lectures.html\""));
    EXPECT_TRUE(contains(html, "<html lang=\"en\">"));
}

/// As `umbra shading` writes it, of self_shadow; every model has figures of its own.
json shading_record() {
    json models = json::array();
    double at   = 0;
    for (const char* name : {"constant", "flat", "gouraud", "every_second", "highlight_test", "taylor", "differences",
                             "phong", "quadratic"}) {
        ++at;
        models.push_back({{"name", name},
                          {"evaluations", 1000 * at},
                          {"rmse", at / 16},
                          {"kink", at / 8},
                          {"highlight", at / 4},
                          {"picture", std::string(name) + ".png"},
                          {"difference", std::string(name) + "_difference.png"}});
    }
    return {{"schema", kResultsSchema},
            {"scene", {{"name", "self_shadow"}, {"title", "Two balls"}}},
            {"models", std::move(models)},
            {"stages", json::array()}};
}

TEST_F(Report, TopicsThatAreNoShadowsAreShownByTheirStudies) {
    put(out / "shading-self_shadow", shading_record());
    write(out / "shading-self_shadow/index.html", "the study's page");
    write_report({out}, out);
    const std::string html = read(out / "lectures.html"), models = topic_of(html, "C1");
    std::size_t at = 0;
    for (const std::string expected :
         {"shading-self_shadow/constant.png", "<figcaption>constant<", "shading-self_shadow/flat.png",
          "<figcaption>flat<", "shading-self_shadow/gouraud.png", "<figcaption>Gouraud<",
          "shading-self_shadow/phong.png", "<figcaption>Phong<", "one value per triangle, without any"}) {
        at = models.find(expected, at);
        ASSERT_NE(at, std::string::npos) << expected << " in its place in\n" << models;
    }
    EXPECT_TRUE(
        contains(models, "Difference from Phong shading (RMSE) – constant: 0.0625; flat: 0.125; Gouraud: 0.188."))
        << models;
    EXPECT_TRUE(contains(models, "href=\"shading-self_shadow/index.html\">Two balls<")) << models;
    EXPECT_TRUE(contains(topic_of(html, "C4"), "Evaluations of the sum – every second pixel: 4 000; Phong: 8 000."))
        << topic_of(html, "C4");
    EXPECT_TRUE(contains(topic_of(html, "C2"), "relative to Phong shading – flat: 0.250.")) << topic_of(html, "C2");
    EXPECT_FALSE(contains(topic_of(html, "C5"), "<img")) << "its scene is another one";
    EXPECT_TRUE(contains(read(out / "index.html"), "shading-self_shadow/index.html"));
    write_report({out}, out, {.language = kGerman});
    const std::string german = topic_of(read(out / "lectures.html"), "C1");
    EXPECT_TRUE(contains(german, "Abweichung von der Phong-Schattierung (RMSE) – konstant: 0,0625; flach: 0,125"))
        << german;
    EXPECT_TRUE(contains(german, "<figcaption>konstant<")) << german;
}

TEST_F(Report, ErrorsOfTheMethodsStandWhereThatIsTheTopic) {
    json results   = sample("umbra_penumbra");
    json& errors   = results["methods"][1]["errors"][0];
    errors["rmse"] = 0.0625;
    put(out / "umbra_penumbra", results);
    write_report({out}, out);
    const std::string html = read(out / "lectures.html");
    EXPECT_TRUE(contains(topic_of(html, "F1"), "RMSE of S_j – ")) << topic_of(html, "F1");
    EXPECT_TRUE(contains(topic_of(html, "F1"), ": 0.0625"));
    EXPECT_FALSE(contains(topic_of(html, "D8"), "RMSE of S_j")) << topic_of(html, "D8");
}

TEST_F(Report, TopicsWithoutPicturesHaveTheirSentence) {
    put(out / "umbra_penumbra", sample("umbra_penumbra"));
    write_report({out}, out);
    const std::string ladders = topic_of(read(out / "lectures.html"), "F3");
    EXPECT_TRUE(contains(ladders, "harder from rung to rung")) << ladders;
    EXPECT_FALSE(contains(ladders, "class=\"strip\"")) << ladders;
}

TEST_F(Report, StudiesFromElsewhereAreCopiedWithTheirPictures) {
    put(folder / "elsewhere", shading_record());
    write(folder / "elsewhere/index.html", "the study's page");
    write_report({folder / "elsewhere"}, out);
    EXPECT_EQ(read(out / "shading-self_shadow/index.html"), "the study's page");
    EXPECT_TRUE(fs::exists(out / "shading-self_shadow/flat_difference.png"));
    EXPECT_TRUE(links_hold(out / "lectures.html"));
    EXPECT_TRUE(links_hold(out / "index.html"));
}

TEST_F(Report, MethodsOfTheLecturesAreShownBesideWhatIsExact) {
    json results = sample("low_sun_fence");
    put(out / "low_sun_fence", results);
    write_report({out}, out);
    const std::string shown = topic_of(read(out / "lectures.html"), "D5");
    const auto method       = shown.find("low_sun_fence/shadow_zbuffer.png");
    ASSERT_NE(method, std::string::npos) << shown;
    EXPECT_LT(method, shown.find("low_sun_fence/reference.png")) << shown;
    EXPECT_TRUE(contains(shown, "<figcaption>shadow z-buffer<")) << shown;
}

fs::path scene_named(const std::string& name) { return fs::path(UMBRA_SCENES) / (name + ".json"); }

/// What is shown of a topic is in the records that the commands write, and methods are called what they are called.
TEST(LectureShows, NameWhatTheCommandsWrite) {
    const fs::path folder = fs::temp_directory_path() / ("umbra_lecture_shows_" + std::to_string(::getpid()));
    const Size small{48, 27};
    const MethodChoice rays = parse_method("ray_traced");
    std::set<std::pair<std::string, std::string>> made;
    for (const LectureRow& row : lecture_rows()) {
        const std::optional<LectureShow>& show = row.show;
        if (!show) continue;
        ASSERT_FALSE(row.scene.empty()) << row.id;
        const std::string study(show->study);
        const fs::path place = folder / (study + "-" + row.scene);
        if (study.empty()) {
            std::vector<LectureValue> values = show->pictures;
            for (const LectureFigure& figure : show->figures)
                std::ranges::copy(figure.values, std::back_inserter(values));
            for (const auto& [name, path, frame] : values) {
                if (path == "reference.files.png") continue;
                ASSERT_TRUE(path.starts_with("methods.")) << row.id << ": " << path;
                EXPECT_NO_THROW(static_cast<void>(find_method(path.substr(8, path.find('.', 8) - 8))))
                    << row.id << ": " << path;
            }
            continue;
        }
        if (made.emplace(study, row.scene).second) {
            PreparedScene prepared = prepare_scene(scene_named(row.scene), small, 1, Work::picture);
            if (study == "shading")
                write_study(
                    place,
                    [&](const fs::path& to) {
                        return compare_shading(prepared, {.method = rays, .runs = 1, .command = ""}, to);
                    },
                    shading_report);
            else if (study == "whitted")
                write_study(
                    place,
                    [&](const fs::path& to) {
                        return trace_whitted(
                            prepared,
                            {.method = rays, .pixel_samples = 4, .bodies = find_bodies(prepared.scene), .command = ""},
                            to);
                    },
                    whitted_report);
            else
                write_study(
                    place,
                    [&](const fs::path& to) {
                        return exchange_light(prepared, {.size = 0.5, .steps = 4, .command = ""}, to);
                    },
                    exchange_report);
        }
        const Field record = read_results(place / "results.json");
        for (const LectureValue& picture : show->pictures) {
            const Field file = value_at(record, picture.path);
            EXPECT_TRUE(file.present() && fs::exists(place / file.text())) << row.id << ": " << picture.path;
        }
        for (const LectureFigure& figure : show->figures)
            for (const LectureValue& value : figure.values)
                EXPECT_TRUE(value_at(record, value.path).number().has_value()) << row.id << ": " << value.path;
    }
    EXPECT_EQ(made.size(), 7u);
    fs::remove_all(folder);
}

TEST_F(Report, LecturesSayWhatIsNotDone) {
    put(out / "light_inside_view", sample("light_inside_view"));
    write_report({out}, out);
    const std::string html = read(out / "lectures.html");
    for (const LectureRow& row : lecture_rows()) {
        const bool done = row.state == "works";
        EXPECT_EQ(contains(topic_of(html, row.id), "<b>"), !done) << row.id;
    }
}

TEST_F(Report, LecturesAreWrittenInTheLanguageThatIsAskedFor) {
    put(out / "light_inside_view", sample("light_inside_view"));
    write_report({out}, out, {.language = kGerman});
    const std::string german = read(out / "lectures.html");
    EXPECT_TRUE(contains(german, "<html lang=\"de\">"));
    EXPECT_TRUE(contains(topic_of(german, "D10"), "Punktlichtquellen werfen nur Kernschatten"));
    EXPECT_TRUE(contains(topic_of(german, "D10"), "springt S_j bei einer Punktlichtquelle von 0 auf 1"));
    EXPECT_FALSE(contains(topic_of(german, "D10"), "Behind the same edge"));
    write_report({out}, out, {.language = kGreek});
    const std::string greek = read(out / "lectures.html");
    EXPECT_TRUE(contains(greek, "<html lang=\"el\">"));
    EXPECT_TRUE(contains(topic_of(greek, "D10"), "κύρια σκιά"));
    EXPECT_TRUE(contains(read(out / "index.html"), "<html lang=\"en\">"));
}

TEST_F(Report, WithoutASceneOfTheLecturesThereIsNoPageOfThem) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    EXPECT_FALSE(fs::exists(out / "lectures.html"));
    EXPECT_FALSE(contains(read(out / "index.html"), "lectures.html"));
}

TEST_F(Report, ExrsAreCopiedOnlyWhereTheyAreWanted) {
    put(out / "court", sample("court"));
    write_report({out}, folder / "all");
    EXPECT_TRUE(fs::exists(folder / "all/court/reference.exr"));
    write_report({out}, folder / "small", {.with_exr = false});
    EXPECT_FALSE(fs::exists(folder / "small/court/reference.exr"));
    EXPECT_TRUE(files_below(folder / "small", ".exr").empty());
    EXPECT_TRUE(fs::exists(folder / "small/court/reference.png"));
    EXPECT_FALSE(contains(read(folder / "small/court/index.html"), ".exr\""));
    write_report({out}, out, {.with_exr = false});
    EXPECT_TRUE(contains(read(out / "court/index.html"), "reference.exr")) << "nothing is copied here";
}

}  // namespace
}  // namespace umbra
