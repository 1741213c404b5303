// The page of the lectures: every topic in order, each picture with its own words, in three languages.
#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>

#include "report_fixture.h"
#include "umbra/bench/radiosity/exchange_page.h"
#include "umbra/bench/report/lecture_page.h"
#include "umbra/bench/report/lecture_shows.h"
#include "umbra/bench/report/lecture_texts.h"
#include "umbra/bench/shading/shading_page.h"
#include "umbra/bench/whitted/whitted_page.h"

namespace umbra {
namespace {

using namespace report_fixture;

constexpr std::array kLanguages{Language::english, Language::german, Language::greek};

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

TEST(LectureTexts, EveryTopicHasItsWordsInThreeLanguages) {
    const auto texts = lecture_texts();
    ASSERT_EQ(texts.size(), lecture_rows().size());
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const LectureText& words = texts[i];
        EXPECT_EQ(words.id, lecture_rows()[i].id);
        EXPECT_FALSE(words.german.empty() || words.greek.empty()) << words.id;
        const bool proved = !words.proves.en.empty();
        EXPECT_EQ(proved, !lecture_rows()[i].scene.empty())
            << words.id << ": a sentence where a scene shows the topic, and only there";
        EXPECT_EQ(proved, !words.proves.de.empty()) << words.id;
        EXPECT_EQ(proved, !words.proves.el.empty()) << words.id;
        EXPECT_EQ(proved, has_greek(words.proves.el)) << words.id;
        EXPECT_FALSE(has_greek(words.proves.en) || has_greek(words.german)) << words.id;
    }
}

TEST(LectureTexts, RowsAreThoseOfThePageInTheDocumentation) {
    std::ifstream in(fs::path(UMBRA_TOP) / "docs/lectures.md");
    std::string page, line;
    std::size_t rows = 0;
    while (std::getline(in, line)) {
        if (line.size() < 4 || !line.starts_with("| ") || !std::isdigit(static_cast<unsigned char>(line[3]))) continue;
        ASSERT_LT(rows, lecture_rows().size());
        const LectureRow& row = lecture_rows()[rows++];
        EXPECT_TRUE(line.starts_with("| " + row.id + " | ")) << line;
        EXPECT_TRUE(contains(line, "| " + row.state + " |") || contains(row.state, "\"") || contains(line, "`"))
            << line;
        if (!row.scene.empty()) {
            EXPECT_TRUE(contains(line, "`" + row.scene + "`")) << line;
        }
    }
    EXPECT_EQ(rows, lecture_rows().size());
    EXPECT_EQ(rows, 76u);
}

TEST(LectureTexts, LanguagesHaveTheirCodes) {
    for (const Language language : kLanguages) EXPECT_EQ(language_named(code_of(language)), language);
    EXPECT_EQ(code_of(Language::greek), "el");
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
    EXPECT_TRUE(contains(shown, "S_j of a point light is 0 or 1")) << shown;
    EXPECT_TRUE(contains(shown, "light_inside_view/reference.png")) << shown;
    EXPECT_TRUE(contains(shown, "The light_inside_view")) << shown;
    EXPECT_TRUE(contains(shown, "24 wrong interior points")) << shown;
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
          "shading-self_shadow/phong.png", "<figcaption>Phong<", "One value a triangle without lights"}) {
        at = models.find(expected, at);
        ASSERT_NE(at, std::string::npos) << expected << " in its place in\n" << models;
    }
    EXPECT_TRUE(contains(models, "Difference from Phong shading (RMSE): constant 0.0625, flat 0.125, Gouraud 0.188."))
        << models;
    EXPECT_TRUE(contains(models, "href=\"shading-self_shadow/index.html\">Two balls<")) << models;
    EXPECT_TRUE(contains(topic_of(html, "C4"), "Evaluations of the sum: every second pixel 4 000, Phong 8 000."))
        << topic_of(html, "C4");
    EXPECT_TRUE(contains(topic_of(html, "C2"), "over that of Phong shading: flat 0.250.")) << topic_of(html, "C2");
    EXPECT_FALSE(contains(topic_of(html, "C5"), "<img")) << "its scene is another one";
    EXPECT_TRUE(contains(read(out / "index.html"), "shading-self_shadow/index.html"));
    write_report({out}, out, {.language = Language::german});
    const std::string german = topic_of(read(out / "lectures.html"), "C1");
    EXPECT_TRUE(contains(german, "Abstand von der Phong-Schattierung (RMSE): konstant 0,0625, flach 0,125")) << german;
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
    EXPECT_TRUE(contains(shown, "24 wrong interior points")) << shown;
}

fs::path scene_named(const std::string& name) { return fs::path(UMBRA_SCENES) / (name + ".json"); }

/// What is shown of a topic is in the records that the commands write, and methods are called what they are called.
TEST(LectureShows, NameWhatTheCommandsWrite) {
    const fs::path folder = fs::temp_directory_path() / ("umbra_lecture_shows_" + std::to_string(::getpid()));
    const Size small{48, 27};
    const MethodChoice rays = parse_method("ray_traced");
    std::set<std::pair<std::string, std::string>> made;
    for (const LectureRow& row : lecture_rows()) {
        const LectureShow* show = lecture_show(row.id);
        if (show == nullptr) continue;
        ASSERT_FALSE(row.scene.empty()) << row.id;
        const std::string study(show->study);
        const fs::path place = folder / (study + "-" + row.scene);
        if (study.empty()) {
            const std::string path(show->pictures[0].path), name = path.substr(8, path.find('.', 8) - 8);
            EXPECT_NO_THROW(static_cast<void>(find_method(name))) << row.id << ": " << path;
            continue;
        }
        if (made.emplace(study, row.scene).second) {
            PreparedScene prepared = prepare_scene(scene_named(row.scene), small, 1, Work::picture);
            if (study == "shading")
                write_shading_study(prepared, {.method = rays, .runs = 1, .command = ""}, place);
            else if (study == "whitted")
                write_whitted_study(
                    prepared,
                    {.method = rays, .pixel_samples = 4, .bodies = find_bodies(prepared.scene), .command = ""}, place);
            else
                write_exchange_study(prepared, {.size = 0.5, .steps = 4, .command = ""}, place);
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
    write_report({out}, out, {.language = Language::german});
    const std::string german = read(out / "lectures.html");
    EXPECT_TRUE(contains(german, "<html lang=\"de\">"));
    EXPECT_TRUE(contains(topic_of(german, "D10"), "Punktlichtquellen werfen nur Kernschatten"));
    EXPECT_TRUE(contains(topic_of(german, "D10"), "S_j einer Punktlichtquelle ist 0 oder 1"));
    EXPECT_FALSE(contains(topic_of(german, "D10"), "The edge of the shadow"));
    write_report({out}, out, {.language = Language::greek});
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
