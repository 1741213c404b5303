// The page of the lectures: every topic in order, each picture with its own words, in three languages.
#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>

#include "report_fixture.h"
#include "umbra/bench/report/lecture_page.h"
#include "umbra/bench/report/lecture_texts.h"

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
